"""brdfkit's own format, `.npz`: all data of a `Measured`, to the last bit, as NumPy arrays.

`numpy.load` opens such files. The first member is ``about``: JSON in UTF-8 with brdfkit's version,
name, channels, info, anisotropic and phi_d_period. A table is the member ``table`` ([n_phi_h,]
n_theta_h, n_theta_d, n_phi_d, channels). Samples are the members ``wi``, ``wo`` (n, 3), ``values``
(n, channels) [sr⁻¹] and ``valid`` (n,). Known standard errors are ``standard_error``
(n, channels), where n is the number of samples or of the table's cells. A completed table has
``evidence`` (n,): 0 where the value was measured, 1 inferred, 2 guessed.

Some formats define their own interpolation function, which no file can store. Its values at the
cells of a table are stored beside the samples, as ``table``, and replace the function when the file
is read. The samples keep their values, but the BRDF between them is then interpolated in the table,
which makes it reciprocal.

The members are not compressed, so that no small file can demand much memory; ``.npz.xz`` is
compressed as a whole.
"""

import io
import json
import math
import re
import struct
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from typing import IO, Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.version import __version__
from brdfkit.materials.formats._source import Source
from brdfkit.materials.formats._writing import require_measured
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.evidence import GUESSED

NAME = "brdfkit"
SUFFIXES = (".npz",)

FIRST = "about"
SAMPLES = ("wi", "wo", "values", "valid")
MEMBERS = tuple(f"{name}.npy" for name in (FIRST, "table", *SAMPLES, "standard_error", "evidence"))
EPOCH = (1980, 1, 1, 0, 0, 0)  # date of all files in the archive: equal data give equal bytes
REMEDY = "save it again or fetch it again"
# The header that numpy.save writes for arrays of the types that brdfkit saves. It is parsed here
# because numpy.load evaluates a header as Python, and allocates the memory that the header claims
# before it checks the data
HEADER = re.compile(
    rb"\x93NUMPY\x01\x00..\{'descr': '(<f4|<f8|\|b1|\|u1)', 'fortran_order': False, "
    rb"'shape': \(((?:[0-9]{1,18}, ?){1,4}(?:[0-9]{1,18})?)\), \} *\n",
    re.DOTALL,
)


def sniff(head: bytes) -> bool:
    """Return whether a file that begins with `head` is a zip archive that brdfkit wrote."""
    return head.startswith(b"PK\x03\x04") and head[30:39] == b"about.npy"


def read(source: Source) -> Measured:
    """Read a `Measured` from a file that `write` wrote; its arrays may also be float32.

    Raises `BrdfkitError` for an archive that is damaged or has compressed members, and for a member
    that is missing or does not fit the others.
    """
    arrays = {
        name: _parse_array(source, name, data) for name, data in _read_members(source).items()
    }
    try:
        about = json.loads(arrays.pop(FIRST, np.empty(0)).tobytes())
        return _make_measured(about, arrays)
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        problem = f"lacks {error}" if isinstance(error, KeyError) else str(error)
        raise source.error(
            f"is no measured material that brdfkit saved ({problem[:120].strip('.')}); {REMEDY}"
        ) from error


def write(obj: object, stream: IO[bytes]) -> None:
    """Write a `Measured` with all its data; the format's own interpolation becomes a table."""
    data = require_measured(obj, NAME, anisotropic=True)
    about: dict[str, Any] = {
        "brdfkit": __version__,
        "name": str(data.name),
        "channels": [str(channel) for channel in data.channels],
        "info": {str(key): str(note) for key, note in data.info.items()},
        "anisotropic": bool(data.anisotropic),
    }
    arrays: dict[str, AnyArray] = {}
    if data.is_table or data.has_lookup:
        about["phi_d_period"] = float(data.table.phi_d_period)
        arrays["table"] = data.table.values
    if not data.is_table:
        arrays |= {name: getattr(data.samples, name) for name in SAMPLES}
    if data.standard_error is not None:
        arrays["standard_error"] = data.standard_error
    if data.evidence is not None:
        arrays["evidence"] = data.evidence.astype(np.uint8)
    text = np.frombuffer(json.dumps(about).encode(), np.uint8)
    stream.write(_pack_arrays_into_zip({FIRST: text, **arrays}))


def _make_measured(about: dict[str, Any], arrays: Mapping[str, AnyArray]) -> Measured:
    """Make a `Measured` from the notes `about` and the `arrays` of a file, by their names.

    Raises `ValueError`, `KeyError` and others for missing or wrong entries.
    """
    details = {key: about[key] for key in ("name", "channels", "info")}
    words = [about["name"], *about["channels"], *about["info"], *about["info"].values()]
    if not all(isinstance(word, str) for word in words):
        raise ValueError("a name, a channel or a note is no text")
    errors = arrays.get("standard_error")
    if "values" in arrays:
        return _make_measured_from_samples(about, arrays, details, errors)
    if errors is not None:
        errors = errors.reshape(arrays["table"].shape)
    measured = Measured.from_table(
        arrays["table"], phi_d_period=float(about["phi_d_period"]), **details, standard_error=errors
    )
    evidence = arrays.get("evidence")
    if evidence is None:
        return measured
    if evidence.dtype != np.uint8 or evidence.shape != measured.samples.valid.shape:
        raise ValueError(f"evidence has the shape {evidence.shape}")
    if evidence.max() > GUESSED:
        raise ValueError(f"evidence is {evidence.max()}, where 0, 1 or 2 belongs")
    return replace(measured, evidence=evidence)


def _make_measured_from_samples(
    about: dict[str, Any],
    arrays: Mapping[str, AnyArray],
    details: dict[str, Any],
    errors: FloatArray | None,
) -> Measured:
    """Make a `Measured` from samples in a file, with exactly the stored directions.

    `about` are the file's notes, and `arrays` its arrays by name. `details` are the arguments that
    samples and tables share, and `errors` the standard errors, or None.
    """
    wi, wo, values, valid = (arrays[name] for name in SAMPLES)
    if not all(((np.abs(w) < 1 + 1e-6) | np.isnan(w)).all() for w in (wi, wo)):
        raise ValueError("a direction is no unit vector")
    lookup = None
    if "table" in arrays:
        lookup = Measured.from_table(
            arrays["table"], phi_d_period=float(about["phi_d_period"]), **details
        ).table
    measured = Measured.from_samples(
        wi,
        wo,
        values,
        valid=valid,
        **details,
        anisotropic=about["anisotropic"] is True,
        standard_error=errors,
        lookup=lookup,
    )
    samples = measured.samples
    for stored, unit in ((wi, samples.wi), (wo, samples.wo)):
        if not np.allclose(stored[samples.valid], unit[samples.valid], atol=1e-6):
            raise ValueError("a direction is no unit vector")
    return replace(measured, _samples=replace(samples, wi=wi, wo=wo))


def _read_members(source: Source) -> dict[str, bytes]:
    """Return the content of each array file in the zip archive, as bytes by the array's name."""
    try:
        with zipfile.ZipFile(io.BytesIO(source.data)) as archive:
            infos = [i for i in archive.infolist() if i.filename in MEMBERS]
            if any(i.compress_type != zipfile.ZIP_STORED for i in infos):
                raise source.error(
                    "is compressed inside; save it with numpy.savez and compress it as a whole"
                )
            return {i.filename.removesuffix(".npy"): archive.read(i) for i in infos}
    except BrdfkitError:
        raise
    # For a damaged archive, zipfile may raise any of these errors
    except (zipfile.BadZipFile, RuntimeError, ValueError, EOFError, OSError, struct.error) as error:
        raise source.error(f"is no whole zip archive ({str(error)[:100]}); {REMEDY}") from error


def _parse_array(source: Source, name: str, data: bytes) -> AnyArray:
    """Return the array in `data`, the bytes of the member `name` as `numpy.save` writes them."""
    header = HEADER.match(data)
    shape = [int(n) for n in header[2].split(b",") if n.strip()] if header else []
    dtype = np.dtype(header[1].decode()) if header else np.dtype(float)
    if not header or 0 in shape or math.prod(shape) * dtype.itemsize != len(data) - header.end():
        raise source.error(f"its member {name} is no whole array as brdfkit saves it; {REMEDY}")
    array = np.frombuffer(data, dtype, offset=header.end()).reshape(shape)
    if dtype.kind == "b":
        return array.view(np.uint8) != 0
    with np.errstate(invalid="ignore"):  # NumPy would warn where it converts a signalling NaN
        return array if dtype.kind == "u" else array.astype(float)


def _pack_arrays_into_zip(arrays: Mapping[str, AnyArray]) -> bytes:
    """Return a zip archive with the uncompressed `arrays`; equal arrays give equal bytes."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_STORED) as archive:
        for name, array in arrays.items():
            member = io.BytesIO()
            np.lib.format.write_array(member, np.ascontiguousarray(array), version=(1, 0))
            info = zipfile.ZipInfo(f"{name}.npy", EPOCH)
            info.create_system = 3  # state Unix on every system: equal data give equal bytes
            archive.writestr(info, member.getvalue())
    return packed.getvalue()
