"""DICOM: a series of slices in a folder, or one file of it (`.dcm`).

Slices are sorted by their position along the normal of the image, not by name or number. Values are
rescaled by slope and intercept, which gives HU for CT. DICOM's world, x to the patient's left and y
to the back, is converted to right and front. If a folder has several series, ``scans#2`` is the one
with the SeriesNumber 2.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.volumes.formats import _volume_file
from brdfkit.volumes.formats._dicom_slices import Slice, read_pixels, read_slice
from brdfkit.volumes.formats._volume_file import (
    LPS_TO_RAS,
    StoredVolume,
    VolumeFile,
    make_grid_transform,
)

NAME = "DICOM"
SUFFIXES = (".dcm", ".dicom", ".ima")

UNEVEN = 0.01  # a slice is missing if distances deviate from their median by more than this share
TURNED = 1e-3  # largest difference between components of the unit vectors of parallel slices


def sniff(head: bytes) -> bool:
    """Return whether a file's first bytes contain DICOM's magic letters."""
    return head[128:132] == b"DICM"


def read_header(file: VolumeFile) -> StoredVolume:
    """Read the headers of a DICOM series from the files of a folder, or from a single file."""
    pydicom = file.import_package("pydicom", "pydicom")
    paths = _volume_file.list_files(file.path) if file.path.is_dir() else [file.path]
    images = [image for path in paths if (image := read_slice(file, pydicom, path)) is not None]
    images = _choose_series(file, images)
    _require_equal_grids(file, images)
    first = images[0]
    normal = np.cross(*first.frame)
    images.sort(key=lambda image: float(normal @ image.place))
    step = _find_slice_step(file, images, normal)
    rescaled = any((image.slope, image.intercept) != (1, 0) for image in images)
    dtype = np.dtype(np.float32) if rescaled else first.dtype

    def read_rescaled_layers() -> Iterator[AnyArray]:
        for image in images:
            values = read_pixels(file, pydicom, image)
            scaled = values * image.slope + image.intercept if rescaled else values
            yield scaled.astype(dtype, copy=False)

    between_rows, between_columns = first.spacing
    directions = np.column_stack([*first.frame, step])
    to_world = make_grid_transform(directions, (between_columns, between_rows, 1), images[0].place)
    return StoredVolume(
        shape=(len(images), *first.shape),
        dtype=dtype,
        layers=read_rescaled_layers,
        to_world=LPS_TO_RAS @ to_world,
        unit="mm",
        axes="RAS",
    )


def find_series_description(path: Path) -> str:
    """Return the description of the series to which a DICOM image belongs; "" if it has none."""
    import pydicom

    try:
        header = pydicom.dcmread(path, stop_before_pixels=True, specific_tags=["SeriesDescription"])
        return str(header.get("SeriesDescription", ""))
    except Exception:  # of many classes, for files that are none or damaged
        return ""


def _choose_series(file: VolumeFile, images: list[Slice]) -> list[Slice]:
    """Return the images of one series: the number behind '#' in the path, or the only series.

    Raises `BrdfkitError` if there are no images, or if several series fit.
    """
    if not images:
        raise file.error("has no DICOM image; name the folder of a series")
    series: dict[tuple[str, str], list[Slice]] = {}
    for image in images:
        series.setdefault(image.series, []).append(image)
    chosen = [s for (number, _), s in series.items() if file.part in (None, number)]
    if len(chosen) != 1:
        known = ", ".join(f"{number} ({len(s)} slices)" for (number, _), s in series.items())
        raise file.error(
            f"has several series, with the numbers {known}; name one: {file.path.name}#1"
        )
    return chosen[0]


def _require_equal_grids(file: VolumeFile, images: list[Slice]) -> None:
    """Raise `BrdfkitError` unless all slices have the same pixel grid and are parallel."""
    first = images[0]
    for what in ("shape", "dtype", "spacing"):
        if any(not np.array_equal(getattr(i, what), getattr(first, what)) for i in images):
            raise file.error(f"its slices differ in {what}; keep those of one volume")
    if any(np.abs(image.frame - first.frame).max() > TURNED for image in images):
        raise file.error("its slices are not parallel; keep those of one volume")


def _find_slice_step(file: VolumeFile, images: list[Slice], normal: FloatArray) -> FloatArray:
    """Return the mean vector (3,) [mm] from one of the sorted slices to the next.

    For a single slice it is the slice's thickness along the `normal`. Raises `BrdfkitError` if
    slices coincide or one is missing.
    """
    if len(images) == 1:
        return normal * images[0].thickness
    places = np.array([image.place for image in images])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    # The lower median: of only two steps, the longer one is where a slice is missing
    median = float(np.sort(steps)[(len(steps) - 1) // 2])
    if not steps.min() > 1e-3 * max(median, 1e-6):
        raise file.error(
            "has several slices at one place, such as at several times; keep those of one volume"
        )
    uneven = np.abs(steps / median - 1)
    if uneven.max() > UNEVEN:
        at = int(uneven.argmax())
        raise file.error(
            f"slices are missing: {steps[at]:.4g} mm between the slices {at + 1} and {at + 2}, "
            f"elsewhere {median:.4g} mm; save or fetch the series again"
        )
    return (places[-1] - places[0]) / (len(places) - 1)
