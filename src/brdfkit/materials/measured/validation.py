"""Checks the data that a `Measured` is made of: names, notes, table, standard errors.

Its class `Origin` makes errors that say in which line of a file, or row, a wrong number stands.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import ArrayLike, FloatArray
from brdfkit.core.colours import RGB
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import to_printable
from brdfkit.model.samples.samples import require_valid


@dataclass(frozen=True)
class Origin:
    """The file or the arrays that numbers come from, which errors about the numbers name.

    `name`: name of the file or of the material; `lines`: number of the line of each row in the
    file, or None for arrays.

    >>> Origin("mine.csv", [2, 3]).locate_row(1)
    'line 3'
    """

    name: str
    lines: Sequence[int] | None = None

    def error(self, problem: str) -> BrdfkitError:
        """Return a `BrdfkitError` that begins with the origin's name.

        `problem` says what is wrong and what to do, without a full stop.
        """
        return BrdfkitError(f"{self.name}: {problem}.")

    def locate_row(self, index: int) -> str:
        """Return words that locate a row: its line in the file, or its number, counted from 0."""
        return f"row {index}" if self.lines is None else f"line {self.lines[index]}"

    @property
    def unit_advice(self) -> str:
        """The last part of an error, which says how to state the unit of the angles."""
        if self.lines is None:
            return "say unit='degrees' or unit='radians'"
        return "state the unit in the columns' names, as theta_i [deg] or theta_i [rad]"


def make_printable(
    name: str, channels: Sequence[str], info: Mapping[str, str] | None
) -> tuple[str, tuple[str, ...], dict[str, str]]:
    """Return a material's name, channels and notes, all as text without control characters."""
    return to_printable(name), tuple(map(to_printable, channels)), check_notes(info, name)


def check_notes(info: Mapping[str, str] | None, name: str) -> dict[str, str]:
    """Return the notes `info` of the material `name`, as text without control characters.

    None gives no notes. Raises `BrdfkitError` for anything but a mapping.
    """
    if not isinstance(info, Mapping | None):
        raise BrdfkitError(
            f"{name}: info = {info!r:.60} should be notes by their names, as in "
            "{'instrument': 'gonioreflectometer'}."
        )
    return {
        to_printable(key): to_printable(note, keep="\n\t") for key, note in (info or {}).items()
    }


def choose_default_channels(values: ArrayLike, samples: int, name: str) -> tuple[str, ...]:
    """Return the channels' names where the user gives none: R, G, B for three, or Y for one.

    `values` are (samples, channels), or (channels,) if there is a single sample. Raises
    `BrdfkitError` for another number of channels.
    """
    shape = np.shape(values)
    in_single_sample = shape[0] if shape and samples == 1 else 1
    columns = shape[1] if len(shape) == 2 else in_single_sample
    if columns not in (1, len(RGB)):
        raise BrdfkitError(
            f"{name}: values {shape} have {columns} columns; say what they are, as in "
            "channels=('450nm', '550nm')."
        )
    return ("Y",) if columns == 1 else RGB


def check_table_values(
    values: ArrayLike, phi_d_period: float, channels: Sequence[str], name: str
) -> NDArray[np.float64]:
    """Check the values of a table, and return them as floats, with NaN in place of infinity.

    Raises `BrdfkitError` for a shape other than ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d,
    channels), for an impossible `phi_d_period` [rad], and where no cell was measured.
    """
    values = np.asarray(values, float)
    if values.ndim not in (4, 5) or values.shape[-1] != len(channels) or 0 in values.shape:
        raise BrdfkitError(
            f"{name}: a table of shape {values.shape} was given; it should be "
            f"([n_phi_h,] n_theta_h, n_theta_d, n_phi_d, {len(channels)})."
        )
    if not 0 < phi_d_period < 7:
        raise BrdfkitError(
            f"{name}: phi_d_period is {phi_d_period:g}; give π or, for a table that is not "
            "reciprocal, 2π."
        )
    require_valid(np.isfinite(values).all(axis=-1), name, values, channels)
    return np.where(np.isinf(values), np.nan, values) if np.isinf(values).any() else values


def check_table_shape(shape: Sequence[int], name: str) -> None:
    """Raise `BrdfkitError` unless `shape` is ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d).

    These are the numbers of cells of a table; `name` is the material's.
    """
    numbers = shape if isinstance(shape, tuple | list) else (shape,)
    whole = all(isinstance(n, int | np.integer) and n >= 1 for n in numbers)
    if not whole or len(numbers) not in (3, 4):
        raise BrdfkitError(
            f"{name}: a table of shape {shape} was asked for; give three numbers of cells "
            "(n_theta_h, n_theta_d, n_phi_d), or four, with n_phi_h before them."
        )


def check_standard_errors(
    standard_error: ArrayLike | None, values: FloatArray, name: str
) -> NDArray[np.float64] | None:
    """Check the standard errors of `values` (..., channels), and return them as (n, channels).

    None gives None. Raises `BrdfkitError` for another shape than that of `values`, or (n,) for one
    channel, and where a finite value has an error that is negative or not finite.
    """
    if standard_error is None:
        return None
    errors = stated = np.asarray(standard_error, float)
    if stated.ndim == 1 and values.shape[1:] == (1,):
        errors = stated[:, None]
    if errors.shape != values.shape:
        raise BrdfkitError(
            f"{name}: standard errors {stated.shape} should have the shape {values.shape} of "
            "the values."
        )
    bad = np.isfinite(values) & ~((errors >= 0) & np.isfinite(errors))
    if bad.any():
        raise BrdfkitError(
            f"{name}: a standard error is {errors[bad][0]:g}; it should be a finite number of at "
            "least 0 wherever a value was measured."
        )
    return errors.reshape(-1, values.shape[-1])
