"""`volumes.load`: a volume from a file, a folder or a name, within the memory that there is."""

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
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.locate import find_file_or_name, split_part
from brdfkit.volumes import formats, made, reducing
from brdfkit.volumes.formats import VolumeFile
from brdfkit.volumes.summary.histograms import FEW
from brdfkit.volumes.volume import Volume, require_transform

# Values whose rounding is more than this share of their range are told of
COARSE = 1e-6
MOST = 65  # up to which a `downsample` is proposed
SPARE = 1.2  # times what the voxels take, for what Python and NumPy take beside them


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
    """A volume of voxels from a file of any known format, a folder, or the name of a made one.

    NIfTI, NRRD, DICOM, VTI, MetaImage, TIFF stacks, Mitsuba's .vol and raw voxels. The content
    decides the format, then the suffix. Medical formats come in RAS: x, y and z of the world point
    to the patient's right, front and head. The header alone is read before it is known that the
    voxels fit into the memory.

    Parameters
    ----------
    path : str or Path
        The file, or the folder of a series of DICOM or of TIFF files. ``model.vti#facies`` names
        one of several arrays, ``scans#2`` a series, ``brain.nii#0`` a point in time. Or the name of
        a volume that is made: ``marschner_lobb``, ``shepp_logan``, ``slab``, ``smoke``, ``sphere``.
    downsample : int, default 1
        Every block of so many voxels along each axis becomes one while the file is read; 1 or more.
    labels : bool, optional
        Whether the values are labels, of which no means are taken; as the file tells if it is None.
        Then a warning says where means are taken of values that may be labels.
    size : int or (int, int, int), optional
        Voxels along x, y, z: of raw voxels; and of a made volume, one number for all three.
    dtype : str or dtype, optional
        The type of raw voxels, such as "uint16", or ">i2" for the other byte order.
    spacing : float or (float, float, float), optional
        From voxel to voxel along x, y, z, in place of what the file tells.
    offset : int, optional
        Bytes before raw voxels.

    Returns
    -------
    Volume
        The values, and where they lie.

    Raises
    ------
    BrdfkitError
        For every file that cannot be read, with what is wrong and what to do; where there is too
        little memory, with a `downsample` that fits; for voxels that are not finite, or all 0.

    Examples
    --------
    >>> volumes.load("marschner_lobb", size=41)
    marschner_lobb: 41×41×41 voxels of 0.04878×0.04878×0.04878 units, float32, 4.4e-05 to 0.999956
    """
    downsample = to_whole_number("downsample", downsample, 1)
    voxels, steps = _triple("size", size, int), _triple("spacing", spacing, float)
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
    with np.errstate(all="ignore"):  # of a damaged header's numbers `require_transform` tells
        stored = formats.read_header(file)
    if labels is not None:
        stored = replace(stored, labels=labels)
    if steps is not None:
        stored = replace(stored, to_world=_spaced(stored.to_world, steps))
    return _read(file, stored, downsample, doubtful=labels is None and downsample > 1)


def looks_like_volume(name: str) -> bool:
    """Whether a word of the command line means a volume: a file by its suffix, a series, a name.

    A file .hdr that begins as Radiance's maps do is none: Analyze's begin otherwise.
    """
    path, _ = split_part(name)
    if name in made.list_names() or formats.is_series(path):
        return True
    return formats.has_format(str(path)) and not _is_radiance(path)


def _is_radiance(path):
    """Whether a file is a map in Radiance's format."""
    if path.suffix.lower() != ".hdr" or not path.is_file():
        return False
    with path.open("rb") as stream:
        return stream.read(2) == b"#?"


def _read(file, stored, downsample, doubtful):
    """The `Volume` that was found in a file; `doubtful`: whether to ask if it has means at all."""
    require_transform(stored.to_world, file.path)
    _require_memory(file, stored, downsample)
    shape = reducing.shape(stored.shape, downsample)
    values = np.empty(shape, _dtype(stored, downsample))
    layers = stored.layers()
    different: set[float] = set()  # values of one voxel of each block
    rounding, ends = 0.0, []
    # A double beyond float32 is infinite, which Volume refuses
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(shape[0]):
            slab = np.stack(list(itertools.islice(layers, downsample)))
            exact = reducing.reduced(slab, downsample, stored.labels)
            values[k] = exact
            if exact.dtype.kind == "f" and exact.dtype.itemsize > values.dtype.itemsize:
                rounding = max(rounding, np.abs(values[k] - exact).max())
                ends += [exact.min(), exact.max()]
            if doubtful and len(different) <= FEW:
                different.update(np.unique(slab[0, ::downsample, ::downsample]).tolist())
    to_world = reducing.transform(stored.to_world, downsample)
    name = _name(file)
    if ends and np.isfinite(rounding) and rounding > COARSE * (max(ends) - min(ends)):
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


def _may_be_labels(different, count):
    """Whether few whole numbers are the values of many voxels, of which there are `count`."""
    return 1 < len(different) <= min(FEW, count / 8) and all(
        float(v).is_integer() for v in different
    )


def _dtype(stored, downsample):
    """The type of the voxels that are kept."""
    if stored.dtype.kind == "f" or (downsample > 1 and not stored.labels):
        return np.dtype(np.float32)
    return stored.dtype.newbyteorder("=")


def _require_memory(file, stored, downsample):
    """Raise `BrdfkitError` where the voxels would take more memory than there is."""
    available = psutil.virtual_memory().available
    needed = _needed(stored, downsample)
    if needed <= available:
        return
    fits = next((n for n in range(downsample + 1, MOST) if _needed(stored, n) <= available), None)
    size = "×".join(map(str, stored.shape[::-1]))
    raise file.error(
        f"its {size} voxels would take about {needed / 1e9:,.2g} GB of memory, of which "
        f"{available / 1e9:,.2g} GB are available; "
        + (f"load it with downsample={fits}" if fits else "check that it is the right file")
    )


def _require_memory_to_make(name, size):
    """Raise `BrdfkitError` where a made volume would take more memory than there is."""
    available, needed = psutil.virtual_memory().available, made.memory_needed(name, size)
    if needed > available:
        raise BrdfkitError(
            f"{name}: {'×'.join(map(str, size))} voxels would take about {needed / 1e9:,.2g} GB of "
            f"memory, of which {available / 1e9:,.2g} GB are available; give a smaller size."
        )


def _needed(stored, downsample):
    """The memory [bytes] that loading takes at most."""
    kept = math.prod(reducing.shape(stored.shape, downsample))
    _, ny, nx = stored.shape
    slab = ny * nx * (downsample * stored.dtype.itemsize + np.dtype(float).itemsize)
    return SPARE * (kept * _dtype(stored, downsample).itemsize + slab)


def _name(file):
    """The name of a volume: that of its file without the suffixes, and of its part."""
    name = file.path.name
    stem = name.removesuffix(".gz")[: -len(Path(name.removesuffix(".gz")).suffix) or None]
    return f"{stem}#{file.part}" if file.part else stem


def _triple(what, given, kind):
    """Three numbers above 0 of a setting that is one, three or None."""
    if given is None:
        return None
    numbers = np.ravel(given)
    numbers = np.repeat(numbers, 3) if numbers.size == 1 else numbers
    fine = numbers.size == 3 and numbers.dtype.kind in "iuf" and (numbers > 0).all()
    if not fine or not all(np.isfinite(n) and kind(n) == n for n in numbers):
        whole = "whole " if kind is int else ""
        raise BrdfkitError(f"{what} = {given!r} should be one or three {whole}numbers above 0.")
    return tuple(kind(n) for n in numbers)


def _spaced(to_world, spacing):
    """The transform with another spacing along the same axes."""
    found = to_world.copy()
    found[:3, :3] *= np.array(spacing) / np.linalg.norm(found[:3, :3], axis=0)
    return found
