"""Tone mapping: maps radiance of any size to the range of a screen, 0 to 1.

The curve `range` shows a window of values linearly; `reinhard` [Reinhard et al. 2002],
`logarithmic` [Drago et al. 2003] and `filmic` [Hable 2010] compress bright values. The result is
linear; the transfer curve of sRGB is applied when a picture is written as a PNG.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brdfkit.core.arguments import to_number
from brdfkit.core.array_types import AnyArray
from brdfkit.core.colours import luminance
from brdfkit.core.errors import BrdfkitError, no_such_error

BIAS = 0.85  # b in the formula of Drago, who recommends this value
WHITE = 11.2  # the value that Hable's curve, which takes twice the radiance, shows as white
MEANS = ("channel", "luminance")


def _range(light: AnyArray, tone: ToneMapping, highest: float) -> AnyArray:
    """Map the radiance L to (L - low) / (high - low) [Lesar 2018, eq. 6.4]."""
    return (light - tone.low) / (tone.high - tone.low)


def _reinhard(light: AnyArray, tone: ToneMapping, highest: float) -> AnyArray:
    """Map the radiance L to L / (1 + L), Reinhard's curve [Lesar 2018, eq. 6.5]."""
    return light / (1 + light)


def _logarithmic(light: AnyArray, tone: ToneMapping, highest: float) -> AnyArray:
    """Map the radiance L by Drago's curve, where L_max is `highest` and b is `BIAS`:

    log₁₀(1 + L) / log₁₀(1 + L_max) · ln 10 / ln(2 + 8 (L / L_max)^(ln b / ln 0.5))
    """
    share = (light / highest) ** (np.log(BIAS) / np.log(0.5))
    return np.log1p(light) / np.log1p(highest) * np.log(10) / np.log(2 + 8 * share)


def _filmic(light: AnyArray, tone: ToneMapping, highest: float) -> AnyArray:
    """Map the radiance L to f(2 L) / f(11.2), with the rational function f of Hable's curve."""

    def hable(x: float | AnyArray) -> Any:
        return (x * (0.22 * x + 0.03) + 0.002) / (x * (0.22 * x + 0.3) + 0.06) - 1 / 30

    return hable(2 * light) / hable(WHITE)


CURVES: dict[str, Callable[[AnyArray, ToneMapping, float], AnyArray]] = {
    "range": _range,
    "reinhard": _reinhard,
    "logarithmic": _logarithmic,
    "filmic": _filmic,
}


@dataclass(frozen=True)
class ToneMapping:
    """A curve that maps radiance to the brightness on a screen, 0 to 1.

    Attributes
    ----------
    curve : str, default "range"
        "range", which clips values below `low` and above `high`; "reinhard"; "logarithmic", up to
        the brightest value of a picture; or "filmic".
    exposure : float, default 1
        The factor of radiance before the curve, at least 0.
    by : str, default "channel"
        "channel" applies the curve to red, green and blue, so that bright colours become white;
        "luminance" applies it to luminance alone, which preserves R : G : B up to full channels.
    low, high : float, default 0 and 1
        The radiances that "range" shows as black and as white.

    Raises
    ------
    BrdfkitError
        For an unknown curve or `by`, a negative exposure, and `low` not below `high`.

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
            raise no_such_error("tone mapping", self.curve, CURVES)
        if self.by not in MEANS:
            raise no_such_error("tone mapping by", self.by, MEANS)
        to_number("exposure", self.exposure, least=0)
        if not to_number("low", self.low) < to_number("high", self.high):
            raise BrdfkitError(f"low = {self.low!r} should be below high = {self.high!r}.")

    def __call__(self, picture: ArrayLike, brightest: float | None = None) -> NDArray:
        """Map a picture to the brightness on a screen, before the transfer curve of sRGB.

        Parameters
        ----------
        picture : array
            Radiance; (..., 3) in linear sRGB for a mapping by luminance.
        brightest : float, optional
            The largest radiance, up to which "logarithmic" goes; by default that of this picture.
            Several pictures look alike with one value, found by `brightest_of`.

        Returns
        -------
        ndarray
            An array of the same shape, 0 to 1; NaN where the picture is not finite.

        Examples
        --------
        >>> ToneMapping("range", high=4)([0.0, 1.0, 8.0])
        array([0.  , 0.25, 1.  ])
        """
        values = np.asarray(picture)
        light = np.maximum(self.exposure * values, 0)
        finite = np.isfinite(values)
        if not finite.all():
            light = np.where(finite, light, np.nan)
        highest = self.brightest_of(values) if brightest is None else brightest
        highest = max(self.exposure * highest, float(np.finfo(np.float32).tiny))
        curve = CURVES[self.curve]
        if self.by == "channel":
            return np.clip(curve(light, self, highest), 0, 1)
        y = luminance(light)[..., None]
        return np.clip(light * curve(y, self, highest) / np.where(y > 0, y, 1), 0, 1)

    def brightest_of(self, picture: ArrayLike) -> float:
        """Return the largest finite value of a picture's channels or luminance, at least 0.

        Examples
        --------
        >>> ToneMapping(by="luminance").brightest_of([[0.0, 1.0, 0.0]])
        0.7152
        """
        values = np.asarray(picture)
        values = luminance(values) if self.by == "luminance" else values
        return float(np.max(values, initial=0, where=np.isfinite(values)))

    def __str__(self) -> str:
        """Return a short description for captions, or "" for the default mapping."""
        if self == ToneMapping():
            return ""
        window = f" {self.low:g} to {self.high:g}" if self.curve == "range" else ""
        means = " of luminance" if self.by == "luminance" else ""
        exposure = f" × {self.exposure:g}" if self.exposure != 1 else ""
        return f"{self.curve}{window}{means}{exposure}"
