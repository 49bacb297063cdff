"""DICOM: a series of slices, a folder or one file of it (`.dcm`).

Slices are sorted by their position along the normal of the image, not by name or number. Values are
rescaled (slope and intercept: HU of CT). DICOM's world, LPS, is turned to RAS. Of several series in
a folder ``scans#2`` names the one with the SeriesNumber 2.
"""

import numpy as np

from brdfkit.volumes.formats import _stored
from brdfkit.volumes.formats._dicom_slices import pixels, read_slice
from brdfkit.volumes.formats._stored import LPS_TO_RAS, Stored, transform

NAME = "DICOM"
SUFFIXES = (".dcm", ".dicom", ".ima")

UNEVEN = 0.01  # of the distance of slices: beyond it one is missing
TURNED = 1e-3  # of the components of directions


def sniff(head):
    """Whether the head has DICOM's magic letters."""
    return head[128:132] == b"DICM"


def find(file):
    """The volume of a series of DICOM, of the folder or of the file."""
    pydicom = file.package("pydicom", "pydicom")
    paths = _stored.files(file.path) if file.path.is_dir() else [file.path]
    images = [image for path in paths if (image := read_slice(file, pydicom, path)) is not None]
    images = _one_series(file, images)
    _require_alike(file, images)
    first = images[0]
    normal = np.cross(*first.frame)
    images.sort(key=lambda image: float(normal @ image.place))
    step = _step(file, images, normal)
    rescaled = any((image.slope, image.intercept) != (1, 0) for image in images)
    dtype = np.dtype(np.float32) if rescaled else first.dtype

    def layers():
        for image in images:
            values = pixels(file, pydicom, image)
            scaled = values * image.slope + image.intercept if rescaled else values
            yield scaled.astype(dtype, copy=False)

    between_rows, between_columns = first.spacing
    directions = np.column_stack([*first.frame, step])
    to_world = transform(directions, (between_columns, between_rows, 1), images[0].place)
    return Stored(
        shape=(len(images), *first.shape),
        dtype=dtype,
        layers=layers,
        to_world=LPS_TO_RAS @ to_world,
        unit="mm",
        axes="RAS",
    )


def _one_series(file, images):
    """The images of the series that is named, or of the only one."""
    if not images:
        raise file.error("holds no image of DICOM; name the folder of a series")
    series = {}
    for image in images:
        series.setdefault(image.series, []).append(image)
    chosen = [s for (number, _), s in series.items() if file.part in (None, number)]
    if len(chosen) != 1:
        known = ", ".join(f"{number} ({len(s)} slices)" for (number, _), s in series.items())
        raise file.error(
            f"holds several series by their numbers, {known}; name one: {file.path.name}#1"
        )
    return chosen[0]


def _require_alike(file, images):
    """Raise `BrdfkitError` unless the slices can be of one volume."""
    first = images[0]
    for what in ("shape", "dtype", "spacing"):
        if any(not np.array_equal(getattr(i, what), getattr(first, what)) for i in images):
            raise file.error(f"its slices differ in {what}; keep those of one volume")
    if any(np.abs(image.frame - first.frame).max() > TURNED for image in images):
        raise file.error("its slices are turned to each other; keep those of one volume")


def _step(file, images, normal):
    """From a slice to the next one, a vector (3,) [mm]; of a single slice, its thickness."""
    if len(images) == 1:
        return normal * images[0].thickness
    places = np.array([image.place for image in images])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    usual = float(np.sort(steps)[(len(steps) - 1) // 2])  # the median; of two, the smaller
    if not steps.min() > 1e-3 * max(usual, 1e-6):
        raise file.error(
            "has several slices at one place, as of several times; keep those of one volume"
        )
    uneven = np.abs(steps / usual - 1)
    if uneven.max() > UNEVEN:
        at = int(uneven.argmax())
        raise file.error(
            f"slices are missing: {steps[at]:.4g} mm between the slices {at + 1} and {at + 2}, "
            f"elsewhere {usual:.4g} mm; fetch the series again"
        )
    return (places[-1] - places[0]) / (len(places) - 1)
