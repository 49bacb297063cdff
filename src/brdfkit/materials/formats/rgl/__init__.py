"""The format of the RGL material database, `.bsdf`, which Mitsuba's plugin `measured` renders.

The BRDFs are stored in the adaptive parameterisation of [Dupuy & Jakob 2018]. The files are at
https://rgl.epfl.ch/materials. The plugin renders files with the field `rgb` in Mitsuba's RGB
variants, and files with the field `spectra` in spectral variants.

Negative values are colours out of gamut, and are kept. A point whose luminance is 0 was not
measured. The field `valid` is not read, because its bits mean the opposite in some of the files.
"""

from collections.abc import Sequence
from dataclasses import fields
from typing import IO, Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.colours import RGB
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.version import __version__
from brdfkit.materials.formats._source import Source
from brdfkit.materials.formats.rgl import tensor_file
from brdfkit.materials.formats.rgl.adaptive_table import AdaptiveTable
from brdfkit.materials.formats.rgl.encoding import encode_brdf
from brdfkit.materials.formats.rgl.layout import check_fields
from brdfkit.materials.formats.rgl.parameterisation import Parameterisation
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.spectrum_to_rgb import wavelengths

NAME = "RGL"
SUFFIXES = (".bsdf",)

LONGEST_DESCRIPTION = 1000  # number of bytes of the field `description` that are read


def sniff(head: bytes) -> bool:
    """Return whether a file that begins with `head` is a tensor file, as all RGL files are."""
    return head.startswith(tensor_file.MAGIC)


def read(source: Source) -> Measured:
    """Read an RGL file as a `Measured`, with R, G, B or wavelengths such as "400nm" as channels.

    Its samples are the points of the file's grid, between which values are interpolated as the
    format defines it. Raises `BrdfkitError` for a field that is missing, or whose type, shape or
    values are impossible.
    """
    arrays = tensor_file.read(source)
    spectral = "wavelengths" in arrays
    checked = check_fields(source, arrays, spectral)
    # Make the BRDF function that the fields define
    parameterisation = Parameterisation(*(checked[f.name] for f in fields(Parameterisation)))
    values = np.moveaxis(checked["spectra" if spectral else "rgb"], 2, -1)
    density = _convert_luminance_to_density(checked["luminance"])
    brdf = AdaptiveTable(parameterisation, values, density, bool(checked["jacobian"]))
    channels = tuple(map(_name_wavelength, checked["wavelengths"])) if spectral else RGB
    text = bytes(arrays.get("description", b""))[:LONGEST_DESCRIPTION]
    wi, wo, brdf_values = brdf.compute_stored_samples()
    try:
        return Measured.from_samples(
            wi,
            wo,
            brdf_values,
            valid=checked["luminance"].ravel() != 0,
            channels=channels,
            name=source.name,
            info={"format": NAME, "description": text.decode(errors="replace")},
            anisotropic=not parameterisation.isotropic,
            lookup=brdf,
        )
    except BrdfkitError:
        raise source.error(f"no point of its grid was measured; {tensor_file.REMEDY}") from None


def write(obj: Any, stream: IO[bytes]) -> None:
    """Write a `Measured`, or any other object with `eval(wi, wo)`, such as a model or a fit.

    Wavelengths are written to the field `spectra`, which Mitsuba's RGB variants do not read, and
    other channels to `rgb`, where an achromatic material is grey. Negative values become 0, as
    `eval` returns them.
    """
    if not callable(getattr(obj, "eval", None)):
        raise BrdfkitError(
            f"a {type(obj).__name__} has no BRDF; save a measured material, a model or a fit."
        )
    write_table(obj, encode_brdf(obj.eval), stream)


def write_table(obj: Any, brdf: AdaptiveTable, stream: IO[bytes]) -> None:
    """Write the table of an object's BRDF, as `write` does."""
    tables = {f.name: getattr(brdf.parameterisation, f.name) for f in fields(Parameterisation)}
    tables |= {
        "luminance": brdf.density,
        **_choose_colour_fields(obj, np.moveaxis(brdf.values, -1, 2)),
    }
    arrays: dict[str, AnyArray] = {name: a.astype(np.float32) for name, a in tables.items()}
    arrays["jacobian"] = np.ones(1, np.uint8)
    arrays["description"] = np.frombuffer(
        _describe_material(obj).encode(errors="replace"), np.uint8
    )
    tensor_file.write(stream, arrays)


def _choose_colour_fields(obj: Any, values: FloatArray) -> dict[str, FloatArray]:
    """Return the field `rgb`, or the fields `wavelengths` and `spectra`, for the BRDF of `obj`.

    `values` (a, b, channels, y, x) is the table of its BRDF for a azimuths and b polar angles of
    incidence.
    """
    spectral: Sequence[float] = getattr(obj, "wavelengths", ())
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


def _describe_material(obj: Any) -> str:
    """Return the text for the field `description` of a file."""
    if isinstance(obj, Measured):
        what = obj.info.get("description") or obj.name
    else:
        what = repr(getattr(obj, "model", obj))
    return f"{what}; written by brdfkit {__version__}"


def _convert_luminance_to_density(luminance: FloatArray) -> FloatArray:
    """Convert the field `luminance` (a, b, y, x) to a density from which directions can be drawn.

    Negative values become 0. At an incidence [a, b] where all are 0, the density is uniform.
    """
    density = np.maximum(luminance, 0)
    density[~density.any(axis=(2, 3))] = 1
    return density


def _name_wavelength(wavelength: float) -> str:
    return np.format_float_positional(np.float32(wavelength), trim="-") + "nm"
