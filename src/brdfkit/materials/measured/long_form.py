"""Makes one row for each pair of directions of tables that have a row for each wavelength, too."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.colours import RGB
from brdfkit.materials.measured.origin import Origin

DIGITS = 4  # of unit vectors: directions that are equal to so many decimals, 0.006°, are one
NANOMETRES = (100, 100_000)  # plausible wavelengths
WORDS = {"r": 0, "red": 0, "g": 1, "green": 1, "b": 2, "blue": 2}

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Wide:
    """A row for each pair of directions.

    `rows`: the number of the first row that had this pair (n,); `values`: (n, channels), NaN where
    there was no row; `errors`: the same of standard errors, or None; `channels`.
    """

    rows: NDArray[np.intp]
    values: Floats
    errors: Floats | None
    channels: tuple[str, ...]


def channel_number(text: Any) -> float:
    """The place in R, G, B of a channel's name; NaN for what is none.

    >>> channel_number("Green")
    1.0
    """
    return float(WORDS.get(str(text).strip().lower(), np.nan))


def to_wide(
    wi: Floats,
    wo: Floats,
    values: Floats,
    errors: Floats | None,
    kind: str,
    keys: Floats,
    origin: Origin,
) -> Wide:
    """The `Wide` form of `values`, and `errors` or None, (n, 1) at directions (n, 3).

    `kind`: what the `keys` (n,) of the rows are, "wavelength" [nm], or "channel", the place in R,
    G, B; `origin`: for errors. Rows that repeat others make rows of their own. Raises
    `BrdfkitError` for wavelengths and channels that are none, and where no pair of directions has
    them all.
    """
    find = _find_wavelengths if kind == "wavelength" else _find_colours
    channels, column = find(keys, origin)
    both = np.round(np.concatenate([wi, wo], axis=1) * 10**DIGITS).astype(np.int64)
    pair = np.unique(both, axis=0, return_inverse=True)[1].ravel()
    repeat = _count_before(pair * len(channels) + column)
    place = pair * (repeat.max() + 1) + repeat
    _, rows, row = np.unique(place, return_index=True, return_inverse=True)
    order = np.argsort(rows)  # the table's
    cells = np.argsort(order)[row], column
    shape = len(rows), len(channels)
    wide = _spread(values, cells, shape)
    if not np.isfinite(wide).all(axis=1).any():
        raise origin.error(
            f"no pair of directions has values in all of its {len(channels)} channels, "
            f"{channels[0]} to {channels[-1]}; leave out those that few pairs have"
        )
    spread = None if errors is None else _spread(errors, cells, shape)
    return Wide(rows[order], wide, spread, channels)


def _find_wavelengths(keys, origin):
    """The channels of wavelengths [nm], ascending, and the number of each row's (n,)."""
    low, high = NANOMETRES
    for row in np.flatnonzero(~((keys >= low) & (keys <= high)))[:1]:
        raise origin.error(
            f"the wavelength is {keys[row]:g} in {origin.row(row)}, where {low} to {high:,} nm "
            "belong; give nanometres"
        )
    wavelengths, column = np.unique(keys, return_inverse=True)
    return tuple(f"{nm:.10g}nm" for nm in wavelengths), column.ravel()


def _find_colours(keys, origin):
    """The channels R, G, B, and the number of each row's (n,)."""
    for row in np.flatnonzero(np.isnan(keys))[:1]:
        raise origin.error(
            f"the channel in {origin.row(row)} is none of R, G and B; mend it or leave the row out"
        )
    for number, name in enumerate(RGB):
        if number not in keys:
            raise origin.error(
                f"no row has the channel {name}; give R, G and B, or leave the column channel out"
            )
    return RGB, keys.astype(np.int64)


def _count_before(cell):
    """How many of the rows before have the same `cell` (n,)."""
    order = np.argsort(cell, kind="stable")
    ordered = cell[order]
    first = np.searchsorted(ordered, ordered)
    counts = np.empty(len(cell), np.int64)
    counts[order] = np.arange(len(cell)) - first
    return counts


def _spread(values, cells, shape):
    """The `values` (n, 1) in their `cells` of an array of `shape`; NaN elsewhere."""
    wide = np.full(shape, np.nan)
    wide[cells] = values[:, 0]
    return wide
