"""Collects the rows of a table with one row per wavelength into one row per pair of directions."""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.colours import RGB
from brdfkit.materials.measured.validation import Origin

DIGITS = 4  # of unit vectors: directions that are equal to so many decimals, 0.006°, are one
NANOMETRES = (100, 100_000)  # plausible wavelengths
CHANNEL_NUMBERS = {"r": 0, "red": 0, "g": 1, "green": 1, "b": 2, "blue": 2}


@dataclass(frozen=True)
class Wide:
    """A table with one row for each pair of directions.

    `rows`: the number of the first row that had this pair (n,); `values`: (n, channels), NaN where
    there was no row; `errors`: the standard errors (n, channels), or None; `channels`: their names.
    """

    rows: IntArray
    values: FloatArray
    errors: FloatArray | None
    channels: tuple[str, ...]


def channel_number(text: object) -> float:
    """Return 0, 1 or 2 for a name of the channel R, G or B; NaN for any other text.

    >>> channel_number("Green")
    1.0
    """
    return float(CHANNEL_NUMBERS.get(str(text).strip().lower(), np.nan))


def to_wide(
    wi: FloatArray,
    wo: FloatArray,
    values: FloatArray,
    errors: FloatArray | None,
    kind: str,
    keys: FloatArray,
    origin: Origin,
) -> Wide:
    """Return the `Wide` form of `values`, and of `errors` or None, (n, 1) at directions (n, 3).

    `kind` says what the `keys` (n,) of the rows are: "wavelength" [nm], or "channel", the place in
    R, G, B. Rows that repeat others make rows of their own. Raises `BrdfkitError` for impossible
    wavelengths and channels, and where no pair of directions has them all.
    """
    find_channels = _find_wavelengths if kind == "wavelength" else _find_colours
    channels, column = find_channels(keys, origin)
    both = np.round(np.concatenate([wi, wo], axis=1) * 10**DIGITS).astype(np.int64)
    pair = np.unique(both, axis=0, return_inverse=True)[1].ravel()
    repeat = _count_earlier(pair * len(channels) + column)
    place = pair * (repeat.max() + 1) + repeat
    _, rows, row = np.unique(place, return_index=True, return_inverse=True)
    order = np.argsort(rows)  # the order of the table
    cells = np.argsort(order)[row], column
    shape = len(rows), len(channels)
    wide = _spread(values, cells, shape)
    if not np.isfinite(wide).all(axis=1).any():
        raise origin.error(
            f"no pair of directions has values in all of its {len(channels)} channels, "
            f"{channels[0]} to {channels[-1]}; leave out those that few pairs have"
        )
    wide_errors = None if errors is None else _spread(errors, cells, shape)
    return Wide(rows[order], wide, wide_errors, channels)


def _find_wavelengths(keys: FloatArray, origin: Origin) -> tuple[tuple[str, ...], IntArray]:
    """Return the channels of wavelengths [nm], ascending, and the channel's number per row (n,)."""
    low, high = NANOMETRES
    for row in np.flatnonzero(~((keys >= low) & (keys <= high)))[:1]:
        raise origin.error(
            f"the wavelength is {keys[row]:g} in {origin.row(row)}, where {low} to {high:,} nm "
            "belong; give nanometres"
        )
    wavelengths, column = np.unique(keys, return_inverse=True)
    return tuple(f"{nm:.10g}nm" for nm in wavelengths), column.ravel()


def _find_colours(keys: FloatArray, origin: Origin) -> tuple[tuple[str, ...], IntArray]:
    """Return the channels R, G, B, and the channel's number per row (n,)."""
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


def _count_earlier(cell: IntArray) -> IntArray:
    """Return for each row how many earlier rows have the same number in `cell` (n,)."""
    order = np.argsort(cell, kind="stable")
    ordered = cell[order]
    first = np.searchsorted(ordered, ordered)
    counts = np.empty(len(cell), np.int64)
    counts[order] = np.arange(len(cell)) - first
    return counts


def _spread(
    values: FloatArray, cells: tuple[IntArray, IntArray], shape: tuple[int, int]
) -> FloatArray:
    """Return an array of `shape` with the `values` (n, 1) in their `cells`, and NaN elsewhere."""
    wide = np.full(shape, np.nan)
    wide[cells] = values[:, 0]
    return wide
