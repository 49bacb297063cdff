"""Estimates the noise of a path-traced picture from its passes.

The passes of a rendering are independent, so the means of two halves of them differ only by noise.
From the halves follows an estimate of the picture that another random seed would give. It differs
from the mean as much as a second rendering would, which need not be made. For squared differences
this is exact on average.
Other metrics need small noise: at 16 samples per pixel SSIM becomes up to 0.02 too large.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import sqrt
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray


@dataclass(frozen=True)
class Halves:
    """The samples of a picture in two halves, whose difference shows the noise.

    `sums`: sum of the samples in each half. `spp`: number of samples per pixel in each half.

    >>> Halves().add_pass(picture=1.0, spp=8).add_pass(picture=2.0, spp=8).other_seed
    0.7928932188134524
    """

    sums: tuple[Any, Any] = (0.0, 0.0)
    spp: tuple[int, int] = (0, 0)

    def add_pass(self, picture: Any, spp: int) -> Halves:
        """Return the halves with a further pass, added to the half that has fewer samples.

        The pass is a picture with `spp` samples per pixel.
        """
        (a, b), (m, n) = self.sums, self.spp
        if m <= n:
            return Halves((a + spp * picture, b), (m + spp, n))
        return Halves((a, b + spp * picture), (m, n + spp))

    @property
    def picture(self) -> Any:
        """The mean over the samples of both halves, which is the rendered picture."""
        return sum(self.sums) / sum(self.spp)

    @property
    def other_seed(self) -> Any:
        """An estimate of the picture that another random seed would give; None for one pass.

        It differs from `picture` by as much noise as a second rendering would. If σ² is the
        variance of a sample, the difference of halves with m and n samples has the variance
        σ² (1/m + 1/n), and that of two seeds 2σ²/(m + n). So the picture is moved by
        the difference of the halves, scaled to this variance.
        """
        (a, b), (m, n) = self.sums, self.spp
        if not (m and n):
            return None
        return self.picture + sqrt(2 * m * n) / (m + n) * (a / m - b / n)


@dataclass(frozen=True)
class Accumulated:
    """The sum over the passes of a progressive rendering, and its standard error.

    The sum has 64 bits, because sums of half floats stop to converge near 1,000 passes [Lesar 2018,
    chapter 6]. `halves`: the samples in two halves. `squares`: Σ w x² over passes x with w samples
    per pixel. `passes`: their number.

    >>> two = Accumulated().add_pass(np.ones(1), 1).add_pass(np.zeros(1), 1)
    >>> four = two.add_pass(np.full(1, 0.5), 2)
    >>> four.picture, four.standard_error, four.spp
    (array([0.5], dtype=float32), array([0.25], dtype=float32), 4)
    """

    halves: Halves = Halves()
    squares: Any = 0.0
    passes: int = 0

    def add_pass(self, generated: AnyArray, spp: int) -> Accumulated:
        """Return the sum with a further pass, a picture with `spp` samples per pixel."""
        x = generated.astype(float)
        return Accumulated(self.halves.add_pass(x, spp), self.squares + spp * x**2, self.passes + 1)

    @property
    def spp(self) -> int:
        """The number of samples per pixel of all passes together."""
        return sum(self.halves.spp)

    @property
    def picture(self) -> AnyArray:
        """The mean over all samples, which is the rendered picture, as float32."""
        return self.halves.picture.astype(np.float32)

    @property
    def other_seed(self) -> AnyArray | None:
        """An estimate of the picture that another random seed would give; None for one pass."""
        other = self.halves.other_seed
        return None if other is None else other.astype(np.float32)

    @property
    def standard_error(self) -> AnyArray | None:
        """The standard error of every pixel and channel; None for one pass, and rough for a few.

        If σ² is the variance of a sample, Σ w (x - mean)² over k passes is (k - 1) σ² on average,
        and the mean has the variance σ² / Σ w, where a pass x has w samples per pixel.
        """
        if self.passes < 2:
            return None
        deviations = np.maximum(self.squares - self.spp * self.halves.picture**2, 0)
        return np.sqrt(deviations / (self.passes - 1) / self.spp).astype(np.float32)

    @cached_property
    def noise(self) -> float | None:
        """The mean standard error of the pixels over their mean; None for one pass, and for black.

        It is kept, because it takes long for a large picture.
        """
        error, mean = self.standard_error, float(self.picture.mean()) if self.passes else 0.0
        return None if error is None or not mean > 0 else float(error.mean()) / mean


def estimate_samples(decibels: float, floor: float, spp: float) -> float:
    """Estimate the samples per pixel that a noise floor (PSNR) of `decibels` needs.

    A rendering with `spp` samples per pixel has the noise floor `floor` [dB]. The squared error is
    inversely proportional to the number of samples, so twice as many gain 3 dB.

    >>> round(estimate_samples(46, 40, 100), 6)
    398.107171
    """
    return spp * 10 ** min((decibels - floor) / 10, 100.0)
