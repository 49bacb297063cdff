"""DICOM: a series of slices, a folder or one file of it (`.dcm`).

Slices are sorted by their position along the normal of the image, not by name or number. Values are
rescaled (slope and intercept: HU of CT). DICOM's world, LPS, is turned to RAS. Of several series in
a folder ``scans#2`` names the one with the SeriesNumber 2.
"""

import warnings
from itertools import groupby

import numpy as np

from brdfkit.volumes.formats import _folders
from brdfkit.volumes.formats._axes import LPS_TO_RAS, transform
from brdfkit.volumes.formats._stored import Stored

NAME = "DICOM"
SUFFIXES = (".dcm", ".dicom", ".ima")

UNEVEN = 0.01  # of the distance of slices: beyond it one is missing
ALIKE = "Rows", "Columns", "PixelSpacing", "BitsAllocated", "PixelRepresentation"
NEEDED = "ImagePositionPatient", "ImageOrientationPatient", "PixelSpacing", "Rows", "Columns"


def sniff(head):
    """Whether the head has DICOM's magic letters."""
    return head[128:132] == b"DICM"


def find(file):
    """The volume of a series of DICOM, of the folder or of the file."""
    pydicom = file.package("pydicom", "pydicom")
    paths = _folders.files(file.path) if file.path.is_dir() else [file.path]
    slices = _one_series(file, [s for p in paths if (s := _header(pydicom, p)) is not None])
    first = slices[0]
    _require_slices(file, slices)
    normal = np.cross(*np.reshape(_numbers(first.ImageOrientationPatient), (2, 3)))
    slices.sort(key=lambda s: float(normal @ _numbers(s.ImagePositionPatient)))
    step = _step(file, slices)
    rescaled = any(_scale(s) != (1.0, 0.0) for s in slices)
    bits = first.BitsAllocated // 8
    dtype = np.dtype(np.float32 if rescaled else f"{'iu'[1 - first.PixelRepresentation]}{bits}")
    shape = (len(slices), int(first.Rows), int(first.Columns))
    return Stored(
        shape=shape,
        dtype=dtype,
        layers=lambda: _layers(file, pydicom, slices, dtype),
        to_world=LPS_TO_RAS @ _to_world(slices[0], step),
        unit="mm",
        axes="RAS",
    )


def _header(pydicom, path):
    """What stands before the pixels of a file; None if it is no DICOM."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of values that the standard forbids
            return pydicom.dcmread(path, stop_before_pixels=True)
    except (pydicom.errors.InvalidDicomError, EOFError, OSError, ValueError):
        return None


def _one_series(file, headers):
    images = [h for h in headers if "Rows" in h]
    if not images:
        raise file.error("holds no image of DICOM; name the folder of a series")
    by_series = lambda h: (str(h.get("SeriesNumber", "")), h.get("SeriesInstanceUID", ""))  # noqa: E731
    series = {}
    for (number, _), members in groupby(sorted(images, key=by_series), by_series):
        series.setdefault(number, []).append(list(members))
    if file.part is None and sum(map(len, series.values())) == 1:
        return next(iter(series.values()))[0]
    chosen = series.get(file.part or "", [])
    if len(chosen) != 1:
        known = ", ".join(f"{number} ({len(s)} slices)" for number, m in series.items() for s in m)
        raise file.error(
            f"holds several series by their numbers, {known}; name one: {file.path.name}#1"
        )
    return chosen[0]


def _require_slices(file, slices):
    """Raise `BrdfkitError` unless the slices are plain images, alike, with a place in the world."""
    first = slices[0]
    if any(int(s.get("NumberOfFrames", 1)) > 1 for s in slices):
        raise file.error("has many frames in a file (enhanced DICOM); convert it, as by dcm2niix")
    for name in NEEDED:
        if any(name not in s for s in slices):
            raise file.error(f"a slice has no {name}, and so no place; convert it, as by dcm2niix")
    if any(s.SamplesPerPixel != 1 or s.PhotometricInterpretation != "MONOCHROME2" for s in slices):
        raise file.error(
            f"is {first.PhotometricInterpretation} where MONOCHROME2 belongs, one number at a voxel"
        )
    for name in ALIKE:
        if any(s[name].value != first[name].value for s in slices):
            raise file.error(f"its slices differ in {name}; keep those of one volume")
    turned = [_numbers(s.ImageOrientationPatient) for s in slices]
    if np.ptp(turned, axis=0).max() > 1e-3:
        raise file.error("its slices are turned to each other; keep those of one volume")


def _step(file, slices):
    """From a slice to the next one, a vector (3,) [mm]; of a single slice, its thickness."""
    places = np.array([_numbers(s.ImagePositionPatient) for s in slices])
    if len(slices) == 1:
        rows = np.reshape(_numbers(slices[0].ImageOrientationPatient), (2, 3))
        return np.cross(*rows) * float(slices[0].get("SliceThickness") or 1)
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    usual = float(np.sort(steps)[(len(steps) - 1) // 2])  # the median; of two, the smaller
    if not steps.min() > 1e-3 * max(usual, 1e-6):
        raise file.error(
            "has several slices at one place, as of several times; keep those of one volume"
        )
    if np.abs(steps / usual - 1).max() > UNEVEN:
        at = int(np.abs(steps / usual - 1).argmax())
        raise file.error(
            f"slices are missing: {steps[at]:.4g} mm between the slices {at + 1} and {at + 2}, "
            f"elsewhere {usual:.4g} mm; fetch the series again"
        )
    return (places[-1] - places[0]) / (len(places) - 1)


def _to_world(first, step):
    """The transform from indices (column, row, slice) to DICOM's world."""
    along_row, along_column = np.reshape(_numbers(first.ImageOrientationPatient), (2, 3))
    between_rows, between_columns = _numbers(first.PixelSpacing)
    directions = np.column_stack([along_row, along_column, step])
    spacing = between_columns, between_rows, 1
    return transform(directions, spacing, _numbers(first.ImagePositionPatient))


def _layers(file, pydicom, slices, dtype):
    for header in slices:
        try:
            pixels = pydicom.dcmread(header.filename).pixel_array
        except Exception as error:  # of each of its decoders another
            name = str(header.filename).rpartition("/")[2]
            raise file.error(f"the pixels of {name} cannot be read ({_line(error)})") from error
        slope, intercept = _scale(header)
        yield pixels if dtype.kind != "f" else (pixels * slope + intercept).astype(dtype)


def _scale(header):
    return float(header.get("RescaleSlope", 1)), float(header.get("RescaleIntercept", 0))


def _numbers(values):
    return np.array(values, float)


def _line(error):
    return str(error).splitlines()[0].rstrip(".")[:120] if str(error) else type(error).__name__
