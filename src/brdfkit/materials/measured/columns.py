"""A user's table of named columns as directions, values and standard errors."""

from collections.abc import Mapping

import numpy as np

from brdfkit.materials.measured.angles import require_unit
from brdfkit.materials.measured.column_names import key_of_rows, understand
from brdfkit.materials.measured.coordinates import to_directions, turns
from brdfkit.materials.measured.long_form import channel_number, to_wide
from brdfkit.materials.measured.mending import DIVIDED, cosines

NO_NUMBERS = "mMc"  # NumPy's kinds of what it would make numbers of: spans, dates, complex


def to_samples(names, columns, unit, origin):
    """The arguments of `Measured.from_samples` in the `columns`, arrays (n,) with these `names`.

    `unit`: of angles whose names state none, or None; `origin`: for errors. Rows of which no BRDF
    is known are masked, and the argument `info` says how many.
    """
    require_unit(unit)
    layout = understand(names, origin)
    coordinates = {name: columns[n] for name, n in layout.coordinates.items()}
    units = {name: stated or unit for name, stated in layout.units.items()}
    wi, wo = to_directions(coordinates, units, origin)
    values = np.stack([columns[n] for n in layout.values], axis=1)
    errors = np.stack([columns[n] for n in layout.errors], axis=1) if layout.errors else None
    _require_positive(errors, origin)
    channels, info, holes = layout.channels, {}, "not finite"
    if layout.key:
        kind, number = layout.key
        wide = to_wide(wi, wo, values, errors, kind, columns[number], origin)
        wi, wo, values, errors = wi[wide.rows], wo[wide.rows], wide.values, wide.errors
        channels = wide.channels
        info[f"{kind}s"] = f"{len(channels)}, a row each, at {len(wi):,} pairs of directions"
        holes = f"without all {kind}s"

    # The rows that are masked, by the reason
    finite = np.isfinite(values).all(axis=1)
    if errors is not None:
        finite &= np.isfinite(errors).all(axis=1)
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    masked = {holes: ~finite, "at or below the horizon": ~above}
    if layout.cosine:
        info |= DIVIDED
        cosine, low = cosines(wo)
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
        "anisotropic": turns(coordinates, units),
        "standard_error": errors,
    }


def columns_of(frame, origin):
    """The names, as text, and the columns, arrays (n,), of a DataFrame or a dictionary; a number
    in a dictionary is that of all rows.

    Raises `BrdfkitError` for what is neither, for columns of other lengths and for text.
    """
    names = getattr(frame, "columns", frame if isinstance(frame, Mapping) else ())
    names = list(getattr(frame, "column_names", names))  # as pyarrow calls them
    if not names:
        raise origin.error(
            f"a {type(frame).__name__} was given; give a DataFrame, or a dictionary, with columns "
            "such as theta_i, phi_i, theta_o, phi_o and BRDF"
        )
    texts = list(map(str, names))  # 550 and "550" are one
    for text in texts:
        if texts.count(text) > 1:
            raise origin.error(f"the column {text!r} comes twice; keep one")
    columns = {str(name): _column(name, frame[name], origin) for name in names}
    lengths = {name: len(column) for name, column in columns.items() if column.ndim}
    longest = max(lengths, key=lengths.get) if lengths else None
    rows = lengths.get(longest, 1)
    for name, length in lengths.items():
        if length < rows:
            raise origin.error(
                f"the column {name!r} has {length} rows where {longest!r} has {rows}; give as many"
            )
    if not rows:
        raise origin.error("has columns, but no rows; give some")
    return list(columns), [np.broadcast_to(column, rows) for column in columns.values()]


def _column(name, given, origin):
    if key_of_rows(str(name)) == "channel":
        given = [channel_number(text) for text in np.ravel(given)]
    column = to_numbers(f"the column {name!r}", given, origin)
    if column.ndim > 1:
        raise origin.error(f"the column {name!r} has {column.ndim} axes where one belongs")
    return column


def to_numbers(what, given, origin):
    """The array of floats of what a user gave as `what`, NaN where it is masked; `BrdfkitError`
    where it is none."""
    try:
        found = np.ma.asarray(given) if np.ma.isMaskedArray(given) else np.asarray(given)
        if found.dtype.kind not in NO_NUMBERS:
            return np.ma.filled(found.astype(float), np.nan)
    except (TypeError, ValueError):
        pass
    raise origin.error(f"{what} should hold numbers alone; convert or drop it")


def _require_positive(errors, origin):
    for row in np.flatnonzero((errors < 0).any(axis=1))[:1] if errors is not None else ():
        raise origin.error(
            f"a standard error is {errors[row].min():g} in {origin.row(row)}; it should be at "
            "least 0"
        )
