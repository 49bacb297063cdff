"""The format of the MERL BRDF database, `.binary`: tables over half and difference angles.

[Matusik et al. 2003] measured the database. A file is little-endian. It has three int32, the
numbers of cells n_theta_h, n_theta_d, n_phi_d, then the tables of R, G and B as float64. A negative
value marks a cell that was not measured. The phi_d cells span half the circle, which suffices for a
reciprocal BRDF. If there are four times as many phi_d cells as theta_d cells, they span the full
circle.
"""

import functools
import struct
from collections.abc import Sequence
from typing import IO

import numpy as np

from brdfkit.core.colours import RGB
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.formats._source import Source
from brdfkit.materials.formats._writing import require_measured
from brdfkit.materials.measured import Measured

NAME = "MERL"
SUFFIXES = (".binary",)

HEADER = 12  # size of the header in bytes
SCALE = np.array([1.0, 1.15, 1.66]) / 1500  # BRDF [sr⁻¹] per stored unit of R, G, B
SHAPE = (90, 90, 180)  # numbers of cells of the database's tables
MOST_CELLS = 4096  # largest number of cells along an axis that is accepted
NOT_MEASURED = -1.0


def sniff(head: bytes) -> bool:
    """Return whether a file that begins with `head` is MERL's, by plausible numbers of cells."""
    return len(head) >= HEADER and any(map(_is_plausible_shape, _read_dimensions(head)))


def read(source: Source) -> Measured:
    """Read a MERL file as a `Measured` with the channels R, G, B, and NaN in unmeasured cells.

    Raises `BrdfkitError` if header and size disagree, if a value is not finite, and if no cell was
    measured.
    """
    shape = _read_shape(source)
    raw = np.frombuffer(source.data, "<f8", offset=HEADER).reshape(3, *shape)
    wrong = np.concatenate(
        [np.flatnonzero(~np.isfinite(plane)) + k * plane.size for k, plane in enumerate(raw)]
    )
    if len(wrong):
        raise source.error(
            f"{len(wrong):,} values are not finite, the first at byte {HEADER + 8 * wrong[0]:,}; "
            "a MERL table holds none, so fetch the file again"
        )
    # Find the unmeasured cells, which have a negative value in at least one channel
    unknown = functools.reduce(np.logical_or, (plane < 0 for plane in raw))
    if unknown.all():
        raise source.error("every cell is marked as not measured; fetch the file again")
    values = np.multiply(np.moveaxis(raw, 0, -1), SCALE, order="C")
    values[unknown] = np.nan
    info = {"format": NAME, "cells without a value": f"{unknown.sum():,} of {unknown.size:,}"}
    return Measured.from_table(
        values, phi_d_period=_compute_phi_d_period(shape), channels=RGB, name=source.name, info=info
    )


def write(obj: object, stream: IO[bytes]) -> None:
    """Write a `Measured` to a MERL file in linear sRGB; an achromatic one has equal R, G and B.

    Samples are interpolated to the database's 90×90×180 cells, which other programs require.
    Negative values are written as 0, because they would mark cells that were not measured.
    """
    data = require_measured(obj, NAME).rgb
    table = data.table if data.is_table else data.resampled(SHAPE)
    if not _is_plausible_shape(table.shape) or not np.isclose(
        table.phi_d_period, _compute_phi_d_period(table.shape)
    ):
        raise BrdfkitError(
            f"a MERL table cannot say that {table.shape} cells span {table.phi_d_period:.3f} rad "
            "of phi_d; resample to 2 or, for the full circle, 4 phi_d cells per theta_d cell."
        )
    unknown = ~np.isfinite(table.values).all(axis=-1, keepdims=True)
    raw = np.where(unknown, NOT_MEASURED, np.maximum(table.values, 0) / SCALE)
    stream.write(struct.pack("<3i", *table.shape))
    stream.write(np.moveaxis(raw, -1, 0).astype("<f8").tobytes())


def _read_shape(source: Source) -> tuple[int, ...]:
    """Return the header's numbers of cells; raise `BrdfkitError` if the file's size differs."""
    size = len(source.data)
    if size < HEADER:
        raise source.error(f"has {size} bytes, fewer than a MERL header; fetch the file again")
    little, big = _read_dimensions(source.data)
    if not _is_plausible_shape(little):
        if _is_plausible_shape(big):
            raise source.error(
                f"is big-endian (its header reads {_format_shape(big)} so); swap the byte order to "
                "little-endian"
            )
        raise source.error(
            f"its header says {_format_shape(little)} cells where 1 to {MOST_CELLS} belong on each "
            "axis; check that it is a MERL table"
        )
    expected = HEADER + 3 * 8 * int(np.prod(little))
    if size != expected:
        raise source.error(
            f"is {'cut short' if size < expected else 'too long'}: {size:,} bytes where its "
            f"header, {_format_shape(little)} cells, asks for {expected:,}; fetch the file again"
        )
    return little


def _read_dimensions(data: bytes) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the three integers of the header, read as little-endian and as big-endian."""
    return struct.unpack_from("<3i", data), struct.unpack_from(">3i", data)


def _is_plausible_shape(dimensions: Sequence[int]) -> bool:
    return all(1 <= n <= MOST_CELLS for n in dimensions)


def _compute_phi_d_period(shape: Sequence[int]) -> float:
    """Return the range [rad] that the phi_d cells of a table with this shape span: π or 2π."""
    return 2 * np.pi if shape[2] == 4 * shape[1] else np.pi


def _format_shape(dimensions: Sequence[int]) -> str:
    return "×".join(map(str, dimensions))
