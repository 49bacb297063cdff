"""Estimates the noise of a path-traced picture from its passes.

The passes of a rendering are independent, so that two halves of them differ by their noise alone.
From the halves follows how far away the picture of another seed would be; it need not be rendered.
For squared differences that is exact on average, for other metrics if the noise is small: at 16
samples per pixel SSIM becomes up to 0.02 too large.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray


@dataclass(frozen=True)
class Halves:
    """The samples of a picture in two halves, as their sums and their numbers of samples.

    >>> Halves().plus(picture=1.0, spp=8).plus(picture=2.0, spp=8).other_seed
    0.7928932188134524
    """

    sums: tuple[Any, Any] = (0.0, 0.0)
    spp: tuple[int, int] = (0, 0)

    def plus(self, picture: Any, spp: int) -> Halves:
        """Add a pass, a picture of `spp` samples per pixel, to the half that has fewer samples."""
        (a, b), (m, n) = self.sums, self.spp
        if m <= n:
            return Halves((a + spp * picture, b), (m + spp, n))
        return Halves((a, b + spp * picture), (m, n + spp))

    @property
    def picture(self) -> Any:
        """The picture of all samples."""
        return sum(self.sums) / sum(self.spp)

    @property
    def other_seed(self) -> Any:
        """The picture moved by as much noise as another seed would have; None for one pass.

        With σ² the variance of a sample, halves of m and n samples differ by σ² (1/m + 1/n), and
        pictures of two seeds by 2σ²/(m + n).
        """
        (a, b), (m, n) = self.sums, self.spp
        if not (m and n):
            return None
        return self.picture + sqrt(2 * m * n) / (m + n) * (a / m - b / n)


@dataclass(frozen=True)
class Accumulated:
    """The sum of the passes of a picture, in 64 bits.

    Half floats stop to converge near 1,000 passes [Lesar 2018, chapter 6]. `squares` is Σ w x² over
    passes x of w samples per pixel.

    >>> four = Accumulated().plus(np.ones(1), 1).plus(np.zeros(1), 1).plus(np.full(1, 0.5), 2)
    >>> four.picture, four.standard_error, four.spp
    (array([0.5], dtype=float32), array([0.25], dtype=float32), 4)
    """

    halves: Halves = Halves()
    squares: Any = 0.0
    passes: int = 0

    def plus(self, generated: AnyArray, spp: int) -> Accumulated:
        """Add a pass, a picture of `spp` samples per pixel."""
        x = generated.astype(float)
        return Accumulated(self.halves.plus(x, spp), self.squares + spp * x**2, self.passes + 1)

    @property
    def spp(self) -> int:
        """The samples per pixel of all passes."""
        return sum(self.halves.spp)

    @property
    def picture(self) -> AnyArray:
        """The mean over all samples, float32."""
        return self.halves.picture.astype(np.float32)

    @property
    def other_seed(self) -> AnyArray | None:
        """The picture as another seed would give it, see `Halves`; None for one pass."""
        other = self.halves.other_seed
        return None if other is None else other.astype(np.float32)

    @property
    def standard_error(self) -> AnyArray | None:
        """The standard error of each number of the picture; None for one pass, rough for a few.

        With σ² the variance of a sample, k passes have Σ w (x - mean)² = (k - 1) σ² on average, and
        their mean has the variance σ² / Σ w.
        """
        if self.passes < 2:
            return None
        deviations = np.maximum(self.squares - self.spp * self.halves.picture**2, 0)
        return np.sqrt(deviations / (self.passes - 1) / self.spp).astype(np.float32)


def estimate_samples(decibels: float, floor: float, spp: float) -> float:
    """Estimate the samples per pixel for a noise floor of `decibels`, if `spp` give `floor` [dB].

    The squared error of the noise is inversely proportional to their number, so that twice as many
    gain 3 dB.

    >>> round(estimate_samples(46, 40, 100), 6)
    398.107171
    """
    return spp * 10 ** min((decibels - floor) / 10, 100.0)
