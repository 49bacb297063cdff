"""Losses: the errors E that a fit minimises.

    E² = Σ_n w_n Σ_c d(M_nc, R_nc, cosθ_i, cosθ_o)² / N

R is the measured BRDF and M the model's, at sample n in channel c. d is their difference, that of
the values times a product of cosines, or of a function of it, which decides how much dark values
count beside bright ones. w is the sample's weight, and N normalises. Samples with an angle beyond
80° are left out, where measurements are least reliable [Ngan et al. 2005]. A measured value may be
negative (noise, or a colour out of gamut): the cosine and the plain loss take it as it is, the
others as 0, because their functions need values ≥ 0.
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
    """One loss. `difference(model, measured, cos_i, cos_o)` takes arrays of Dr.Jit's.

    `weights(cos_i)`: w of NumPy's cosines (n,); `linear`: whether the difference is linear in the
    model's value; `channel_mean`: whether E² is a mean over the channels, otherwise their sum.
    """

    name: str
    meaning: str
    difference: Callable
    weights: Callable = np.ones_like
    linear: bool = False
    channel_mean: bool = True

    def importance(self, samples):
        """w (n,) of `Samples`, with how much each sample counts, so that Σ_n is a mean."""
        weights = self.weights(samples.wi[:, 2]) * samples.weight
        total = weights.sum() * (samples.values.shape[1] if self.channel_mean else 1)
        return weights / total if total else weights


def _difference_of(g, cosines):
    """The difference of g(κ f) between the model's f, which is ≥ 0, and the measured one, which
    counts as 0 where it is not; κ = `cosines(cos_i, cos_o)`."""

    def difference(model, measured, cos_i, cos_o):
        kappa = cosines(cos_i, cos_o)
        return g(kappa * model) - g(kappa * dr.maximum(measured, 0))

    return difference


def _sine(cosine):
    return np.sqrt(np.maximum(1 - cosine**2, 0))


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
            difference=lambda model, measured, cos_i, cos_o: cos_i * (model - measured),
            weights=_sine,
            linear=True,
            channel_mean=False,
        ),
        Loss(
            name="log",
            meaning="RMS difference of ln(f cos θ_i cos θ_o + 0.001): relative error, dark counts",
            difference=_difference_of(
                lambda x: dr.log(x + LOG_OFFSET), lambda cos_i, cos_o: cos_i * cos_o
            ),
        ),
        Loss(
            name="cbrt",
            meaning="RMS difference of the cube root of f cos θ_i: between cosine and log",
            difference=_difference_of(
                lambda x: dr.cbrt(x + CBRT_OFFSET), lambda cos_i, cos_o: cos_i
            ),
        ),
        Loss(
            name="plain",
            meaning="RMS difference of f: what is bright counts",
            difference=lambda model, measured, cos_i, cos_o: model - measured,
            linear=True,
        ),
    )
)
