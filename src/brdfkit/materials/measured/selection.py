"""Selects the samples of a measured material that fits and comparisons use."""

from dataclasses import replace
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_number
from brdfkit.core.array_types import ArrayLike, BoolArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.measured import Measured
from brdfkit.materials.measured.spectrum_to_rgb import has_wavelengths
from brdfkit.model.samples import Samples
from brdfkit.model.samples.measures import estimate_extents


def select_samples(
    data: Measured,
    max_angle: float,
    weights: ArrayLike | None = None,
    errors: bool = False,
    spectral: bool = False,
) -> Samples:
    """Return the valid `Samples` of a `Measured` with both angles below `max_angle` [degrees].

    Spectral samples are converted to linear sRGB unless they are to be `spectral`. `weights` are a
    user's weights of all samples of the material (n,), or of a table's cells in its shape; samples
    with weight 0 are left out. `errors` says whether the samples carry the standard errors of the
    material. Raises `BrdfkitError` for an angle that is not above 0° and at most 90°, for
    impossible weights, for `spectral` without wavelengths, and where no sample is left.
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
        factors = factors / (factors.max(initial=0) or 1)  # so that no square overflows
    standard_error = data.standard_error if errors else None
    if data.is_table:
        samples = Samples.from_cells(data.table, max_angle, factors, standard_error)
    else:
        weight = data.samples.weight * (1 if factors is None else factors)
        samples = replace(data.samples, weight=weight, errors=standard_error)
        rows = samples.within(max_angle)
        samples = samples.at(rows)
        if rows.any():
            samples = replace(samples, extents=_find_extents(data, samples, rows, max_angle))
    if factors is not None:
        samples = samples.at(samples.weight > 0)
    if not len(samples.wi):
        what, more = "a larger max_angle", ""
        if factors is not None:
            what, more = "other weights", " and a weight above 0"
        raise BrdfkitError(
            f"{data.name}: no valid sample has both angles below {max_angle:g}°{more}; give {what}."
        )
    return samples


def _find_extents(
    data: Measured, samples: Samples, rows: BoolArray, max_angle: float
) -> FloatArray:
    """Return how much of both measures of directions the `samples` stand for (n, 2).

    `samples` are the `rows`, a mask, of `data`. The format's own grid says how much, or else it is
    estimated, once for each `max_angle`. `model/samples/measures.py` defines the measures.
    """
    if max_angle not in data.extents_by_angle:
        lookup: Any = data._lookup
        if hasattr(lookup, "stored_extents"):
            extents = lookup.stored_extents(max_angle, rows)[rows]
        else:
            extents = estimate_extents(samples.wi, samples.wo, data.anisotropic, max_angle)
        data.extents_by_angle[max_angle] = extents
    return data.extents_by_angle[max_angle]


def _check_weights(weights: ArrayLike, data: Measured) -> FloatArray:
    """Return the `weights` of all samples of a `Measured` as (n,); raise `BrdfkitError` unless they
    are finite, at least 0 and in the right shape."""
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
