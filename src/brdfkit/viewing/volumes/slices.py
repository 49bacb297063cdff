"""Slices through a volume as pictures, and the voxel under the pointer in them, in words."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from brdfkit.viewing.encoding import encode_png
from brdfkit.volumes import Volume
from brdfkit.volumes.orientation import list_slice_planes

LONGEST = 512  # pixels of a slice


def draw_slices(
    volume: Volume, at: list[int], window: tuple[float, float], shown: list[int] | None = None
) -> tuple[list[dict[str, Any]], list[bytes]]:
    """Return the planes through the voxel `at` (i, j, k), and their pictures as PNGs.

    `window` are the values that are black and white. Planes through the voxel `shown` are left out.
    """
    planes, pictures = [], []
    low, high = window
    for number, plane in enumerate(list_slice_planes(volume)):
        through = plane.axes[2]
        if shown is not None and shown[through] == at[through]:
            continue
        voxels = plane.cut(volume.values, at[through])
        step = -(-max(voxels.shape) // LONGEST)
        shares = (voxels[::step, ::step].astype(float) - low) / ((high - low) or 1.0)
        pictures.append(encode_png(np.rint(255 * np.clip(shares, 0, 1)).astype(np.uint8)))
        planes.append({"number": number, **asdict(plane)})
    return planes, pictures


def move_crosshair(volume: Volume, at: list[int], plane: int, x: float, y: float) -> list[int]:
    """Return the voxel (i, j, k) at a place of a plane, 0 to 1 from its top left."""
    moved = list_slice_planes(volume)[plane].locate(x, y, volume.size)
    return [moved.get(axis, index) for axis, index in enumerate(at)]


def describe_voxel(volume: Volume, at: list[int], unit: str = "") -> str:
    """Return the value of a voxel (i, j, k), its place and its unit, in words."""
    i, j, k = at
    value = volume.values[k, j, i]
    place = volume.to_world[:3, :3] @ [i, j, k] + volume.to_world[:3, 3]
    where = ", ".join(f"{x:.4g}" for x in place)
    number = f"{int(value)}" if volume.labels else f"{float(value):.6g}"
    length = f" {volume.unit}" if volume.unit else ""
    return f"{number} {unit}".rstrip() + f" at voxel {i}, {j}, {k} ({where}{length})"
