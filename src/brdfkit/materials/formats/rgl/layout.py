"""Checks that the fields of an RGL file have the right dimensions, types and values."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.materials.formats._source import Source
from brdfkit.materials.formats.rgl.tensor_file import REMEDY, format_shape

# The shape of each field, as a letter for each dimension: dimensions with equal letters have equal
# sizes in all fields, and capital letters stand for sizes of at least 2
LAYOUT = {
    "phi_i": "a",
    "theta_i": "b",
    "ndf": "UV",
    "sigma": "ST",
    "vndf": "abYX",
    "luminance": "abNN",
    "jacobian": "1",
}
COLOURS = {"rgb": "abcNN"}
SPECTRA = {"wavelengths": "c", "spectra": "abcNN"}
RIGHT_ANGLE = np.pi / 2 + 1e-3  # rad; a little more than 90°, because files round angles
# Condition on the values of each field: in words, for error messages, and as a test of the values
RULES: dict[str, tuple[str, Callable[[FloatArray], Any]]] = {
    "phi_i": (
        "increase within the circle",
        lambda x: (np.diff(x) > 0).all() and np.abs(x).max() < 4 * RIGHT_ANGLE,
    ),
    "theta_i": (
        "increase from 0° to at most 90°",
        lambda x: (np.diff(x) > 0).all() and x[0] >= 0 and x[-1] < RIGHT_ANGLE,
    ),
    "wavelengths": ("increase, in nm", lambda x: (np.diff(x) > 0).all() and x[0] > 0),
    "ndf": ("not be negative", lambda x: x.min() >= 0),
    "sigma": ("be positive", lambda x: x.min() > 0),
    "vndf": (
        "not be negative, nor 0 for a whole incidence",
        lambda x: x.min() >= 0 and x.any(axis=(2, 3)).all(),
    ),
}


def check_fields(
    source: Source, arrays: Mapping[str, AnyArray], spectral: bool
) -> dict[str, FloatArray]:
    """Return the fields of a `spectral` file, or else of an RGB file, as float64 arrays by name.

    Raises `BrdfkitError` if a field is missing, or its type, shape or values are impossible.
    """
    layout = LAYOUT | (SPECTRA if spectral else COLOURS)
    sizes = {"1": 1} if spectral else {"1": 1, "c": 3}
    checked = {name: _check_field(source, arrays, name, layout[name], sizes) for name in layout}
    for name, (rule, holds) in RULES.items():
        if name in checked and not holds(checked[name]):
            raise source.error(f"field {name!r} should {rule}; {REMEDY}")
    return checked


def _check_field(
    source: Source,
    arrays: Mapping[str, AnyArray],
    name: str,
    letters: str,
    sizes: dict[str, int],
) -> FloatArray:
    """Return the field `name` as float64; raise `BrdfkitError` for a wrong type, shape or value.

    `letters` has a letter for each of the field's dimensions, as `LAYOUT` explains. `sizes` has the
    size for each letter; letters that occur for the first time are added to it.
    """
    if name not in arrays:
        raise source.error(f"has no field {name!r}, which an RGL file needs; {REMEDY}")
    array = arrays[name]
    if array.dtype != (np.uint8 if name == "jacobian" else np.float32):
        raise source.error(f"field {name!r} has the type {array.dtype}; {REMEDY}")
    for letter, size in zip(letters, array.shape, strict=False):
        sizes.setdefault(letter, max(size, 2 if letter.isupper() else 1))
    belong = tuple(sizes.get(letter, 1) for letter in letters)
    if array.shape != belong:
        raise source.error(
            f"field {name!r} is {format_shape(array.shape)}, where {format_shape(belong)} "
            f"belong; {REMEDY}"
        )
    finite = np.isfinite(array)  # tested before the conversion, which warns of signalling NaN
    if not finite.all():
        raise source.error(
            f"field {name!r} has {(~finite).sum():,} values that are not finite; {REMEDY}"
        )
    return array.astype(float)
