"""`Loss`: the error E that a fit minimises.

    E² = ∫ mean_c d(M_c, R_c, cosθ_i, cosθ_o)² dμ / ∫ dμ ≈ Σ_n w_n mean_c d_nc² / Σ_n w_n

R is the measured BRDF and M the model's, in channel c. d is their difference, that of the values
times a product of cosines, or of a function of it, which decides how much dark values count beside
bright ones. μ is a measure of pairs of directions, which decides how much a highlight counts beside
all else; w_n is how much of it sample n stands for (`model/samples/measures.py`), so that E belongs
to the material and not to the file. Samples with an angle beyond 80° are left out, where
measurements are least reliable [Ngan et al. 2005].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import drjit as dr
import numpy as np
from numpy.typing import NDArray

from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import differentiate
from brdfkit.core.jit.threads import in_turn
from brdfkit.model.samples.measures import MEASURES, compute_measure

Weights: TypeAlias = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True)
class Loss:
    """A loss E, by which a fit judges a model: the root of a weighted mean of squared differences.

    Parameters
    ----------
    name : str
        What fits and tables call it.
    meaning : str
        The same in a sentence.
    difference : callable
        The difference of a model's value from the measured one, both f [sr⁻¹]: called with the
        arrays (model, measured, cos_i, cos_o) of Dr.Jit's, the last two cosines of the angles to
        the normal, and written with Dr.Jit's functions, as ``dr.log``.
    measure : {"balanced", "angles", "solid_angle", "samples"}, default "balanced"
        The measure of pairs of directions over which E² is a mean: ``"angles"`` counts evenly over
        the half and difference angles θ_h, θ_d, φ_d, where highlights are large;
        ``"solid_angle"`` over the directions ω_i and ω_o, where they are small; ``"balanced"`` is
        the geometric mean of the two. By ``"samples"`` each sample counts as one, whatever it
        stands for.
    weights : callable, optional
        Factors (n,) of the samples by NumPy's cosines cos_i (n,); by default 1.
    channel_mean : bool, default True
        Whether E² is a mean over the channels, or else their sum.

    Examples
    --------
    >>> def sqrt(model, measured, cos_i, cos_o):
    ...     return dr.sqrt(model * cos_i) - dr.sqrt(dr.maximum(measured, 0) * cos_i)
    >>> Loss("sqrt", "RMS difference of the square root of f cos θ_i", sqrt).linear
    False
    """

    name: str
    meaning: str
    difference: Callable[..., Any]
    measure: str = "balanced"
    weights: Weights = np.ones_like
    channel_mean: bool = True

    def __post_init__(self) -> None:
        if self.measure not in MEASURES:
            raise no_such("measure of directions", self.measure, MEASURES)

    @cached_property
    def linear(self) -> bool:
        """Whether the difference is κ (model - measured), with κ a function of the cosines."""
        known = np.array([-3.0, -1e-4, 0.0, 1e-5, 0.02, 0.5, 4.0, 3e3])
        model, measured = (pairs.ravel() for pairs in np.meshgrid(known, known))
        found, kappa = (_at_oblique(self, m, r) for m, r in ((model, measured), (1 + 0 * model, 0)))
        if not np.isfinite(found).all():
            return False
        tolerance = 1e-12 * np.abs(kappa) * np.maximum(np.abs(model), np.abs(measured))
        return bool((np.abs(found - kappa * (model - measured)) <= tolerance).all())

    def importance(self, samples: Any) -> NDArray[np.float64]:
        """w (n,) of `Samples`, with how much each sample counts, so that Σ_n is a mean."""
        weights = self._weigh(samples.wi[:, 2]) * samples.weight
        weights = weights * compute_measure(samples.extents, self.measure)
        total = weights.sum() * (samples.values.shape[1] if self.channel_mean else 1)
        return weights / total if total else weights

    def _weigh(self, cos_i):
        """The `weights` at NumPy's cosines (n,), if they are such, or `BrdfkitError`."""
        try:
            weights = np.broadcast_to(np.asarray(self.weights(cos_i), float), cos_i.shape)
            good = bool(np.isfinite(weights.sum()) and weights.min(initial=0) >= 0)
        except Exception as error:
            raise BrdfkitError(
                f"The weights of the loss {self.name} fail with {type(error).__name__} ({error}); "
                "they are called with NumPy's cosines (n,) and should return as many numbers."
            ) from error
        if not good:
            raise BrdfkitError(
                f"The weights of the loss {self.name} should be finite numbers of at least 0."
            )
        return weights


@in_turn
def squares(loss: Loss, values: Any, samples: Any) -> NDArray[np.float64]:
    """Squared differences (n,) of `values` (n, channels) from the `Samples`, channels summed."""
    array = double_precision.to_array
    cosines = [array(w[:, 2]) for w in (samples.wi, samples.wo)]
    differences = [
        loss.difference(array(value), array(measured), *cosines)
        for value, measured in zip(values.T, samples.values.T, strict=True)
    ]
    return np.asarray(sum(dr.square(difference) for difference in differences))


def loss_of(difference: Callable[..., Any]) -> Loss:
    """The `Loss` of a difference that a user wrote as a function; see `Loss`.

    Raises `BrdfkitError` for a function that fails on Dr.Jit's arrays.
    """
    name = getattr(difference, "__name__", type(difference).__name__).strip("<>")
    lines = (difference.__doc__ or "a loss of the user's").strip().splitlines()
    loss = Loss(name, lines[0].rstrip("."), difference)
    require_working(loss)
    return loss


def require_working(loss: Loss) -> None:
    """Raise `BrdfkitError` for a loss that fails on Dr.Jit's arrays, gives too few numbers, or does
    not change with the model."""
    model = np.array([0.1, 0.5, 1.0, 3.0])
    try:
        found = _at_oblique(loss, model, 0.4)
    except Exception as error:
        raise BrdfkitError(
            f"The loss {loss.name} fails with {type(error).__name__} ({error}); it is called with "
            "arrays (model, measured, cos_i, cos_o) of Dr.Jit's and is written with its functions, "
            "as dr.log."
        ) from error
    if found.shape != model.shape:
        raise BrdfkitError(
            f"The loss {loss.name} gives {found.size} numbers for {model.size} samples; it should "
            "give one for each."
        )
    ones = [double_precision.to_array(np.full(len(model), x)) for x in (0.4, 0.75, 0.5)]
    _, slope = differentiate(lambda m: loss.difference(m, *ones), double_precision.to_array(model))
    if not np.array(slope).any():
        raise BrdfkitError(
            f"The loss {loss.name} does not change with the model's value, or has no derivative by "
            "it, as after dr.detach."
        )


def _at_oblique(loss, model, measured):
    """The differences (n,) of a loss, as NumPy's, where cosθ_i is 0.75 and cosθ_o 0.5."""
    values = (model, measured + 0 * model, 0.75 + 0 * model, 0.5 + 0 * model)
    found = loss.difference(*map(double_precision.to_array, values))
    if isinstance(found, np.ndarray):
        raise TypeError("it gives an array of NumPy's")
    return np.array(found)
