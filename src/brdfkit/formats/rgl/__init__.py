"""RGL material database: `.bsdf` files in the adaptive parameterisation (`parameterisation.py`).

[Dupuy & Jakob 2018]; https://rgl.epfl.ch/materials. Mitsuba's plugin `measured` renders
them: a file with the field `rgb` in RGB variants, one with `spectra` in spectral variants.

Negative values are colours out of gamut, and are kept. A luminance of 0 marks what was not
measured; the field `valid` is not read, as its bits mean the opposite in some of the files.
"""

from dataclasses import fields

import numpy as np

from brdfkit.colours import RGB
from brdfkit.errors import BrdfkitError
from brdfkit.formats.rgl import tensor_file
from brdfkit.formats.rgl.encoding import adapted
from brdfkit.formats.rgl.parameterisation import Adaptive, Parameterisation
from brdfkit.measured import Measured
from brdfkit.measured.spectra import wavelengths
from brdfkit.version import __version__

NAME = "RGL"
SUFFIXES = (".bsdf",)

# The dimensions of each field: a letter is the same number in all, a capital is at least 2
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
RIGHT_ANGLE = np.pi / 2 + 1e-3  # rad: files round it
LONGEST = 1000  # bytes of a description
REMEDY = "fetch the file again"
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


def sniff(head):
    """Whether `head` begins as a tensor file does."""
    return head.startswith(tensor_file.MAGIC)


def read(source):
    """The file's grid as samples of a `Measured`, and its own interpolation as the lookup.

    Channels R, G, B, or wavelengths such as "400nm". Raises `BrdfkitError` when a field is
    missing, or its type, shape or values are impossible.
    """
    arrays = tensor_file.read(source)
    spectral = "wavelengths" in arrays
    found = _checked(source, arrays, LAYOUT | (SPECTRA if spectral else COLOURS))
    over = Parameterisation(*(found[f.name] for f in fields(Parameterisation)))
    values = np.moveaxis(found["spectra" if spectral else "rgb"], 2, -1)
    brdf = Adaptive(over, values, _drawable(found["luminance"]), bool(found["jacobian"]))
    channels = tuple(map(_channel, found["wavelengths"])) if spectral else RGB
    description = bytes(arrays.get("description", b""))[:LONGEST].decode("utf-8", errors="replace")
    wi, wo, brdf_values = brdf.at_grid()
    try:
        return Measured.from_samples(
            wi,
            wo,
            brdf_values,
            valid=found["luminance"].ravel() != 0,
            channels=channels,
            name=source.name,
            info={"format": NAME, "description": description},
            anisotropic=not over.isotropic,
            lookup=brdf,
        )
    except BrdfkitError:
        raise source.error(f"no point of its grid was measured; {REMEDY}") from None


def write(obj, stream):
    """Write a `Measured`, or anything else with `.eval(wi, wo)`: a model, a fit.

    Wavelengths become the field `spectra`, all else `rgb`, where an achromatic material is grey.
    For Mitsuba's RGB variants save `Measured.rgb`. Negative values, which `eval` does not give,
    are lost.
    """
    if not callable(getattr(obj, "eval", None)):
        raise BrdfkitError(
            f"a {type(obj).__name__} has no BRDF; save a measured material, a model or a fit."
        )
    brdf = adapted(obj.eval)
    arrays = {f.name: getattr(brdf.over, f.name) for f in fields(brdf.over)}
    arrays |= {"luminance": brdf.density, **_values(obj, np.moveaxis(brdf.values, -1, 2))}
    arrays = {name: array.astype(np.float32) for name, array in arrays.items()}
    arrays["jacobian"] = np.ones(1, np.uint8)
    arrays["description"] = np.frombuffer(_description(obj).encode(errors="replace"), np.uint8)
    tensor_file.write(stream, arrays)


def _values(obj, values):
    """The fields of `values` (a, b, channels, y, x)."""
    channels = obj.channels if isinstance(obj, Measured) else RGB
    if values.shape[2] == 1:
        return {"rgb": np.repeat(values, 3, axis=2)}
    if channels == RGB and values.shape[2] == 3:
        return {"rgb": values}
    if channels == RGB:
        raise BrdfkitError(
            f"{values.shape[2]} channels without wavelengths, where one or three belong; save the "
            "measured spectra."
        )
    nanometres = wavelengths(obj)
    if len(set(nanometres.astype(np.float32))) != len(nanometres) or nanometres.min() <= 0:
        raise BrdfkitError(
            f"the wavelengths of {obj.name} repeat or are not above 0 nm; mend them."
        )
    order = np.argsort(nanometres)
    return {"wavelengths": nanometres[order], "spectra": values[:, :, order]}


def _description(obj):
    if isinstance(obj, Measured):
        what = obj.info.get("description") or obj.name
    else:
        what = repr(getattr(obj, "model", obj))
    return f"{what}; written by brdfkit {__version__}"


def _drawable(luminance):
    """The luminance (a, b, y, x) as a density: not negative, even for an incidence without any."""
    density = np.maximum(luminance, 0)
    density[~density.any(axis=(2, 3))] = 1
    return density


def _channel(wavelength):
    return np.format_float_positional(np.float32(wavelength), trim="-") + "nm"


def _checked(source, arrays, layout):
    """The arrays of `layout` in double precision, once they are possible."""
    sizes = {"1": 1, "c": 3} if "rgb" in layout else {"1": 1}
    found = {name: _shaped(source, arrays, name, layout[name], sizes) for name in layout}
    for name, (rule, holds) in RULES.items():
        if name in found and not holds(found[name]):
            raise source.error(f"field {name!r} should {rule}; {REMEDY}")
    return found


def _shaped(source, arrays, name, letters, sizes):
    """A finite array whose dimensions agree with `sizes` by letter, to which it adds its own."""
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
            f"field {name!r} is {_times(array.shape)}, where {_times(belong)} belong; {REMEDY}"
        )
    finite = np.isfinite(array)  # before it is converted: a signalling NaN warns
    if not finite.all():
        raise source.error(
            f"field {name!r} has {(~finite).sum():,} values that are not finite; {REMEDY}"
        )
    return array.astype(float)


def _times(shape):
    return "×".join(map(str, shape))
