"""The fields of an RGL file: their dimensions, their types, and which values are possible."""

import numpy as np

# The dimensions of each field: equal letters are equal numbers in all fields, a capital letter is 2
# or more
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
RIGHT_ANGLE = np.pi / 2 + 1e-3  # rad: files round 90°
REMEDY = "fetch the file again"
# What must hold for a field, in words and as a function
RULES = {
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


def check_fields(source, arrays, spectral):
    """The arrays of the fields of a spectral file, or of one in RGB, in double precision.

    Raises `BrdfkitError` if a field is missing, or its type, shape or values are impossible.
    """
    layout = LAYOUT | (SPECTRA if spectral else COLOURS)
    sizes = {"1": 1} if spectral else {"1": 1, "c": 3}
    found = {name: _check_field(source, arrays, name, layout[name], sizes) for name in layout}
    for name, (rule, holds) in RULES.items():
        if name in found and not holds(found[name]):
            raise source.error(f"field {name!r} should {rule}; {REMEDY}")
    return found


def _check_field(source, arrays, name, letters, sizes):
    """The array of a field in double precision; `BrdfkitError` unless it is finite and has the
    type and the dimensions of the field.

    `letters`: the field's dimensions; `sizes`: their numbers by letter; new letters are added.
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
            f"field {name!r} is {_format_shape(array.shape)}, where {_format_shape(belong)} "
            f"belong; {REMEDY}"
        )
    finite = np.isfinite(array)  # before the conversion, in which a signalling NaN warns
    if not finite.all():
        raise source.error(
            f"field {name!r} has {(~finite).sum():,} values that are not finite; {REMEDY}"
        )
    return array.astype(float)


def _format_shape(shape):
    return "×".join(map(str, shape))
