"""Defines `Picture`, a loss that compares pictures, for fits that look like the material.

    E² = mean of (t(I_p) - t(J_p))² over pixels p and channels + share · E_log²

I_p is a pixel of a picture of the model, and J_p the same pixel for the measured material. Each
picture shows a ball under direct light from one environment, exposed so that its brightest
hundredth is white. t is the tone curve of sRGB [IEC 1999]. E_log is the log loss, which fits the
directions that no picture shows, and `share` is its factor.
"""

from dataclasses import dataclass
from functools import cached_property

import drjit as dr

from brdfkit.core.array_types import JitFloat
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.names import join_words
from brdfkit.images.ball import LIGHTS
from brdfkit.regression.losses.loss import Loss


@dataclass(frozen=True)
class Picture:
    """A loss E that compares pictures, for fits that look like the measured material.

    The pictures show a ball under direct light, as on a screen. Their grey environments are
    ``"court"``, open to the sky, ``"hall"``, with small lamps, ``"sky"``, with a low sun, and
    ``"studio"``, with softboxes.

    Parameters
    ----------
    lights : tuple of str, default ("court", "hall", "sky", "studio")
        The environments; the loss compares one picture for each.
    share : float, default 0.003
        Factor of the squared log loss, at least 0, which is added to the mean squared difference of
        pixels. A larger factor keeps the fit closer to the measurement in directions that no
        picture shows.

    Raises
    ------
    BrdfkitError
        For an unknown light, no light at all, and a share below 0.

    Examples
    --------
    >>> Picture(lights=("hall",)).share
    0.003
    """

    lights: tuple[str, ...] = tuple(LIGHTS)
    share: float = 3e-3

    name = "picture"
    linear = False

    def __post_init__(self) -> None:
        if not isinstance(self.lights, str | tuple | list):
            raise BrdfkitError(f"Picture: lights = {self.lights!r} should be names of lights.")
        named = (self.lights,) if isinstance(self.lights, str) else tuple(self.lights)
        if not named:
            raise BrdfkitError(f"Picture: lights is empty; name some of {', '.join(LIGHTS)}.")
        for light in named:
            if light not in LIGHTS:
                raise no_such_error("light of pictures", light, LIGHTS)
        object.__setattr__(self, "lights", named)
        try:
            share = float(self.share)
        except (TypeError, ValueError):
            share = -1.0
        if not 0 <= share < float("inf"):
            raise BrdfkitError(f"Picture: share = {self.share!r} should be a number of at least 0.")
        object.__setattr__(self, "share", share)

    @property
    def meaning(self) -> str:
        """The meaning of the loss in a sentence, for tables."""
        return f"RMS difference of pixels: {self.describe()}"

    def describe(self) -> str:
        """Return the pictures that the loss compares, in words."""
        return f"pictures of a ball under {join_words(self.lights)}"

    @cached_property
    def pixel_loss(self) -> Loss:
        """The loss of a single pixel, without the log loss of the samples."""
        return Loss(
            self.name,
            self.meaning,
            lambda model, measured, cos_i, cos_o: _encode_srgb(model) - _encode_srgb(measured),
        )


def _encode_srgb(x: JitFloat) -> JitFloat:
    """Return linear values (any shape) encoded by the tone curve of sRGB, also above 1."""
    bright = 1.055 * dr.power(dr.maximum(x, 0.0031308), 1 / 2.4) - 0.055
    return dr.select(x < 0.0031308, 12.92 * x, bright)
