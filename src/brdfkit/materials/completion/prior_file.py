"""Reads and writes priors: files `.npz` of NumPy, with the notes as JSON."""

import io
import json
import zipfile
import zlib
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import read_bytes, write_safely
from brdfkit.materials.completion.prior import Prior
from brdfkit.materials.completion.prior_cells import CELLS

VERSION = 1
ARRAYS = ("mean", "components", "remainder", "new_remainder")
EPOCH = (1980, 1, 1, 0, 0, 0)  # date of all members: equal priors give equal bytes
LARGEST_RANK = 200
# What NumPy, zipfile and JSON raise for files that are damaged, or something else
DAMAGES = (
    *(ValueError, KeyError, TypeError, AttributeError, OSError, EOFError, RuntimeError),
    *(zipfile.BadZipFile, zlib.error),
)


def require_npz(path: Path) -> None:
    """Raise `BrdfkitError` unless a path has the suffix of priors."""
    if path.suffix.lower() != ".npz":
        raise BrdfkitError(f"{path}: a prior is written as .npz; name such a file.")


def write_prior(prior: Prior, path: str | Path) -> None:
    """Write a prior; its components have 11 bits of precision, all else 24."""
    about = {
        "brdfkit_prior": VERSION,
        "name": prior.name,
        "materials": prior.materials,
        "sources": list(prior.sources),
        "terms": list(prior.terms),
        "wavelengths": list(prior.wavelengths),
    }
    arrays: dict[str, AnyArray] = {"about": np.frombuffer(json.dumps(about).encode(), np.uint8)}
    for name in ARRAYS:
        # Neighbouring numbers of a component are similar, so its transpose is smaller when packed
        array = getattr(prior, name).T
        arrays[name] = array.astype(np.float16 if name == "components" else np.float32)
    with write_safely(path) as part, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays.items():
            member = io.BytesIO()
            np.lib.format.write_array(member, np.ascontiguousarray(array), version=(1, 0))
            info = zipfile.ZipInfo(f"{name}.npy", EPOCH)
            info.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(info, member.getvalue())


def read_prior(path: Path) -> Prior:
    """Read a prior that `write_prior` wrote; raise `BrdfkitError` for any other file."""
    data = read_bytes(path)
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as members:
            about = json.loads(members["about"].tobytes())
            if about["brdfkit_prior"] != VERSION:
                raise ValueError(f"its version is {about['brdfkit_prior']}, not {VERSION}")
            arrays = {name: members[name].astype(float) for name in ARRAYS}
        components = np.ascontiguousarray(arrays["components"].T)
        check_arrays(arrays, components)
        low, high = map(float, about["wavelengths"])
        if not 0 <= low <= high:
            raise ValueError(f"its wavelengths are {low:g} to {high:g}")
        return Prior(
            str(about["name"]),
            arrays["mean"],
            components,
            arrays["remainder"],
            arrays["new_remainder"],
            int(about["materials"]),
            tuple(map(str, about["sources"])),
            tuple(map(str, about["terms"])),
            (low, high),
        )
    except DAMAGES as error:
        raise BrdfkitError(
            f"{path}: this is no prior that brdfkit wrote, or it is damaged "
            f"({str(error)[:100].strip('.')}); make it again with brdfkit prior."
        ) from error


def check_arrays(arrays: dict[str, AnyArray], components: AnyArray) -> None:
    """Raise `ValueError` for arrays of wrong shapes, or with numbers that cannot be."""
    for name in ("mean", "remainder", "new_remainder"):
        if arrays[name].shape != (CELLS,):
            raise ValueError(f"{name} has the shape {arrays[name].shape}, not ({CELLS},)")
    if components.ndim != 2 or len(components) != CELLS or components.shape[1] > LARGEST_RANK:
        raise ValueError(f"components have the shape {components.shape}")
    if not all(np.isfinite(array).all() for array in (*arrays.values(), components)):
        raise ValueError("a number is not finite")
    if min(arrays["remainder"].min(), arrays["new_remainder"].min()) < 0:
        raise ValueError("a variance is negative")
