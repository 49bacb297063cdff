"""Slices through a volume as pictures, and the value of the voxel under the pointer."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.viewing.encoding import encode_png
from brdfkit.viewing.volumes.camera import Camera
from brdfkit.volumes import Volume

# The axis that a plane is across, and the axes to its right and upwards
PLANES = (("z", "x", "y"), ("y", "x", "z"), ("x", "y", "z"))
LONGEST = 512  # pixels of a slice
RAY_STEPS = 512  # along which the first visible voxel is sought
MATTER_OPACITY = 0.5  # of a ray up to the voxel that counts as the first visible one


def draw_slices(volume: Volume, at: list[int]) -> tuple[list[dict[str, Any]], list[bytes]]:
    """Return the planes through the voxel `at` (i, j, k), and their pictures as PNGs."""
    planes, pictures = [], []
    low, high = volume.window
    for axis, across, up in PLANES:
        through = "xyz".index(axis)
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
    volume: Volume,
    table: AnyArray,
    extinction: float,
    camera: Camera,
    place: FloatArray,
    aspect: float,
) -> list[int] | None:
    """Return the first voxel (i, j, k) that a ray through a place of the picture meets.

    It is where the opacity along the ray reaches `MATTER_OPACITY`, or the densest voxel if it never
    does; None if the ray misses the volume or all of it is transparent. `table` (n, 4) is the
    transfer function over the range of values.
    """
    origin, direction = camera.cast_ray(place[0], place[1], aspect)
    inverse = np.linalg.inv(volume.cube_to_world)
    o, d = inverse[:3, :3] @ origin + inverse[:3, 3], inverse[:3, :3] @ direction
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = -o / d, (1 - o) / d
    near, far = max(np.nanmax(np.minimum(a, b)), 0.0), np.nanmin(np.maximum(a, b))
    if not near < far:
        return None
    t = near + (np.arange(RAY_STEPS) + 0.5) / RAY_STEPS * (far - near)
    points = origin + t[:, None] * direction
    low, high = volume.range
    rows = np.clip((volume(points) - low) / ((high - low) or 1.0), 0, 1) * (len(table) - 1)
    opacity = table[np.rint(rows).astype(int), 3]
    passed = np.cumsum(extinction * opacity) * (far - near) / RAY_STEPS
    if not opacity.max() > 0:
        return None
    reached = np.flatnonzero(1 - np.exp(-passed) >= MATTER_OPACITY)
    first = reached[0] if len(reached) else int(opacity.argmax())
    ijk = np.linalg.inv(volume.to_world) @ [*points[first], 1]
    return np.clip(np.rint(ijk[:3]), 0, np.array(volume.size) - 1).astype(int).tolist()
