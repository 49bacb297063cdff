"""Checks the data of which a `Measured` is made: names and notes, a table, standard errors."""

from collections.abc import Mapping, Sequence

import numpy as np

from brdfkit.core.colours import RGB
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import printable
from brdfkit.model.samples.samples import require_some


def make_printable(
    name: str, channels: Sequence[str], info: Mapping[str, str] | None
) -> tuple[str, tuple[str, ...], dict[str, str]]:
    """The name, the channels and the notes `info`, as text that can be printed."""
    return printable(name), tuple(map(printable, channels)), to_notes(info, name)


def to_notes(info, name):
    """The notes `info`, or None, as text that can be printed."""
    if not isinstance(info, Mapping | None):
        raise BrdfkitError(
            f"{name}: info = {info!r:.60} should be notes by their names, as in "
            "{'instrument': 'gonioreflectometer'}."
        )
    return {printable(key): printable(note, keep="\n\t") for key, note in (info or {}).items()}


def usual_channels(values, samples, name):
    """The channels of `values` (samples, channels) whose names are not given: R, G, B, or Y.

    One sample may have its three values as (3,). Raises `BrdfkitError` for another number.
    """
    shape = np.shape(values)
    of_one = shape[0] if shape and samples == 1 else 1
    columns = shape[1] if len(shape) == 2 else of_one
    if columns not in (1, len(RGB)):
        raise BrdfkitError(
            f"{name}: values {shape} have {columns} columns; say what they are, as in "
            "channels=('450nm', '550nm')."
        )
    return ("Y",) if columns == 1 else RGB


def check_table(values, phi_d_period, channels, name):
    """The `values` ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d, channels) of a table, infinite ones
    replaced by NaN.

    Raises `BrdfkitError` for another shape, an impossible period, and where no cell is measured.
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
    require_some(np.isfinite(values).all(axis=-1), name, values, channels)
    if np.isinf(values).any():
        values = np.where(np.isinf(values), np.nan, values)
    return values


def check_shape(shape, name):
    """Raise `BrdfkitError` unless `shape` is ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d)."""
    numbers = shape if isinstance(shape, tuple | list) else (shape,)
    whole = all(isinstance(n, int | np.integer) and n >= 1 for n in numbers)
    if not whole or len(numbers) not in (3, 4):
        raise BrdfkitError(
            f"{name}: a table of shape {shape} was asked for; give three numbers of cells "
            "(n_theta_h, n_theta_d, n_phi_d), or four, with n_phi_h before them."
        )


def check_errors(standard_error, values, name):
    """Standard errors (n, channels), or None where none are given.

    Raises `BrdfkitError` unless they have the shape of `values`, those of one channel may be (n,),
    and are finite and not negative wherever these are finite.
    """
    if standard_error is None:
        return None
    errors = given = np.asarray(standard_error, float)
    if given.ndim == 1 and values.shape[1:] == (1,):
        errors = given[:, None]
    if errors.shape != values.shape:
        raise BrdfkitError(
            f"{name}: standard errors {given.shape} should have the shape {values.shape} of "
            "the values."
        )
    bad = np.isfinite(values) & ~((errors >= 0) & np.isfinite(errors))
    if bad.any():
        raise BrdfkitError(
            f"{name}: a standard error is {errors[bad][0]:g}; it should be a finite number of at "
            "least 0 wherever a value was measured."
        )
    return errors.reshape(-1, values.shape[-1])
