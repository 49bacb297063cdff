"""`predict`: the values of a fit at any directions, with 95 % intervals.

Near measured directions, an interval has the error of the fit at the nearest samples, and the
uncertainty of its parameters. Elsewhere, and everywhere for a fit to a completed table, it also
encloses the interval of this table.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brdfkit.core.arguments import to_array
from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.fitting.guard import complete_once, compute_logarithm
from brdfkit.fitting.settings import select_fitted_samples
from brdfkit.materials.completion.prior_cells import compute_cosine, from_logarithm
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.coverage import is_near_sample
from brdfkit.materials.measured.evidence import (
    MEASURED,
    NORMAL_95,
    compute_deviation,
    find_evidence,
)
from brdfkit.materials.resolve import MaterialLike, to_measured
from brdfkit.model.samples import Samples, Table
from brdfkit.model.samples.coordinates import compute_coordinates, compute_sample_coordinates
from brdfkit.regression import Fit

NEIGHBOURS = 30  # number of samples near a direction, of which the error of a fit is taken
LARGEST_HALF = 100.0  # half width of an interval [natural logarithm] that tells nothing
STEP = 1e-3  # of finite differences, as a share of a parameter's standard error


@dataclass(frozen=True, eq=False)
class Prediction:
    """Values of a fit with 95 % intervals.

    Attributes
    ----------
    values : ndarray, shape (n, channels)
        The BRDF of the fit [sr⁻¹].
    low, high : ndarray, shape (n, channels)
        The ends of the intervals [sr⁻¹].
    near : ndarray of bool, shape (n,)
        Whether a direction is measured, or within 5° of one; all others are inferred.
    """

    values: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    near: NDArray[np.bool_]


@in_turn
def predict(fit: Fit, material: MaterialLike, *, wi: ArrayLike, wo: ArrayLike) -> Prediction:
    """Predict the BRDF at pairs of directions by a fit, with 95 % intervals.

    Parameters
    ----------
    fit : Fit
        The fit, in linear sRGB.
    material : Measured, str or Path
        The material that was fitted, or its name or path.
    wi, wo : array_like, shape (n, 3)
        Directions to the light and to the viewer, above the surface.

    Returns
    -------
    Prediction
        The values and intervals.

    Raises
    ------
    BrdfkitError
        For a spectral fit, for directions of other shapes or below the surface, and where
        `material` was not measured.

    Examples
    --------
    >>> predict(fit("paint.csv", "ggx"), "paint.csv", wi=wi, wo=wo).high    # doctest: +SKIP
    """
    samples, data = select_fitted_samples(fit, material), to_measured(material).rgb
    pairs = [np.atleast_2d(to_array(name, w)) for name, w in (("wi", wi), ("wo", wo))]
    shape = pairs[0].shape
    if fit.wavelengths or pairs[1].shape != shape or shape[1:] != (3,) or not shape[0]:
        raise BrdfkitError("predict takes a fit in linear sRGB, and wi and wo, both (n, 3).")
    if not all(np.isfinite(w).all() and (w[:, 2] > 0).all() for w in pairs):
        raise BrdfkitError(
            "a direction of wi or wo is not finite, or not above the surface; leave it out."
        )
    w_i, w_o = (w / np.linalg.norm(w, axis=1, keepdims=True) for w in pairs)
    middle = compute_logarithm(fit.eval(w_i, w_o), w_i, w_o)
    variance = _compute_residual_variance(fit, samples, w_i, w_o, data.anisotropic)
    variance = variance + _compute_parameter_variance(fit, w_i, w_o, middle)
    half = np.minimum(NORMAL_95 * np.sqrt(variance), LARGEST_HALF)
    low: Any = middle - half
    high: Any = middle + half
    near = _is_near(data, w_i, w_o)
    rows = ~near  # where the interval also encloses that of a table
    table = None if data.is_table or near.all() else complete_once(data)
    if data.evidence is not None:
        rows, table = np.ones_like(near), data
    if table is not None:
        known, margin = _evaluate_table(table, w_i[rows], w_o[rows])
        low[rows] = np.minimum(low[rows], known - margin)
        high[rows] = np.maximum(high[rows], known + margin)
    cosine = compute_cosine(w_i, w_o)[:, None]
    ends: list[Any] = [from_logarithm(end, cosine) for end in (low, high)]
    return Prediction(fit.eval(w_i, w_o), ends[0], ends[1], near)


def _is_near(data: Measured, wi: FloatArray, wo: FloatArray) -> NDArray[np.bool_]:
    """Return which pairs of directions (n, 3) are measured, or within 5° of a measured one."""
    if data.evidence is not None:
        return find_evidence(data, wi, wo) == MEASURED
    return np.ones(len(wi), bool) if data.is_table else is_near_sample(data, wi, wo)


def _compute_residual_variance(
    fit: Fit, samples: Samples, wi: FloatArray, wo: FloatArray, anisotropic: bool
) -> FloatArray:
    """Return the mean squares (n, channels) of the fit's residuals at the nearest samples."""
    from scipy.spatial import cKDTree

    values = samples.values, fit.eval(samples.wi, samples.wo)
    measured, own = (compute_logarithm(f, samples.wi, samples.wo) for f in values)
    squares = (measured - own) ** 2
    points = compute_sample_coordinates(samples.wi, samples.wo, anisotropic)
    count = list(range(1, min(NEIGHBOURS, len(points)) + 1))
    _, rows = cKDTree(points).query(compute_coordinates(wi, wo, anisotropic), count)
    return np.asarray(squares[rows % len(squares)].mean(axis=1))


def _compute_parameter_variance(
    fit: Fit, wi: FloatArray, wo: FloatArray, middle: FloatArray
) -> FloatArray:
    """Return the variances (n, channels) of ln(f c + e) by the covariance of the parameters."""
    covariance, slopes = fit.covariance, []
    for k, name in enumerate(fit.certainty.names if fit.certainty else ()):
        values: dict[str, Any] = dict(fit.model.free_values)
        name, _, channel = name.partition("[")
        low, high = fit.model.parameters[name].bounds
        step = STEP * min(max(float(np.sqrt(covariance[k, k])), 1e-9), high - low)
        moved, at = np.array(values[name], float), int(channel[:-1]) if channel else ...
        step = -step if moved[at] + step > high else step
        moved[at] += step
        values[name] = tuple(moved) if channel else float(moved)
        brdf = type(fit.model)(**values).eval(wi, wo)
        slopes.append((compute_logarithm(brdf, wi, wo) - middle) / step)
    if not slopes:
        return np.zeros_like(middle)
    return np.maximum(np.einsum("jnc,jk,knc->nc", slopes, covariance, slopes), 0)


def _evaluate_table(
    table: Measured, wi: FloatArray, wo: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return ln(f c + e) of a completed table, and half of its 95 % intervals, (n, channels)."""
    cells, errors = Samples.from_table(table.table), table.standard_error
    assert errors is not None
    errors = errors.reshape(cells.values.shape)
    cosine = (cells.wi[:, 2] * cells.wo[:, 2])[:, None]
    deviation = compute_deviation(cells.values, errors, cosine)
    deviations = Table(deviation.reshape(table.table.values.shape), table.table.phi_d_period)
    return compute_logarithm(table.eval(wi, wo), wi, wo), NORMAL_95 * deviations.eval(wi, wo)
