"""Finds the voxel that the picture shows under the pointer."""

from __future__ import annotations

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.viewing.camera import Camera
from brdfkit.viewing.volumes.live_volume import LiveVolume
from brdfkit.viewing.volumes.rays import cast_rays

LEAST_STEPS = 512  # along a ray; thinner voxels have a step each
MATTER_OPACITY = 0.5  # of a ray up to the voxel that counts as the first visible one


def find_visible_voxel(
    live: LiveVolume,
    camera: Camera,
    place: FloatArray,
    aspect: float,
    clip: list[list[float]],
    table: AnyArray,
    extinction: float,
    largest: bool = False,
) -> list[int] | None:
    """Return the voxel (i, j, k) that is visible at a `place` of the picture, or None.

    It is where the opacity along the ray reaches `MATTER_OPACITY`, or the densest voxel if it never
    does. With `largest` it is the voxel with the largest value. `aspect` is the picture's width
    over its height, and `clip` are the corners of the visible part in the unit cube. `table` is
    RGBA of the transfer function, and `extinction` that where A is 1 [1/unit of length].
    """
    steps = max(LEAST_STEPS, *live.volume.size)
    rays = cast_rays(live, camera, place[None], aspect, np.array(clip, float), steps)
    depths = rays.depths(table, extinction)[0]
    if largest:
        first = int(rays.values[0].argmax())
        return rays.voxels[0, first].tolist() if depths[first] > 0 else None
    if not depths.max() > 0:
        return None
    reached = np.flatnonzero(1 - np.exp(-np.cumsum(depths)) >= MATTER_OPACITY)
    first = int(reached[0] if len(reached) else depths.argmax())
    return rays.voxels[0, first].tolist()
