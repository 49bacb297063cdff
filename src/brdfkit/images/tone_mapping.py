"""`ToneMapping`: how radiance of any size becomes what a screen shows, 0 to 1.

`range` cuts a window out; `reinhard` [Reinhard et al. 2002], `logarithmic`
[Drago et al. 2003] and `filmic` [Hable 2010] compress what is bright. The result is linear: the
curve of sRGB comes after it, when a picture becomes a PNG.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brdfkit.core.arguments import to_number
from brdfkit.core.colours import luminance
from brdfkit.core.errors import BrdfkitError, no_such

BIAS = 0.85  # of the logarithm: Drago's recommendation
WHITE = 11.2  # what Hable's curve shows as white, of twice the light
MEANS = ("channel", "luminance")


def _range(light, tone, highest):
    """(L - low) / (high - low) [Lesar 2018, eq. 6.4]."""
    return (light - tone.low) / (tone.high - tone.low)


def _reinhard(light, tone, highest):
    """L / (1 + L) [Lesar 2018, eq. 6.5]."""
    return light / (1 + light)


def _logarithmic(light, tone, highest):
    """log₁₀(1 + L) / log₁₀(1 + L_max) · ln 10 / ln(2 + 8 (L / L_max)^(ln b / ln 0.5))."""
    share = (light / highest) ** (np.log(BIAS) / np.log(0.5))
    return np.log1p(light) / np.log1p(highest) * np.log(10) / np.log(2 + 8 * share)


def _filmic(light, tone, highest):
    """f(2 L) / f(11.2), f(x) = (x (0.22 x + 0.03) + 0.002) / (x (0.22 x + 0.3) + 0.06) - 1/30."""

    def f(x):
        return (x * (0.22 * x + 0.03) + 0.002) / (x * (0.22 * x + 0.3) + 0.06) - 1 / 30

    return f(2 * light) / f(WHITE)


CURVES = {
    "range": _range,
    "reinhard": _reinhard,
    "logarithmic": _logarithmic,
    "filmic": _filmic,
}


@dataclass(frozen=True)
class ToneMapping:
    """A curve from radiance to what a screen shows.

    Attributes
    ----------
    curve : str, default "range"
        "range", which cuts what is below `low` and above `high`; "reinhard", "logarithmic", up to
        the brightest of a picture, or "filmic".
    exposure : float, default 1
        By which radiance is multiplied before, at least 0.
    by : str, default "channel"
        "channel": the curve of red, green and blue, by which what is bright becomes white; or
        "luminance": of that alone, so that R : G : B stays until a channel is full.
    low, high : float, default 0 and 1
        What is black and what is white, by "range".

    Raises
    ------
    BrdfkitError
        For other names and numbers.

    Examples
    --------
    >>> ToneMapping("reinhard", exposure=2)([0.0, 0.5, 2.0])
    array([0. , 0.5, 0.8])
    """

    curve: str = "range"
    exposure: float = 1.0
    by: str = "channel"
    low: float = 0.0
    high: float = 1.0

    def __post_init__(self) -> None:
        if self.curve not in CURVES:
            raise no_such("tone mapping", self.curve, CURVES)
        if self.by not in MEANS:
            raise no_such("tone mapping by", self.by, MEANS)
        to_number("exposure", self.exposure, least=0)
        if not to_number("low", self.low) < to_number("high", self.high):
            raise BrdfkitError(f"low = {self.low!r} should be below high = {self.high!r}.")

    def __call__(self, picture: ArrayLike, brightest: float | None = None) -> NDArray:
        """The picture as a screen shows it, linear.

        Parameters
        ----------
        picture : array
            Radiance; by luminance (..., 3), linear sRGB.
        brightest : float, optional
            The largest radiance that the curve is made for, as `brightest_of` finds it; by default
            this picture's.

        Returns
        -------
        ndarray
            As large, 0 to 1; NaN where the picture is not finite.

        Examples
        --------
        >>> ToneMapping("range", high=4)([0.0, 1.0, 8.0])
        array([0.  , 0.25, 1.  ])
        """
        found = np.asarray(picture)
        light = np.where(np.isfinite(found), np.maximum(self.exposure * found, 0), np.nan)
        highest = self.brightest_of(found) if brightest is None else brightest
        highest = max(self.exposure * highest, float(np.finfo(np.float32).tiny))
        curve = CURVES[self.curve]
        if self.by == "channel":
            return np.clip(curve(light, self, highest), 0, 1)
        y = luminance(light)[..., None]
        return np.clip(light * curve(y, self, highest) / np.where(y > 0, y, 1), 0, 1)

    def brightest_of(self, picture: ArrayLike) -> float:
        """The largest finite value of a picture, a channel or its luminance; at least 0.

        Examples
        --------
        >>> ToneMapping(by="luminance").brightest_of([[0.0, 1.0, 0.0]])
        0.7152
        """
        found = np.asarray(picture)
        found = luminance(found) if self.by == "luminance" else found
        return float(np.max(found, initial=0, where=np.isfinite(found)))

    def __str__(self) -> str:
        """In a few words, as captions have it; empty for what changes nothing."""
        if self == ToneMapping():
            return ""
        window = f" {self.low:g} to {self.high:g}" if self.curve == "range" else ""
        means = " of luminance" if self.by == "luminance" else ""
        exposure = f" × {self.exposure:g}" if self.exposure != 1 else ""
        return f"{self.curve}{window}{means}{exposure}"
