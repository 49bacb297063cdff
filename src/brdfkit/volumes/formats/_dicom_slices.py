"""`Slice`: the header of a DICOM image as plain, checked numbers, and the reading of its pixels."""

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.volumes.formats._volume_file import VolumeFile


@dataclass(frozen=True, eq=False)
class Slice:
    """An image of a series.

    `series` is the number and the UID of the series. In DICOM's world [mm], `place` (3,) is the
    image's position, `frame` (2, 3) the directions along a row and along a column, and `spacing`
    the distances between rows and between columns.
    """

    path: Path
    series: tuple[str, str]
    shape: tuple[int, int]
    dtype: np.dtype[Any]
    place: FloatArray
    frame: FloatArray
    spacing: tuple[float, float]
    slope: float
    intercept: float
    thickness: float


def read_slice(file: VolumeFile, pydicom: Any, path: Path) -> Slice | None:
    """Read the `Slice` in a file; return None if it is not a DICOM image."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about values that the standard forbids
            header = pydicom.dcmread(path, stop_before_pixels=True)
            if "Rows" not in header:
                return None
            _require_plain(file, path, header)
            return _parse_header(path, header)
    except pydicom.errors.InvalidDicomError:
        return None
    except BrdfkitError:
        raise
    except AttributeError as error:  # a field that the file lacks
        raise file.error(f"{path.name} has no {error.name}; convert it, as by dcm2niix") from error
    except Exception as error:  # damaged values raise errors of many classes
        raise file.error(f"the header of {path.name} is damaged; fetch it again") from error


def read_pixels(file: VolumeFile, pydicom: Any, image: Slice) -> AnyArray:
    """Read the pixels of a `Slice`, without rescaling them."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            pixels: AnyArray = pydicom.dcmread(image.path).pixel_array
    except Exception as error:  # decoders raise errors of many classes
        reason = (str(error).splitlines() or [type(error).__name__])[0].rstrip(".")[:120]
        raise file.error(f"the pixels of {image.path.name} cannot be read ({reason})") from error
    if pixels.shape != image.shape:
        raise file.error(f"the pixels of {image.path.name} are cut short; fetch it again")
    return pixels


def _require_plain(file: VolumeFile, path: Path, header: Any) -> None:
    """Raise `BrdfkitError` unless an image is a single frame with one number per pixel."""
    if int(header.get("NumberOfFrames", 1) or 1) > 1:
        raise file.error(f"{path.name} has many frames (enhanced DICOM); convert it by dcm2niix")
    kind = header.PhotometricInterpretation
    if header.SamplesPerPixel != 1 or kind != "MONOCHROME2":
        raise file.error(f"{path.name} is {kind} where MONOCHROME2 belongs, one number at a voxel")


def _parse_header(path: Path, header: Any) -> Slice:
    """Return the `Slice` of a header; raise an error if a field is missing or damaged."""
    sign = "ui"[int(header.PixelRepresentation)]
    numbers: dict[str, Any] = {
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
