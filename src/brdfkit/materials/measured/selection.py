"""Selects the samples of a measured material that fits and comparisons use, with their weights."""

from dataclasses import replace
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_number
from brdfkit.core.array_types import ArrayLike, BoolArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.evidence import compute_deviation
from brdfkit.materials.measured.measured import Measured
from brdfkit.materials.measured.spectrum_to_rgb import has_wavelengths
from brdfkit.model.samples import Samples
from brdfkit.model.samples.measures import estimate_extents

TRUSTED_VARIANCE = 0.2**2  # of a logarithm; a cell of a completed table then counts half


def select_samples(
    data: Measured,
    max_angle: float,
    weights: ArrayLike | None = None,
    errors: bool = False,
    spectral: bool = False,
) -> Samples:
    """Return the valid `Samples` with both angles to the normal below `max_angle` [degrees].

    The samples are in linear sRGB, or at the measured wavelengths if `spectral` is True. `weights`
    are a user's weights, (n,) for all samples of `data` or in the shape of its table; samples of
    weight 0 are left out. With `errors` the samples keep their standard errors; those of a
    completed table become weights. Raises `BrdfkitError` for an angle that is not above 0° and at
    most 90°, for impossible weights, for `spectral` without wavelengths, and where no sample is
    left.
    """
    to_number("max_angle", max_angle, above=0, most=90)
    if not spectral:
        data = data.rgb
    elif not has_wavelengths(data):
        raise BrdfkitError(
            f"{data.name} was measured in the channels {' '.join(data.channels)[:80]}, not at "
            "wavelengths; leave spectral out."
        )
    factors: Any = None
    if weights is not None:
        factors = _check_weights(weights, data)
        # Scale the weights to at most 1, because the square of a large one might overflow
        factors = factors / (factors.max(initial=0) or 1)
    standard_error = data.standard_error if errors else None
    if data.is_table:
        samples = Samples.from_cells(data.table, max_angle, factors, standard_error)
    else:
        weight = data.samples.weight * (1 if factors is None else factors)
        samples = replace(data.samples, weight=weight, errors=standard_error)
        rows = samples.within(max_angle)
        samples = samples.at(rows)
        if rows.any():
            samples = replace(samples, extents=_find_sample_extents(data, samples, rows, max_angle))
    if factors is not None:
        samples = samples.at(samples.weight > 0)
    if not len(samples.wi):
        what, more = "a larger max_angle", ""
        if factors is not None:
            what, more = "other weights", " and a weight above 0"
        raise BrdfkitError(
            f"{data.name}: no valid sample has both angles below {max_angle:g}°{more}; give {what}."
        )
    return samples if data.evidence is None else _weigh_by_certainty(samples)


def _weigh_by_certainty(cells: Samples) -> Samples:
    """Return the cells of a completed table, weighted by their standard errors, if they have any.

    The errors of neighbouring cells go together, so they are no noise of independent samples.
    """
    if cells.errors is None:
        return cells
    cosine = (cells.wi[:, 2] * cells.wo[:, 2])[:, None]
    variance = np.mean(compute_deviation(cells.values, cells.errors, cosine) ** 2, axis=1)
    weight = cells.weight * TRUSTED_VARIANCE / (TRUSTED_VARIANCE + variance)
    return replace(cells, weight=weight, errors=None)


def _find_sample_extents(
    data: Measured, samples: Samples, rows: BoolArray, max_angle: float
) -> FloatArray:
    """Return the extents (n, 2) of the `samples`: how much of all directions each one stands for.

    Fits weight samples by extents in two measures (`model/samples/measures.py`). The mask `rows`
    selects the `samples` from `data`. A file format with a grid of its own knows their extents;
    otherwise they are estimated, once for each `max_angle`.
    """
    if max_angle not in data.extents_by_angle:
        lookup: Any = data._lookup
        if hasattr(lookup, "compute_stored_extents"):
            extents = lookup.compute_stored_extents(max_angle, rows)[rows]
        else:
            extents = estimate_extents(samples.wi, samples.wo, data.anisotropic, max_angle)
        data.extents_by_angle[max_angle] = extents
    return data.extents_by_angle[max_angle]


def _check_weights(weights: ArrayLike, data: Measured) -> FloatArray:
    """Return a user's `weights` of all samples as an array (n,); refuse impossible ones."""
    n = data.table.values[..., 0].size if data.is_table else len(data.samples.wi)
    try:
        array = np.array(weights, float)
    except (TypeError, ValueError):
        array = np.array(np.nan)
    shapes = [(n,), data.table.shape] if data.is_table else [(n,)]
    if array.shape not in shapes:
        several = " or ".join(map(str, shapes))
        raise BrdfkitError(
            f"{data.name}: weights {array.shape} should be {several}, one for each sample."
        )
    if not (np.isfinite(array) & (array >= 0)).all():
        raise BrdfkitError(f"{data.name}: weights should be finite numbers of at least 0.")
    return array.ravel()
