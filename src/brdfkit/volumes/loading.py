"""`volumes.load`: reading a volume from a file or folder, within the available memory."""

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
from brdfkit.core.locate import find_file_or_name, split_part
from brdfkit.volumes import downsampling, formats, made
from brdfkit.volumes.formats import StoredVolume, VolumeFile
from brdfkit.volumes.summary.histograms import FEW_VALUES
from brdfkit.volumes.volume import Volume, require_transform

ROUNDING_WARNING = 1e-6  # share of the range of values above which rounding gives a warning
LARGEST_DOWNSAMPLE = 64  # that an error proposes
MEMORY_FACTOR = 1.2  # for the memory that Python and NumPy need besides the voxels


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
        Whether the values are labels, which are never averaged. By default the file decides, and a
        warning says if values are averaged that may be labels.
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
    voxels, steps = _to_triple("size", size, int), _to_triple("spacing", spacing, float)
    offset = None if offset is None else to_whole_number("offset", offset, 0)
    try:
        text = os.fspath(path)
    except TypeError:
        kind = type(path).__name__
        raise BrdfkitError(
            f"A volume is a Volume, or the path or name of one, and no {kind}; of an array "
            "brdfkit.volumes.Volume(array) makes one."
        ) from None
    found, part = split_part(text)
    place = find_file_or_name(found, "volume", made.list_names(), folders=True)
    if isinstance(place, str):
        if any(setting is not None for setting in (part, labels, dtype, spacing, offset)):
            raise BrdfkitError(f"{text} is made: it takes size and downsample alone.")
        if voxels is not None:
            _require_memory_to_make(place, voxels)
        volume = made.make(place, voxels)
        return volume if downsample == 1 else volume.resized(downsample)
    file = VolumeFile(place, part, voxels, dtype, offset)
    with np.errstate(all="ignore"):  # `require_transform` checks the numbers of damaged headers
        stored = formats.read_header(file)
    if labels is not None:
        stored = replace(stored, labels=labels)
    if steps is not None:
        stored = replace(stored, to_world=_set_spacing(stored.to_world, steps))
    return _read_voxels(file, stored, downsample, warn=labels is None and downsample > 1)


def looks_like_volume(name: str) -> bool:
    """Return whether a word of the command line means a volume.

    It does if it is the name of a synthetic volume, a folder of a series, or a file with the suffix
    of a format. A .hdr file that begins like Radiance's maps is not Analyze's, and no volume.
    """
    path, _ = split_part(name)
    if name in made.list_names() or formats.is_series(path):
        return True
    return formats.has_format(str(path)) and not _is_radiance(path)


def _is_radiance(path: Path) -> bool:
    """Return whether a file is a map in Radiance's format."""
    if path.suffix.lower() != ".hdr" or not path.is_file():
        return False
    with path.open("rb") as stream:
        return stream.read(2) == b"#?"


def _read_voxels(file: VolumeFile, stored: StoredVolume, downsample: int, warn: bool) -> Volume:
    """Read the `Volume` of a file; `warn` if values are averaged that may be labels."""
    require_transform(stored.to_world, file.path)
    _require_memory(file, stored, downsample)
    shape = downsampling.reduce_shape(stored.shape, downsample)
    values = np.empty(shape, _loaded_dtype(stored, downsample))
    layers = stored.layers()
    different: set[float] = set()  # values of one voxel of each block
    rounding = 0.0
    ends: list[float] = []  # smallest and largest values of layers
    # A double beyond float32 becomes infinite, which Volume refuses
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(shape[0]):
            slab = np.stack(list(itertools.islice(layers, downsample)))
            exact = downsampling.reduce_slab(slab, downsample, stored.labels)
            values[k] = exact
            if exact.dtype.kind == "f" and exact.dtype.itemsize > values.dtype.itemsize:
                rounding = max(rounding, float(np.abs(values[k] - exact).max()))
                ends += [exact.min(), exact.max()]
            if warn and len(different) <= FEW_VALUES:
                different.update(np.unique(slab[0, ::downsample, ::downsample]).tolist())
    to_world = downsampling.reduce_transform(stored.to_world, downsample)
    name = _make_name(file)
    if ends and np.isfinite(rounding) and rounding > ROUNDING_WARNING * (max(ends) - min(ends)):
        warnings.warn(
            f"{name}: its values, {min(ends):.10g} to {max(ends):.10g}, are kept in single "
            f"precision, by which they are off by up to {rounding:.2g}; subtract what they have in "
            "common first.",
            stacklevel=3,
        )
    if not stored.labels and _may_be_labels(different, values.size):
        warnings.warn(
            f"{name} has {len(different)} different values, all whole, of which means were taken: "
            "if they are labels, load it with labels=True (--labels), else with labels=False.",
            stacklevel=3,
        )
    return Volume(values, to_world, name, stored.labels, stored.unit, stored.axes)


def _may_be_labels(different: set[float], count: int) -> bool:
    """Return whether `count` voxels have few `different` values, all of them whole numbers."""
    return 1 < len(different) <= min(FEW_VALUES, count / 8) and all(
        float(v).is_integer() for v in different
    )


def _loaded_dtype(stored: StoredVolume, downsample: int) -> np.dtype[Any]:
    """Return the type in which voxels are loaded."""
    if stored.dtype.kind == "f" or (downsample > 1 and not stored.labels):
        return np.dtype(np.float32)
    return stored.dtype.newbyteorder("=")


def _require_memory(file: VolumeFile, stored: StoredVolume, downsample: int) -> None:
    """Raise `BrdfkitError` if loading the voxels needs more memory than is available."""
    available = psutil.virtual_memory().available
    needed = _memory_needed(stored, downsample)
    if needed <= available:
        return
    larger = range(downsample + 1, LARGEST_DOWNSAMPLE + 1)
    fits = next((n for n in larger if _memory_needed(stored, n) <= available), None)
    size = "×".join(map(str, stored.shape[::-1]))
    raise file.error(
        f"its {size} voxels would take about {needed / 1e9:,.2g} GB of memory, of which "
        f"{available / 1e9:,.2g} GB are available; "
        + (f"load it with downsample={fits}" if fits else "check that it is the right file")
    )


def _require_memory_to_make(name: str, size: tuple[int, int, int]) -> None:
    """Raise `BrdfkitError` if making a synthetic volume needs more memory than is available."""
    available, needed = psutil.virtual_memory().available, made.memory_needed(name, size)
    if needed > available:
        raise BrdfkitError(
            f"{name}: {'×'.join(map(str, size))} voxels would take about {needed / 1e9:,.2g} GB of "
            f"memory, of which {available / 1e9:,.2g} GB are available; give a smaller size."
        )


def _memory_needed(stored: StoredVolume, downsample: int) -> float:
    """Return an upper bound of the memory [bytes] that loading needs."""
    voxels = math.prod(downsampling.reduce_shape(stored.shape, downsample))
    _, ny, nx = stored.shape
    slab = ny * nx * (downsample * stored.dtype.itemsize + np.dtype(float).itemsize)
    return MEMORY_FACTOR * (voxels * _loaded_dtype(stored, downsample).itemsize + slab)


def _make_name(file: VolumeFile) -> str:
    """Return the name of a volume: its file's without suffixes, and its part's."""
    name = file.path.name
    stem = name.removesuffix(".gz")[: -len(Path(name.removesuffix(".gz")).suffix) or None]
    return f"{stem}#{file.part}" if file.part else stem


def _to_triple(what: str, given: Any, kind: type[int | float]) -> Any:
    """Return three numbers above 0 from one or three, or None from None."""
    if given is None:
        return None
    numbers = np.ravel(given)
    numbers = np.repeat(numbers, 3) if numbers.size == 1 else numbers
    fine = numbers.size == 3 and numbers.dtype.kind in "iuf" and (numbers > 0).all()
    if not fine or not all(np.isfinite(n) and kind(n) == n for n in numbers):
        whole = "whole " if kind is int else ""
        raise BrdfkitError(f"{what} = {given!r} should be one or three {whole}numbers above 0.")
    return tuple(kind(n) for n in numbers)


def _set_spacing(to_world: FloatArray, spacing: tuple[float, float, float]) -> FloatArray:
    """Return the transform with another spacing along the same axes."""
    changed = to_world.copy()
    changed[:3, :3] *= np.array(spacing) / np.linalg.norm(changed[:3, :3], axis=0)
    return changed
