"""Rearranges tables in long form, with one row per wavelength, to one row per direction pair."""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.colours import RGB
from brdfkit.materials.measured.validation import Origin

DIGITS = 4  # unit vectors that agree to this number of decimals, 0.006°, belong to one sample
NANOMETRES = (100, 100_000)  # smallest and largest wavelength that is accepted [nm]
CHANNEL_NUMBERS = {"r": 0, "red": 0, "g": 1, "green": 1, "b": 2, "blue": 2}


@dataclass(frozen=True)
class WideTable:
    """A table in wide form: one row for each pair of directions, and a column for each channel.

    `rows`: number of the first row in the long form with this pair of directions, (n,); `values`:
    BRDF, (n, channels), NaN where the long form has no row; `errors`: standard errors,
    (n, channels), or None; `channels`: names of the columns.
    """

    rows: IntArray
    values: FloatArray
    errors: FloatArray | None
    channels: tuple[str, ...]


def parse_colour_name(text: object) -> float:
    """Return 0, 1 or 2 if `text` is a name of the colour channel R, G or B, otherwise NaN.

    >>> parse_colour_name("Green")
    1.0
    """
    return float(CHANNEL_NUMBERS.get(str(text).strip().lower(), np.nan))


def to_wide_table(
    wi: FloatArray,
    wo: FloatArray,
    values: FloatArray,
    errors: FloatArray | None,
    kind: str,
    keys: FloatArray,
    origin: Origin,
) -> WideTable:
    """Convert a table with one row per channel to one with a row per pair of directions.

    `values` and `errors` are (n, 1), `wi` and `wo` (n, 3). `keys` (n,) are each row's wavelength
    [nm] if `kind` is "wavelength", or its number in R, G, B if `kind` is "channel". A repeated
    measurement gets a row of its own. Raises `BrdfkitError` for impossible wavelengths and
    channels, and where no pair of directions has all channels.
    """
    find_channels = _find_wavelength_channels if kind == "wavelength" else _find_colour_channels
    channels, column = find_channels(keys, origin)
    both = np.round(np.concatenate([wi, wo], axis=1) * 10**DIGITS).astype(np.int64)
    pair = np.unique(both, axis=0, return_inverse=True)[1].ravel()
    repeat = _count_earlier_repeats(pair * len(channels) + column)
    place = pair * (repeat.max() + 1) + repeat
    _, rows, row = np.unique(place, return_index=True, return_inverse=True)
    order = np.argsort(rows)  # keep the order in which the pairs first appear
    cells = np.argsort(order)[row], column
    shape = len(rows), len(channels)
    wide = _fill_table_cells(values, cells, shape)
    if not np.isfinite(wide).all(axis=1).any():
        raise origin.error(
            f"no pair of directions has values in all of its {len(channels)} channels, "
            f"{channels[0]} to {channels[-1]}; leave out those that few pairs have"
        )
    wide_errors = None if errors is None else _fill_table_cells(errors, cells, shape)
    return WideTable(rows[order], wide, wide_errors, channels)


def _find_wavelength_channels(keys: FloatArray, origin: Origin) -> tuple[tuple[str, ...], IntArray]:
    """Return the names of all wavelengths in `keys` [nm], ascending, and each row's index (n,)."""
    low, high = NANOMETRES
    for row in np.flatnonzero(~((keys >= low) & (keys <= high)))[:1]:
        raise origin.error(
            f"the wavelength is {keys[row]:g} in {origin.locate_row(row)}, where {low} to "
            f"{high:,} nm belong; give nanometres"
        )
    wavelengths, column = np.unique(keys, return_inverse=True)
    return tuple(f"{nm:.10g}nm" for nm in wavelengths), column.ravel()


def _find_colour_channels(keys: FloatArray, origin: Origin) -> tuple[tuple[str, ...], IntArray]:
    """Return the names R, G, B, and each row's index in them (n,); refuse any other channels."""
    for row in np.flatnonzero(np.isnan(keys))[:1]:
        raise origin.error(
            f"the channel in {origin.locate_row(row)} is not R, G or B; correct it or leave the "
            "row out"
        )
    for number, name in enumerate(RGB):
        if number not in keys:
            raise origin.error(
                f"no row has the channel {name}; give R, G and B, or leave the column channel out"
            )
    return RGB, keys.astype(np.int64)


def _count_earlier_repeats(cell: IntArray) -> IntArray:
    """Count for each row how many earlier rows have the same number in `cell`, both (n,)."""
    order = np.argsort(cell, kind="stable")
    ordered = cell[order]
    first = np.searchsorted(ordered, ordered)
    counts = np.empty(len(cell), np.int64)
    counts[order] = np.arange(len(cell)) - first
    return counts


def _fill_table_cells(
    values: FloatArray, cells: tuple[IntArray, IntArray], shape: tuple[int, int]
) -> FloatArray:
    """Return an array of this `shape` with `values` (n, 1) at the indices `cells`, else NaN."""
    wide = np.full(shape, np.nan)
    wide[cells] = values[:, 0]
    return wide
