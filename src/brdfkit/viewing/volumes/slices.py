"""Slices through a volume as pictures, and the value of the voxel under the pointer."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.viewing.encoding import encode_png
from brdfkit.viewing.volumes.live_volume import LiveVolume
from brdfkit.volumes import Volume

# The axis that a plane is across, and the axes to its right and upwards
PLANES = (("z", "x", "y"), ("y", "x", "z"), ("x", "y", "z"))
LONGEST = 512  # pixels of a slice
RAY_STEPS = 512  # along which the first visible voxel is sought
MATTER_OPACITY = 0.5  # of a ray up to the voxel that counts as the first visible one


def draw_slices(
    volume: Volume, at: list[int], window: tuple[float, float], shown: list[int] | None = None
) -> tuple[list[dict[str, Any]], list[bytes]]:
    """Return the planes through the voxel `at` (i, j, k), and their pictures as PNGs.

    `window` are the values that are black and white. Planes through the voxel `shown` are left out.
    """
    planes, pictures = [], []
    low, high = window
    for axis, across, up in PLANES:
        through = "xyz".index(axis)
        if shown is not None and shown[through] == at[through]:
            continue
        voxels = np.take(volume.values, at[through], axis=2 - through)  # (above, right)
        step = -(-max(voxels.shape) // LONGEST)
        shares = (voxels[::step, ::step].astype(float) - low) / ((high - low) or 1.0)
        grey = np.rint(255 * np.clip(shares, 0, 1)).astype(np.uint8)
        pictures.append(encode_png(grey[::-1]))
        count = volume.size[through]
        planes.append({"axis": axis, "count": count, "across": across, "up": up})
    return planes, pictures


def move_crosshair(volume: Volume, at: list[int], plane: int, x: float, y: float) -> list[int]:
    """Return the voxel (i, j, k) at a place of a plane, 0 to 1 from its top left."""
    _, across, up = PLANES[plane]
    moved = list(at)
    for name, share in ((across, x), (up, 1 - y)):
        axis = "xyz".index(name)
        moved[axis] = int(np.clip(share * volume.size[axis], 0, volume.size[axis] - 1))
    return moved


def describe_voxel(volume: Volume, at: list[int], unit: str = "") -> str:
    """Return the value of a voxel (i, j, k), its place and its unit, in words."""
    i, j, k = at
    value = volume.values[k, j, i]
    place = volume.to_world[:3, :3] @ [i, j, k] + volume.to_world[:3, 3]
    where = ", ".join(f"{x:.4g}" for x in place)
    number = f"{int(value)}" if volume.labels else f"{float(value):.6g}"
    length = f" {volume.unit}" if volume.unit else ""
    return f"{number} {unit}".rstrip() + f" at voxel {i}, {j}, {k} ({where}{length})"


def find_visible_voxel(
    volume: LiveVolume,
    extinction: FloatArray,
    clip: list[list[float]],
    ray: tuple[FloatArray, FloatArray],
    densest: bool = False,
) -> list[int] | None:
    """Return the first voxel (i, j, k) that is visible along a `ray`, (origin, unit direction).

    It is where the opacity along the ray reaches `MATTER_OPACITY`, or the densest voxel if it never
    does, or if the view shows the `densest` voxels. None if the ray misses the visible part between
    the corners `clip` of the unit cube, or if all of it is transparent. `extinction` (VALUE_ROWS,)
    is that of the transfer function [1/unit of length].
    """
    scan, (origin, direction) = volume.volume, ray
    inverse = np.linalg.inv(scan.cube_to_world)
    o, d = inverse[:3, :3] @ origin + inverse[:3, 3], inverse[:3, :3] @ direction
    low, high = np.array(clip, float)
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (low - o) / d, (high - o) / d
    near, far = max(np.nanmax(np.minimum(a, b)), 0.0), np.nanmin(np.maximum(a, b))
    if not near < far:
        return None
    t = near + (np.arange(RAY_STEPS) + 0.5) / RAY_STEPS * (far - near)
    points = origin + t[:, None] * direction
    sigma = extinction[volume.find_rows(scan(points))]
    if not sigma.max() > 0:
        return None
    passed = np.cumsum(sigma) * (far - near) / RAY_STEPS
    reached = np.flatnonzero(1 - np.exp(-passed) >= MATTER_OPACITY)
    first = reached[0] if len(reached) and not densest else int(sigma.argmax())
    ijk = np.linalg.inv(scan.to_world) @ [*points[first], 1]
    return np.clip(np.rint(ijk[:3]), 0, np.array(scan.size) - 1).astype(int).tolist()
