"""Defines `Loss`, an error E of a model on measured samples, which a fit minimises.

    E² = ∫ mean_c d(M_c, R_c, cosθ_i, cosθ_o)² dμ / ∫ dμ ≈ Σ_n w_n mean_c d_nc² / Σ_n w_n

M is the BRDF of the model and R the measured BRDF, in channel c; θ_i and θ_o are the angles of
incidence and of view. d is the difference of M and R, often after both were multiplied by cosines
or compressed by a function; it decides how much dark values count compared with bright ones. μ is a
measure of pairs of directions, which decides how much a highlight counts compared with the rest.
w_n is the share of μ that sample n represents (`model/samples/measures.py`), so that E depends on
the material, not on the sampling of its file. Samples with an angle beyond 80° are left out,
because measurements are least reliable there [Ngan et al. 2005].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import differentiate
from brdfkit.core.jit.threads import in_turn
from brdfkit.model.samples.measures import MEASURES, compute_measure

Weights: TypeAlias = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class Loss:
    """A loss E that a fit minimises: the root of a weighted mean of squared differences.

    Parameters
    ----------
    name : str
        The name of the loss in fits and tables.
    meaning : str
        The meaning of the loss in a sentence.
    difference : callable
        The difference between the BRDF of a model and the measured one, both in sr⁻¹. It is called
        with Dr.Jit arrays (model, measured, cos_i, cos_o), the last two the cosines of the angles
        to the normal, and is written with functions of Dr.Jit, such as ``dr.log``.
    measure : {"balanced", "angles", "solid_angle", "samples"}, default "balanced"
        The measure of pairs of directions over which E² is a mean. ``"angles"`` is uniform over the
        half and difference angles θ_h, θ_d, φ_d, in which highlights are large; ``"solid_angle"``
        is uniform over the directions ω_i and ω_o, in which they are small; ``"balanced"`` is the
        geometric mean of the two. With ``"samples"`` all samples count alike.
    weights : callable, optional
        A function from the cosines cos_i (n,) of the angles of incidence, a NumPy array, to factors
        (n,) of the samples' weights; by default 1.
    channel_mean : bool, default True
        Whether E² is the mean over the channels, otherwise their sum.

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
            raise no_such_error("measure of directions", self.measure, MEASURES)

    @cached_property
    def linear(self) -> bool:
        """Whether the difference is linear in the BRDF: a factor κ times (model - measured).

        κ may depend on the cosines. The best weights of a model's lobes under a linear loss follow
        from one linear system, without a search.
        """
        known = np.array([-3.0, -1e-4, 0.0, 1e-5, 0.02, 0.5, 4.0, 3e3])
        model, measured = (pairs.ravel() for pairs in np.meshgrid(known, known))
        difference, kappa = (
            _evaluate_trial_differences(self, m, r)
            for m, r in ((model, measured), (1 + 0 * model, 0))
        )
        if not np.isfinite(difference).all():
            return False
        tolerance = 1e-12 * np.abs(kappa) * np.maximum(np.abs(model), np.abs(measured))
        return bool((np.abs(difference - kappa * (model - measured)) <= tolerance).all())

    def importance(self, samples: Any) -> FloatArray:
        """Return the weights w (n,) of samples in the squared loss E² = Σ w d²."""
        weights = self._evaluate_user_weights(samples.wi[:, 2]) * samples.weight
        weights = weights * compute_measure(samples.extents, self.measure)
        total = weights.sum() * (samples.values.shape[1] if self.channel_mean else 1)
        return weights / total if total else weights

    def _evaluate_user_weights(self, cos_i: FloatArray) -> FloatArray:
        """Return the user's factors (n,) of the samples' weights, at cosines (n,) of incidence.

        Raises `BrdfkitError` if the user's function fails or returns unsuitable numbers.
        """
        try:
            weights = np.broadcast_to(np.asarray(self.weights(cos_i), np.float64), cos_i.shape)
            good = bool(np.isfinite(weights.sum()) and weights.min(initial=0) >= 0)
        except Exception as error:
            raise BrdfkitError(
                f"The weights of the loss {self.name} fail with {type(error).__name__} ({error}); "
                "they are called with cosines (n,) in NumPy and should return as many numbers."
            ) from error
        if not good:
            raise BrdfkitError(
                f"The weights of the loss {self.name} should be finite numbers of at least 0."
            )
        return weights


@in_turn
def sum_squared_differences(loss: Loss, values: Any, samples: Any) -> FloatArray:
    """Return the squared differences (n,) of a loss between a model and samples, channels summed.

    `values` (n, channels): BRDF of the model at the directions of the n `samples`.
    """
    array = double_precision.to_array
    cosines = [array(w[:, 2]) for w in (samples.wi, samples.wo)]
    differences = [
        loss.difference(array(value), array(measured), *cosines)
        for value, measured in zip(values.T, samples.values.T, strict=True)
    ]
    return np.asarray(sum(dr.square(difference) for difference in differences))


def make_loss(difference: Callable[..., Any]) -> Loss:
    """Return a `Loss` whose difference is a user's function, named and described by the function.

    Raises `BrdfkitError` for a function that fails on Dr.Jit arrays.
    """
    name = getattr(difference, "__name__", type(difference).__name__).strip("<>")
    lines = (difference.__doc__ or "a loss of the user's").strip().splitlines()
    loss = Loss(name, lines[0].rstrip("."), difference)
    require_working_loss(loss)
    return loss


def require_working_loss(loss: Loss) -> None:
    """Raise `BrdfkitError` for a loss that no fit can minimise.

    This is the case if its difference fails on Dr.Jit arrays, returns a wrong number of values, or
    does not depend on the model.
    """
    model = np.array([0.1, 0.5, 1.0, 3.0])
    try:
        difference = _evaluate_trial_differences(loss, model, 0.4)
    except Exception as error:
        raise BrdfkitError(
            f"The loss {loss.name} fails with {type(error).__name__} ({error}); it is called with "
            "Dr.Jit arrays (model, measured, cos_i, cos_o) and is written with functions of "
            "Dr.Jit, such as dr.log."
        ) from error
    if difference.shape != model.shape:
        raise BrdfkitError(
            f"The loss {loss.name} returns {difference.size} numbers for {model.size} samples; it "
            "should return one for each."
        )
    ones = [double_precision.to_array(np.full(len(model), x)) for x in (0.4, 0.75, 0.5)]
    _, slope = differentiate(lambda m: loss.difference(m, *ones), double_precision.to_array(model))
    if not np.array(slope).any():
        raise BrdfkitError(
            f"The loss {loss.name} does not change with the model's value, or has no derivative by "
            "it; use the value in the formula, without dr.detach."
        )


def _evaluate_trial_differences(
    loss: Loss, model: FloatArray, measured: FloatArray | float
) -> FloatArray:
    """Return the differences (n,) of a loss at trial values, to check its formula.

    `model`, `measured`: values of the BRDF, where cosθ_i is 0.75 and cosθ_o is 0.5.
    """
    values = (model, measured + 0 * model, 0.75 + 0 * model, 0.5 + 0 * model)
    difference = loss.difference(*map(double_precision.to_array, values))
    if isinstance(difference, np.ndarray):
        raise TypeError("it returns a NumPy array")
    return np.array(difference)
