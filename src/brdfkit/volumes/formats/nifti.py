"""NIfTI-1 and NIfTI-2: `.nii`, `.nii.gz`, and pairs of `.hdr` and `.img`.

The header has two transforms from voxels to the patient's coordinates, called sform and qform. As
in nibabel, the sform is used if it has a code above 0, otherwise the qform. The axis x of the
voxels is the fastest, and values may be scaled by a slope. ``brain.nii#3`` is the fourth of several
volumes, counted from 0.
"""

from collections.abc import Iterator
from math import prod
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.volumes.formats._streams import make_opener, read_layers, require_enough_bytes
from brdfkit.volumes.formats._volume_file import Shape, StoredVolume, VolumeFile

NAME = "NIfTI"
SUFFIXES = (".nii", ".nii.gz", ".hdr", ".img")

LABELS = 1002  # the "intent code" by which a header marks its values as labels
UNITS = {"mm": "mm", "meter": "m", "micron": "µm"}


def sniff(head: bytes) -> bool:
    """Return whether a file's first bytes contain the magic number of NIfTI-1 or NIfTI-2."""
    return head[344:348] in (b"n+1\0", b"ni1\0") or head[4:8] in (b"n+2\0", b"ni2\0")


def read_header(file: VolumeFile) -> StoredVolume:
    """Read the header of a NIfTI file."""
    nibabel = file.import_package("nibabel", "nibabel")
    if not str(file.path).lower().endswith(SUFFIXES):
        raise file.error("is NIfTI by its content; rename it to .nii, or .nii.gz if it is packed")
    try:
        image = nibabel.load(file.path)
        header, dtype = image.header, image.header.get_data_dtype()
        sizes = tuple(map(int, image.shape))
        codes = [int(header[name]) for name in ("sform_code", "qform_code")]
        unit = UNITS.get(header.get_xyzt_units()[0], "mm" if any(codes) else "")
        slope, intercept = image.dataobj.slope, image.dataobj.inter
        start, intent = int(image.dataobj.offset), int(header["intent_code"])
    except Exception as error:
        raise file.error(
            f"is not a NIfTI file, or is damaged ({_summarise_error(error)}); "
            "save or fetch it again"
        ) from error
    if dtype.kind not in "iuf":
        raise file.error(f"has {dtype} at each voxel, colours or vectors; it should be one number")
    shape, number = _choose_volume(file, sizes)
    path = Path(image.file_map["image"].filename)
    packed = path.suffix.lower() == ".gz"
    volume = prod(shape) * dtype.itemsize
    require_enough_bytes(
        file, path, 0 if packed else start + number * volume, shape, dtype, "gzip" if packed else ""
    )
    start += number * volume
    stream = make_opener(path, 0, "gzip", start) if packed else make_opener(path, start)
    scaled = (slope, intercept) != (1, 0)

    def read_scaled_layers() -> Iterator[AnyArray]:
        for layer in read_layers(file, stream, shape, dtype):
            yield (layer * slope + intercept).astype(np.float32) if scaled else layer

    return StoredVolume(
        shape=shape,
        dtype=np.dtype(np.float32) if scaled else dtype,
        layers=read_scaled_layers,
        to_world=image.affine,
        labels=intent == LABELS,
        unit=unit,
        axes="RAS" if any(codes) else "",
    )


def _choose_volume(file: VolumeFile, sizes: tuple[int, ...]) -> tuple[Shape, int]:
    """Return the shape (nz, ny, nx) of a file's volume, and its number among several volumes.

    `sizes` are the file's dimensions (nx, ny, nz, ...). The number behind '#' in the user's path
    chooses the volume. Raises `BrdfkitError` if there is no such volume.
    """
    if len(sizes) < 3 or min(sizes) < 1:
        raise file.error(f"has {'×'.join(map(str, sizes))} voxels; a volume has three dimensions")
    count = prod(sizes[3:])
    if file.part is None and count > 1:
        raise file.error(f"has {count} volumes; name one, from 0: {file.path.name}#0")
    part = file.part or "0"
    number = int(part) if part.isdecimal() else -1
    if not 0 <= number < count:
        raise file.error(f"has no volume '#{file.part}'; name one of 0 to {count - 1}")
    return (sizes[2], sizes[1], sizes[0]), number


def _summarise_error(error: Exception) -> str:
    """Return the first line of an error's text, or the name of its class if it has no text."""
    return (str(error).splitlines() or [type(error).__name__])[0].rstrip(".")
