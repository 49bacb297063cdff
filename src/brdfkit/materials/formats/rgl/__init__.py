"""RGL material database: `.bsdf` files in the adaptive parameterisation (`parameterisation.py`).

[Dupuy & Jakob 2018]; https://rgl.epfl.ch/materials. Mitsuba's plugin `measured` renders these
files: those with the field `rgb` in RGB variants, those with `spectra` in spectral variants.

Negative values are colours out of gamut, and are kept. A point whose luminance is 0 was not
measured. The field `valid` is not read, because its bits mean the opposite in some of the files.
"""

from dataclasses import fields

import numpy as np

from brdfkit.core.colours import RGB
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.version import __version__
from brdfkit.materials.formats.rgl import tensor_file
from brdfkit.materials.formats.rgl.encoding import encode
from brdfkit.materials.formats.rgl.layout import check_fields
from brdfkit.materials.formats.rgl.parameterisation import AdaptiveTable, Parameterisation
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.spectrum_to_rgb import wavelengths

NAME = "RGL"
SUFFIXES = (".bsdf",)

LONGEST = 1000  # bytes of a description that are read
REMEDY = "fetch the file again"


def sniff(head):
    """Whether `head` begins as a tensor file."""
    return head.startswith(tensor_file.MAGIC)


def read(source):
    """The `Measured` whose samples are the file's grid, and whose lookup is the file's own.

    The channels are R, G, B, or wavelengths such as "400nm". Raises `BrdfkitError` if a field is
    missing, or its type, shape or values are impossible.
    """
    # The fields
    arrays = tensor_file.read(source)
    spectral = "wavelengths" in arrays
    found = check_fields(source, arrays, spectral)
    # The BRDF that they define
    parameterisation = Parameterisation(*(found[f.name] for f in fields(Parameterisation)))
    values = np.moveaxis(found["spectra" if spectral else "rgb"], 2, -1)
    brdf = AdaptiveTable(
        parameterisation, values, _to_density(found["luminance"]), bool(found["jacobian"])
    )
    channels = tuple(map(_name_channel, found["wavelengths"])) if spectral else RGB
    description = bytes(arrays.get("description", b""))[:LONGEST].decode("utf-8", errors="replace")
    wi, wo, brdf_values = brdf.stored_samples()
    try:
        return Measured.from_samples(
            wi,
            wo,
            brdf_values,
            valid=found["luminance"].ravel() != 0,
            channels=channels,
            name=source.name,
            info={"format": NAME, "description": description},
            anisotropic=not parameterisation.isotropic,
            lookup=brdf,
        )
    except BrdfkitError:
        raise source.error(f"no point of its grid was measured; {REMEDY}") from None


def write(obj, stream):
    """Write a `Measured`, or anything else with `.eval(wi, wo)`: a model, a fit.

    Wavelengths are written to the field `spectra`, other channels to `rgb`; an achromatic material
    is grey there. For Mitsuba's RGB variants save `Measured.rgb`. Negative values are lost, because
    `eval` gives none.
    """
    if not callable(getattr(obj, "eval", None)):
        raise BrdfkitError(
            f"a {type(obj).__name__} has no BRDF; save a measured material, a model or a fit."
        )
    brdf = encode(obj.eval)
    arrays = {f.name: getattr(brdf.parameterisation, f.name) for f in fields(Parameterisation)}
    arrays |= {"luminance": brdf.density, **_value_fields(obj, np.moveaxis(brdf.values, -1, 2))}
    arrays = {name: array.astype(np.float32) for name, array in arrays.items()}
    arrays["jacobian"] = np.ones(1, np.uint8)
    arrays["description"] = np.frombuffer(_describe(obj).encode(errors="replace"), np.uint8)
    tensor_file.write(stream, arrays)


def _value_fields(obj, values):
    """The fields `rgb`, or `wavelengths` and `spectra`, of `values` (a, b, channels, y, x)."""
    spectral = getattr(obj, "wavelengths", ())
    channels = obj.channels if isinstance(obj, Measured) else spectral or RGB
    if values.shape[2] == 1:
        return {"rgb": np.repeat(values, 3, axis=2)}
    if channels == RGB and values.shape[2] == 3:
        return {"rgb": values}
    if channels == RGB:
        raise BrdfkitError(
            f"{values.shape[2]} channels without wavelengths, where one or three belong; save the "
            "measured spectra."
        )
    nanometres = np.array(spectral) if spectral else wavelengths(obj)
    if len(set(nanometres.astype(np.float32))) != len(nanometres) or nanometres.min() <= 0:
        raise BrdfkitError(
            f"the wavelengths of {obj.name} repeat or are not above 0 nm; mend them."
        )
    order = np.argsort(nanometres)
    return {"wavelengths": nanometres[order], "spectra": values[:, :, order]}


def _describe(obj):
    if isinstance(obj, Measured):
        what = obj.info.get("description") or obj.name
    else:
        what = repr(getattr(obj, "model", obj))
    return f"{what}; written by brdfkit {__version__}"


def _to_density(luminance):
    """The luminance (a, b, y, x) as a density: not negative, and uniform for an incidence where it
    is 0 everywhere."""
    density = np.maximum(luminance, 0)
    density[~density.any(axis=(2, 3))] = 1
    return density


def _name_channel(wavelength):
    return np.format_float_positional(np.float32(wavelength), trim="-") + "nm"
