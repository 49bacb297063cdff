"""Converts a user's table of named columns to directions, values and standard errors."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.materials.measured.angles import require_known_unit
from brdfkit.materials.measured.column_names import match_channel_column, parse_layout
from brdfkit.materials.measured.conventions import DIVIDED, compute_view_cosines
from brdfkit.materials.measured.coordinates import is_surface_turned, to_directions
from brdfkit.materials.measured.long_form import parse_colour_name, to_wide_table
from brdfkit.materials.measured.validation import Origin

NO_NUMBERS = "mMc"  # NumPy's codes for data that are refused: time spans, dates, complex numbers


def to_sample_arguments(
    names: Sequence[str], columns: Sequence[FloatArray], unit: str | None, origin: Origin
) -> dict[str, Any]:
    """Return arguments of `Measured.from_samples` for a table of named `columns`, (n,) each.

    `unit` is the unit of angles whose column states none, or None. Rows without a BRDF value are
    masked, and a note in `info` counts them.
    """
    require_known_unit(unit)
    layout = parse_layout(names, origin)
    coordinates = {name: columns[n] for name, n in layout.coordinates.items()}
    units = {name: stated or unit for name, stated in layout.units.items()}
    wi, wo = to_directions(coordinates, units, origin)
    values = np.stack([columns[n] for n in layout.values], axis=1)
    errors = np.stack([columns[n] for n in layout.errors], axis=1) if layout.errors else None
    if errors is not None:
        _refuse_negative_errors(errors, origin)
    info: dict[str, str] = {}
    channels, holes = layout.channels, "not finite"
    if layout.key:
        kind, number = layout.key
        wide = to_wide_table(wi, wo, values, errors, kind, columns[number], origin)
        wi, wo, values, errors = wi[wide.rows], wo[wide.rows], wide.values, wide.errors
        channels = wide.channels
        info[f"{kind}s"] = f"{len(channels)}, a row each, at {len(wi):,} pairs of directions"
        holes = f"without all {kind}s"

    # Mask the rows that cannot be used, and note how many there are for each reason
    finite = np.array(np.isfinite(values).all(axis=1))
    if errors is not None:
        finite &= np.isfinite(errors).all(axis=1)
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    masked = {holes: ~finite, "at or below the horizon": ~above}
    if layout.cosine:
        info |= DIVIDED
        cosine, low = compute_view_cosines(wo)
        masked["view at the horizon"] = above & low
        values = values / cosine
        errors = None if errors is None else errors / cosine
    for reason, rows in masked.items():
        if rows.any():
            what = "pairs of directions" if layout.key else "rows"
            info[reason] = f"{rows.sum():,} of {len(rows):,} {what}, masked"
    return {
        "wi": wi,
        "wo": wo,
        "values": values,
        "valid": ~np.any(list(masked.values()), axis=0),
        "channels": channels,
        "info": info,
        "anisotropic": is_surface_turned(coordinates, units),
        "standard_error": errors,
    }


def extract_columns(frame: Any, origin: Origin) -> tuple[list[str], list[FloatArray]]:
    """Return the names and the numbers (n,) of the columns of a DataFrame or a dictionary.

    A single number in a dictionary counts for all rows. Raises `BrdfkitError` for any other object,
    for columns of different lengths and for text.
    """
    names = getattr(frame, "columns", frame if isinstance(frame, Mapping) else ())
    names = list(getattr(frame, "column_names", names))  # where a pyarrow table has its names
    if not names:
        raise origin.error(
            f"a {type(frame).__name__} was given; give a DataFrame, or a dictionary, with columns "
            "such as theta_i, phi_i, theta_o, phi_o and BRDF"
        )
    texts = list(map(str, names))  # the number 550 and the text "550" are the same name
    for text in texts:
        if texts.count(text) > 1:
            raise origin.error(f"the column {text!r} comes twice; keep one")
    columns = {str(name): _parse_column(name, frame[name], origin) for name in names}
    lengths = {name: len(column) for name, column in columns.items() if column.ndim}
    longest = max(lengths, key=lambda name: lengths[name], default=None)
    rows = lengths[longest] if longest is not None else 1
    for name, length in lengths.items():
        if length < rows:
            raise origin.error(
                f"the column {name!r} has {length} rows where {longest!r} has {rows}; give as many"
            )
    if not rows:
        raise origin.error("has columns, but no rows; add rows")
    return texts, [np.broadcast_to(column, rows) for column in columns.values()]


def _parse_column(name: object, values: Any, origin: Origin) -> FloatArray:
    """Return a column's `values` as floats, (n,) or (); names of R, G, B become 0, 1, 2."""
    if match_channel_column(str(name)) == "channel":
        values = [parse_colour_name(text) for text in np.ravel(values)]
    column = to_float_array(f"the column {name!r}", values, origin)
    if column.ndim > 1:
        raise origin.error(f"the column {name!r} has {column.ndim} axes where one belongs")
    return column


def to_float_array(what: str, values: Any, origin: Origin) -> FloatArray:
    """Return `values` as an array of floats, with NaN where a masked array is masked.

    Raises `BrdfkitError`, in which `what` is their name, for values that are not numbers.
    """
    try:
        array = np.ma.asarray(values) if np.ma.isMaskedArray(values) else np.asarray(values)
        if array.dtype.kind not in NO_NUMBERS:
            return np.ma.filled(array.astype(float), np.nan)
    except (TypeError, ValueError):
        pass
    raise origin.error(f"{what} should hold numbers alone; convert or drop it")


def _refuse_negative_errors(errors: FloatArray, origin: Origin) -> None:
    """Raise `BrdfkitError` for the first row with a standard error below 0."""
    for row in np.flatnonzero((errors < 0).any(axis=1))[:1]:
        raise origin.error(
            f"a standard error is {errors[row].min():g} in {origin.locate_row(row)}; it should be "
            "at least 0"
        )
