"""Reading of DICOM images, the slices of a volume: checked numbers of a header, and the pixels."""

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
    """The header of a DICOM image, which is one slice of a volume.

    - `path`: file of the image
    - `series`: number and UID of the series of images to which the slice belongs
    - `shape`, `dtype`: numbers of rows and columns, and type of the stored pixels
    - `place`: position (3,) of the first pixel in the patient's coordinates [mm]
    - `frame`: unit vectors (2, 3) along a row and along a column
    - `spacing`: distance between rows and distance between columns [mm]
    - `slope`, `intercept`: the value of a voxel, such as HU, is slope × pixel + intercept
    - `thickness`: thickness of the slice [mm]
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
    """Read the header of the DICOM image at `path`; return None if the file is no DICOM image.

    `pydicom` is the imported package; errors name the folder or file that the user loads, `file`.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # pydicom warns of values that the standard forbids
            header = pydicom.dcmread(path, stop_before_pixels=True)
            if "Rows" not in header:
                return None
            _require_single_grey_image(file, path, header)
            return _parse_slice_header(path, header)
    except pydicom.errors.InvalidDicomError:
        return None
    except BrdfkitError:
        raise
    except AttributeError as error:  # pydicom's header has no attribute for a missing field
        raise file.error(f"{path.name} has no {error.name}; convert it, as by dcm2niix") from error
    except Exception as error:  # pydicom raises errors of many classes for damaged values
        raise file.error(f"the header of {path.name} is damaged; save or fetch it again") from error


def read_pixels(file: VolumeFile, pydicom: Any, image: Slice) -> AnyArray:
    """Read the pixels (rows, columns) of a slice as stored, before slope and intercept apply."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            pixels: AnyArray = pydicom.dcmread(image.path).pixel_array
    except Exception as error:  # decoders of compressed pixels raise errors of many classes
        reason = (str(error).splitlines() or [type(error).__name__])[0].rstrip(".")[:120]
        raise file.error(f"the pixels of {image.path.name} cannot be read ({reason})") from error
    if pixels.shape != image.shape:
        raise file.error(f"the pixels of {image.path.name} are cut short; save or fetch it again")
    return pixels


def _require_single_grey_image(file: VolumeFile, path: Path, header: Any) -> None:
    """Raise `BrdfkitError` unless a DICOM image is a single frame with one grey value per pixel."""
    if int(header.get("NumberOfFrames", 1) or 1) > 1:
        raise file.error(f"{path.name} has many frames (enhanced DICOM); convert it by dcm2niix")
    kind = header.PhotometricInterpretation
    if header.SamplesPerPixel != 1 or kind != "MONOCHROME2":
        raise file.error(f"{path.name} is {kind}; only MONOCHROME2, one number per voxel, is read")


def _parse_slice_header(path: Path, header: Any) -> Slice:
    """Convert a header of pydicom's to a `Slice`; raise an error if a field is missing or damaged.

    `read_slice` turns that error, whose class may be any, into a `BrdfkitError`.
    """
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
