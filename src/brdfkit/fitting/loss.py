"""Losses: the errors E that a fit minimises.

    E² = Σ_n w_n Σ_c [g(κ_n R_nc) - g(κ_n M_nc)]² / N

R is the measured BRDF and M the model's, at sample n in channel c. κ is a product of cosines, w the
sample's weight, and N normalises. The transform g decides how much dark values count beside bright
ones. Samples with an angle beyond 80° are left out, where measurements are least reliable
[Ngan et al. 2005]. A measured value may be negative (noise, or a colour out of gamut): the cosine
and the plain loss take it as it is, the others as 0, because their g needs values ≥ 0.
"""

from collections.abc import Callable
from dataclasses import dataclass

import drjit as dr
import numpy as np

# Added inside the logarithm, which is nearly linear for smaller values: about the noise of a
# measured table [sr⁻¹]
LOG_OFFSET = 1e-3
# Added inside the cube root, which has no derivative at 0
CBRT_OFFSET = 1e-6


@dataclass(frozen=True)
class Loss:
    """One loss. `g`, its derivative `dg` and second derivative `ddg` take Dr.Jit arrays.

    `cosines(cos_i, cos_o)` gives κ, `weights(wi)` gives w; `linear`: whether g is the identity;
    `channel_mean`: whether E² is a mean over the channels, otherwise their sum.
    """

    name: str
    meaning: str
    g: Callable
    dg: Callable
    ddg: Callable
    cosines: Callable
    weights: Callable
    linear: bool = False
    channel_mean: bool = True

    def factors(self, samples):
        """(κ, w), each (n,), of `Samples`; w includes how much each sample counts."""
        cosines = self.cosines(samples.wi[:, 2], samples.wo[:, 2])
        return cosines, self.weights(samples.wi) * samples.weight

    def target(self, values):
        """The values (n, channels) that g takes: negative ones are 0 unless g is the identity."""
        return values if self.linear else np.maximum(values, 0)

    def normaliser(self, weights, channels):
        """N: Σ w, times the number of channels where E is a mean over them."""
        return weights.sum() * (channels if self.channel_mean else 1)


def _sin_theta(w):
    return np.sqrt(np.maximum(1 - w[:, 2] ** 2, 0))


class Losses(dict[str, Loss]):
    """The losses by name, "cosine", "log", "cbrt" and "plain": what `fit` makes small.

    A loss E is a root mean square of differences: of f cos θ_i [sr⁻¹] for "cosine", of its cube
    root [sr^(-1/3)] for "cbrt", of f [sr⁻¹] for "plain", and of the logarithm of f cos θ_i cos θ_o
    for "log" [no unit: 0.1 is about 10 %]. ``losses[name].meaning`` says more of one.

    >>> losses["plain"].meaning
    'RMS difference of f: what is bright counts'
    """


losses = Losses(
    (loss.name, loss)
    for loss in (
        Loss(
            name="cosine",
            meaning="cosine-weighted L2, w = sin θ_i, channels summed [Kurt 2007, eq. 5.13]",
            g=lambda x: x,
            dg=lambda x: 1,
            ddg=lambda x: 0,
            cosines=lambda cos_i, cos_o: cos_i,
            weights=_sin_theta,
            linear=True,
            channel_mean=False,
        ),
        Loss(
            name="log",
            meaning="RMS difference of ln(f cos θ_i cos θ_o + 0.001): relative error, dark counts",
            g=lambda x: dr.log(x + LOG_OFFSET),
            dg=lambda x: 1 / (x + LOG_OFFSET),
            ddg=lambda x: -1 / dr.square(x + LOG_OFFSET),
            cosines=lambda cos_i, cos_o: cos_i * cos_o,
            weights=lambda wi: np.ones(len(wi)),
        ),
        Loss(
            name="cbrt",
            meaning="RMS difference of the cube root of f cos θ_i: between cosine and log",
            g=lambda x: dr.cbrt(x + CBRT_OFFSET),
            dg=lambda x: 1 / (3 * dr.square(dr.cbrt(x + CBRT_OFFSET))),
            ddg=lambda x: -2 / (9 * dr.cbrt(x + CBRT_OFFSET) ** 5),
            cosines=lambda cos_i, cos_o: cos_i,
            weights=lambda wi: np.ones(len(wi)),
        ),
        Loss(
            name="plain",
            meaning="RMS difference of f: what is bright counts",
            g=lambda x: x,
            dg=lambda x: 1,
            ddg=lambda x: 0,
            cosines=lambda cos_i, cos_o: np.ones(len(cos_i)),
            weights=lambda wi: np.ones(len(wi)),
            linear=True,
        ),
    )
)
