"""Selects the samples of a measured material that fits and comparisons use."""

from dataclasses import replace
from numbers import Real

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.spectrum_to_rgb import has_wavelengths
from brdfkit.model.samples import Samples
from brdfkit.model.samples.measures import estimate_extents


def select_samples(data, max_angle, weights=None, errors=False, spectral=False):
    """The valid `Samples` of a `Measured` with both angles below `max_angle` [degrees].

    Spectral samples are converted to linear sRGB unless they are to be `spectral`. `weights`: of
    all samples of the material (n,), or of a table's cells in its shape; samples of weight 0 are
    left out. `errors`: whether the samples carry the standard errors of the material, where it has
    them. Raises `BrdfkitError` for an angle that is not above 0° and at most 90°, for weights that
    are none, for `spectral` without wavelengths, and where no sample is left.
    """
    require_max_angle(max_angle)
    if not spectral:
        data = data.rgb
    elif not has_wavelengths(data):
        raise BrdfkitError(
            f"{data.name} was measured in the channels {' '.join(data.channels)[:80]}, not at "
            "wavelengths; leave spectral out."
        )
    if weights is not None:
        weights = _check_weights(weights, data)
        weights = weights / (weights.max(initial=0) or 1)  # of any size, their squares are finite
    own = data.standard_error if errors else None
    if data.is_table:
        samples = Samples.of_cells(data.table, max_angle, weights, own)
    else:
        factors = 1 if weights is None else weights
        samples = replace(
            data.samples,
            weight=data.samples.weight * factors,
            errors=own,
        )
        rows = samples.within(max_angle)
        samples = samples.at(rows)
        if rows.any():
            samples = replace(samples, extents=_find_extents(data, samples, rows, max_angle))
    if weights is not None:
        samples = samples.at(samples.weight > 0)
    if not len(samples.wi):
        what, more = "a larger max_angle", ""
        if weights is not None:
            what, more = "other weights", " and a weight above 0"
        raise BrdfkitError(
            f"{data.name}: no valid sample has both angles below {max_angle:g}°{more}; give {what}."
        )
    return samples


def require_max_angle(max_angle):
    """Raise `BrdfkitError` unless `max_angle` is above 0° and at most 90°."""
    if not isinstance(max_angle, Real) or not 0 < max_angle <= 90:
        raise BrdfkitError(
            f"max_angle = {max_angle!r} should be an angle above 0° and at most 90°."
        )


def _find_extents(data, samples, rows, max_angle):
    """How much of both measures of directions the `samples` of `data` in these `rows`, a mask,
    stand for (n, 2): by the format's own grid or else estimated, once for each `max_angle`."""
    if max_angle not in data.extents_by_angle:
        if hasattr(data._lookup, "stored_extents"):
            found = data._lookup.stored_extents(max_angle, rows)[rows]
        else:
            found = estimate_extents(samples.wi, samples.wo, data.anisotropic, max_angle)
        data.extents_by_angle[max_angle] = found
    return data.extents_by_angle[max_angle]


def _check_weights(given, data):
    """Weights (n,) of all samples of a `Measured`, or `BrdfkitError`."""
    n = data.table.values[..., 0].size if data.is_table else len(data.samples.wi)
    try:
        weights = np.array(given, float)
    except (TypeError, ValueError):
        weights = np.array(np.nan)
    shapes = [(n,), data.table.shape] if data.is_table else [(n,)]
    if weights.shape not in shapes:
        several = " or ".join(map(str, shapes))
        raise BrdfkitError(
            f"{data.name}: weights {weights.shape} should be {several}, one for each sample."
        )
    if not (np.isfinite(weights) & (weights >= 0)).all():
        raise BrdfkitError(f"{data.name}: weights should be finite numbers of at least 0.")
    return weights.ravel()
