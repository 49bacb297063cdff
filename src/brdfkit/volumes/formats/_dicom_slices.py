"""`Slice`: what the header of a DICOM image tells, as plain numbers, checked."""

import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from brdfkit.core.errors import BrdfkitError


@dataclass(frozen=True, eq=False)
class Slice:
    """An image of a series.

    `series`: its number and its UID; `place` (3,), `frame` (2, 3), the directions along a row and
    along a column, and `spacing`, between rows and between columns, in DICOM's world [mm].
    """

    path: Path
    series: tuple[str, str]
    shape: tuple[int, int]
    dtype: np.dtype
    place: np.ndarray
    frame: np.ndarray
    spacing: tuple[float, float]
    slope: float
    intercept: float
    thickness: float


def read_slice(file, pydicom, path):
    """The `Slice` in a file; None if it is no image of DICOM."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of values that the standard forbids
            header = pydicom.dcmread(path, stop_before_pixels=True)
            if "Rows" not in header:
                return None
            _require_plain(file, path, header)
            return _slice(path, header)
    except pydicom.errors.InvalidDicomError:
        return None
    except BrdfkitError:
        raise
    except AttributeError as error:  # a field that the file lacks
        raise file.error(f"{path.name} has no {error.name}; convert it, as by dcm2niix") from error
    except Exception as error:  # of each of its values another
        raise file.error(f"the header of {path.name} is damaged; fetch it again") from error


def pixels(file, pydicom, image):
    """The pixels of a `Slice`, as they are stored."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = pydicom.dcmread(image.path).pixel_array
    except Exception as error:  # of each of its decoders another
        told = (str(error).splitlines() or [type(error).__name__])[0].rstrip(".")[:120]
        raise file.error(f"the pixels of {image.path.name} cannot be read ({told})") from error
    if found.shape != image.shape:
        raise file.error(f"the pixels of {image.path.name} are cut short; fetch it again")
    return found


def _require_plain(file, path, header):
    if int(header.get("NumberOfFrames", 1) or 1) > 1:
        raise file.error(f"{path.name} has many frames (enhanced DICOM); convert it by dcm2niix")
    kind = header.PhotometricInterpretation
    if header.SamplesPerPixel != 1 or kind != "MONOCHROME2":
        raise file.error(f"{path.name} is {kind} where MONOCHROME2 belongs, one number at a voxel")


def _slice(path, header):
    sign = "ui"[int(header.PixelRepresentation)]
    numbers = {
        "place": np.array(header.ImagePositionPatient, float).reshape(3),
        "frame": np.array(header.ImageOrientationPatient, float).reshape(2, 3),
        "spacing": np.array(header.PixelSpacing, float).reshape(2),
        "slope": float(header.get("RescaleSlope", 1)),
        "intercept": float(header.get("RescaleIntercept", 0)),
        "thickness": float(header.get("SliceThickness") or 1),
    }
    if not all(np.isfinite(number).all() for number in numbers.values()):
        raise ValueError
    return Slice(
        path=path,
        series=(str(header.get("SeriesNumber", "")), str(header.get("SeriesInstanceUID", ""))),
        shape=(int(header.Rows), int(header.Columns)),
        dtype=np.dtype(f"{sign}{int(header.BitsAllocated) // 8}"),
        **numbers,
    )
