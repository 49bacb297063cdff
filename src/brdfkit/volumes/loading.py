"""`volumes.load`: reads a volume from a file or folder, if it fits into the available memory."""

from __future__ import annotations

import itertools
import math
import os
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import psutil

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.locate import find_file_or_name, split_file_and_part
from brdfkit.volumes import downsampling, formats, made
from brdfkit.volumes.formats import StoredVolume, VolumeFile
from brdfkit.volumes.summary.histograms import FEW_VALUES
from brdfkit.volumes.volume import Volume, require_transform

ROUNDING_WARNING = 1e-6  # rounding errors above this share of the range of values give a warning
LARGEST_DOWNSAMPLE = 64  # the largest `downsample` that an error about memory proposes
MEMORY_FACTOR = 1.2  # ratio of the memory that loading needs to that of the arrays of voxels


class TooLargeError(BrdfkitError):
    """The error for a file whose voxels need more memory than there is.

    `downsample` is the smallest one with which they fit, or None.
    """

    def __init__(self, message: str, downsample: int | None) -> None:
        super().__init__(message)
        self.downsample = downsample


def load(
    path: str | os.PathLike[str],
    *,
    downsample: int = 1,
    labels: bool | None = None,
    size: int | tuple[int, int, int] | None = None,
    dtype: Any = None,
    spacing: float | tuple[float, float, float] | None = None,
    offset: int | None = None,
) -> Volume:
    """Load a volume of voxels from a file or folder, or make a synthetic one by its name.

    The formats are NIfTI, NRRD, DICOM, VTI, MetaImage, TIFF stacks, Mitsuba's .vol and raw voxels.
    The content decides on the format, then the suffix. Medical formats are in RAS: x, y and z of
    the world point to the patient's right, front and head. The header is read first, to check that
    the voxels fit into the memory.

    Parameters
    ----------
    path : str or Path
        The file, or the folder of a series of DICOM or TIFF files. ``model.vti#facies`` names one
        of several arrays, ``scans#2`` a series, ``brain.nii#0`` a point in time. The synthetic
        volumes are ``marschner_lobb``, ``shepp_logan``, ``slab``, ``smoke``, ``sphere``.
    downsample : int, default 1
        Number of voxels along each axis that are averaged to one while the file is read, 1 or more.
    labels : bool, optional
        Whether the values are labels, such as numbers of tissues, which are never averaged. By
        default the file decides, and a warning is given if averaged values may be labels.
    size : int or (int, int, int), optional
        Numbers of voxels along x, y, z, of raw voxels or of a synthetic volume.
    dtype : str or dtype, optional
        The type of raw voxels, such as "uint16", or ">i2" for the other byte order.
    spacing : float or (float, float, float), optional
        Distances between voxels along x, y, z, in place of those in the file.
    offset : int, optional
        Number of bytes before raw voxels.

    Returns
    -------
    Volume
        The values, and their place in the world.

    Raises
    ------
    BrdfkitError
        If the file cannot be read, or if voxels are not finite or all 0. If there is too little
        memory, the error proposes a `downsample` that fits.

    Examples
    --------
    >>> volumes.load("marschner_lobb", size=41)
    marschner_lobb: 41×41×41 voxels of 0.04878×0.04878×0.04878 units, float32, 4.4e-05 to 0.999956
    """
    downsample = to_whole_number("downsample", downsample, 1)
    voxels, steps = (
        _parse_three_numbers("size", size, int),
        _parse_three_numbers("spacing", spacing, float),
    )
    offset = None if offset is None else to_whole_number("offset", offset, 0)
    try:
        text = os.fspath(path)
    except TypeError:
        kind = type(path).__name__
        raise BrdfkitError(
            f"A volume is a Volume, or the path or name of one, and no {kind}; make a volume of an "
            "array by brdfkit.volumes.Volume(array)."
        ) from None
    found, part = split_file_and_part(text)
    place = find_file_or_name(found, "volume", made.list_volume_names(), folders=True)
    if isinstance(place, str):
        if any(setting is not None for setting in (part, labels, dtype, spacing, offset)):
            raise BrdfkitError(f"{text} is synthetic: it takes only size and downsample.")
        if voxels is not None:
            _require_memory_to_make(place, voxels)
        volume = made.make_volume(place, voxels)
        return volume if downsample == 1 else volume.resized(downsample)
    file = VolumeFile(place, part, voxels, dtype, offset)
    with np.errstate(all="ignore"):  # `require_transform` checks the numbers of damaged headers
        stored = formats.read_header(file)
    if labels is not None:
        stored = replace(stored, labels=labels)
    if steps is not None:
        stored = replace(stored, to_world=_replace_spacing(stored.to_world, steps))
    return _read_voxels(file, stored, downsample, warn=labels is None and downsample > 1)


def looks_like_volume(name: str) -> bool:
    """Return whether an argument of the command line, such as a path, means a volume.

    It may be the name of a synthetic volume, a folder of DICOM or TIFF files, or a file with the
    suffix of a volume format. An environment map `.hdr` of Radiance's is no volume, although NIfTI
    has that suffix as well.
    """
    path, _ = split_file_and_part(name)
    if name in made.list_volume_names() or formats.is_image_series(path):
        return True
    return formats.has_volume_suffix(str(path)) and not _is_radiance_map(path)


def _is_radiance_map(path: Path) -> bool:
    """Return whether a .hdr file is an environment map of Radiance's, not a NIfTI header."""
    if path.suffix.lower() != ".hdr" or not path.is_file():
        return False
    with path.open("rb") as stream:
        return stream.read(2) == b"#?"


def _read_voxels(file: VolumeFile, stored: StoredVolume, downsample: int, warn: bool) -> Volume:
    """Read the voxels of a file, slab by slab, as a `Volume`.

    A block of `downsample` voxels along each axis becomes one voxel. With `warn`, values that are
    averaged but may be labels give a warning.
    """
    require_transform(stored.to_world, file.path)
    _require_memory(file, stored, downsample)
    shape = downsampling.downsample_shape(stored.shape, downsample)
    values = np.empty(shape, _choose_loaded_dtype(stored, downsample))
    layers = stored.layers()
    different: set[float] = set()  # different values found so far, in one voxel of each block
    rounding = 0.0
    ends: list[float] = []  # smallest and largest values of each layer
    # A float64 beyond float32's range becomes infinite, which `Volume` refuses
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(shape[0]):
            slab = np.stack(list(itertools.islice(layers, downsample)))
            exact = downsampling.downsample_slab(slab, downsample, stored.labels)
            values[k] = exact
            if exact.dtype.kind == "f" and exact.dtype.itemsize > values.dtype.itemsize:
                rounding = max(rounding, float(np.abs(values[k] - exact).max()))
                ends += [exact.min(), exact.max()]
            if warn and len(different) <= FEW_VALUES:
                different.update(np.unique(slab[0, ::downsample, ::downsample]).tolist())
    to_world = downsampling.downsample_transform(stored.to_world, downsample)
    name = _make_volume_name(file)
    if ends and np.isfinite(rounding) and rounding > ROUNDING_WARNING * (max(ends) - min(ends)):
        warnings.warn(
            f"{name}: its values, {min(ends):.10g} to {max(ends):.10g}, are stored in single "
            f"precision, with errors up to {rounding:.2g}; subtract a constant from them first.",
            stacklevel=3,
        )
    if not stored.labels and _may_be_labels(different, values.size):
        warnings.warn(
            f"{name} has {len(different)} different values, all whole, and was averaged: if they "
            "are labels, load it with labels=True (--labels), otherwise with labels=False.",
            stacklevel=3,
        )
    return Volume(values, to_world, name, stored.labels, stored.unit, stored.axes)


def _may_be_labels(different: set[float], count: int) -> bool:
    """Return whether the `different` values of `count` voxels are few whole numbers, like labels.

    At most one value per eight voxels counts as few.
    """
    return 1 < len(different) <= min(FEW_VALUES, count / 8) and all(
        float(v).is_integer() for v in different
    )


def _choose_loaded_dtype(stored: StoredVolume, downsample: int) -> np.dtype[Any]:
    """Return the type of the loaded voxels: float32 for floats and means, else the file's type."""
    if stored.dtype.kind == "f" or (downsample > 1 and not stored.labels):
        return np.dtype(np.float32)
    return stored.dtype.newbyteorder("=")


def _require_memory(file: VolumeFile, stored: StoredVolume, downsample: int) -> None:
    """Raise `TooLargeError` if loading the voxels needs more memory than is available."""
    available = psutil.virtual_memory().available
    needed = _estimate_memory(stored, downsample)
    if needed <= available:
        return
    larger = range(downsample + 1, LARGEST_DOWNSAMPLE + 1)
    fits = next((n for n in larger if _estimate_memory(stored, n) <= available), None)
    size = "×".join(map(str, stored.shape[::-1]))
    error = file.error(
        f"its {size} voxels would take about {needed / 1e9:,.2g} GB of memory, of which "
        f"{available / 1e9:,.2g} GB are available; "
        + (f"load it with downsample={fits}" if fits else "check that it is the right file")
    )
    raise TooLargeError(str(error), fits)


def _require_memory_to_make(name: str, size: tuple[int, int, int]) -> None:
    """Raise `BrdfkitError` if making a synthetic volume needs more memory than is available."""
    available, needed = psutil.virtual_memory().available, made.estimate_memory(name, size)
    if needed > available:
        raise BrdfkitError(
            f"{name}: {'×'.join(map(str, size))} voxels would take about {needed / 1e9:,.2g} GB of "
            f"memory, of which {available / 1e9:,.2g} GB are available; give a smaller size."
        )


def _estimate_memory(stored: StoredVolume, downsample: int) -> float:
    """Return an upper bound of the memory [bytes] that loading a file's voxels needs."""
    voxels = math.prod(downsampling.downsample_shape(stored.shape, downsample))
    _, ny, nx = stored.shape
    slab = ny * nx * (downsample * stored.dtype.itemsize + np.dtype(float).itemsize)
    return MEMORY_FACTOR * (voxels * _choose_loaded_dtype(stored, downsample).itemsize + slab)


def _make_volume_name(file: VolumeFile) -> str:
    """Return a volume's name: its file's name without suffixes, and the part behind '#'."""
    name = file.path.name
    stem = name.removesuffix(".gz")[: -len(Path(name.removesuffix(".gz")).suffix) or None]
    return f"{stem}#{file.part}" if file.part else stem


def _parse_three_numbers(what: str, given: Any, kind: type[int | float]) -> Any:
    """Convert a user's setting, one or three numbers above 0, to three of the type `kind`.

    None stays None. Errors call the setting `what`.
    """
    if given is None:
        return None
    numbers = np.ravel(given)
    numbers = np.repeat(numbers, 3) if numbers.size == 1 else numbers
    fine = numbers.size == 3 and numbers.dtype.kind in "iuf" and (numbers > 0).all()
    if not fine or not all(np.isfinite(n) and kind(n) == n for n in numbers):
        whole = "whole " if kind is int else ""
        raise BrdfkitError(f"{what} = {given!r} should be one or three {whole}numbers above 0.")
    return tuple(kind(n) for n in numbers)


def _replace_spacing(to_world: FloatArray, spacing: tuple[float, float, float]) -> FloatArray:
    """Return the transform `to_world` (4, 4) with another voxel `spacing` along the same axes."""
    changed = to_world.copy()
    changed[:3, :3] *= np.array(spacing) / np.linalg.norm(changed[:3, :3], axis=0)
    return changed
