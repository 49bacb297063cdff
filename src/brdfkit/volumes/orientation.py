"""Where the axes of a grid point in the world or in a patient, and the planes that show slices."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.volumes.volume import Volume

Ends = tuple[tuple[str, str], ...]  # names of where each axis starts and where it ends

# Ends of the world's axes x, y and z
PATIENT: Ends = (("left", "right"), ("back", "front"), ("feet", "head"))
LETTERS: Ends = (("L", "R"), ("P", "A"), ("I", "S"))  # the same: posterior, anterior ...
WORLD: Ends = (("-x", "+x"), ("-y", "+y"), ("-z", "+z"))

# The world's axes to the right, upwards and through the plane
PLANES = (("Axial", "z", (0, 1, 2)), ("Coronal", "y", (0, 2, 1)), ("Sagittal", "x", (1, 2, 0)))
# In pictures of patients x and y point to the left: their right, or their front, is at the left
PATIENT_WAYS = -1, 1, 1


@dataclass(frozen=True)
class SlicePlane:
    """A plane of voxels as it is shown.

    `axes` are the grid's axes (0 to 2) to the right, upwards and through the plane; `ways` are 1
    where the index of voxels increases to the right, upwards, and to the patient's right, front or
    head, otherwise -1. `ends` are the names at the left, right, lower and upper edge.
    """

    name: str
    axes: tuple[int, ...]
    ways: tuple[int, ...]
    ends: tuple[str, ...]

    def cut(self, values: AnyArray, index: int) -> AnyArray:
        """Return the slice at an index through values (nz, ny, nx), its rows from the top."""
        across, up, through = self.axes
        voxels = np.take(values, index, axis=2 - through)  # of the other axes, the higher one first
        upright = voxels if up > across else voxels.T
        return upright[:: -self.ways[1], :: self.ways[0]]

    def locate(self, x: float, y: float, size: tuple[int, ...]) -> dict[int, int]:
        """Return the index along each axis of the plane at a place, 0 to 1 from the top left."""
        indices = {}
        for axis, way, share in zip(self.axes, self.ways, (x, 1 - y), strict=False):
            along = share if way > 0 else 1 - share
            indices[axis] = int(np.clip(np.floor(along * size[axis]), 0, size[axis] - 1))
        return indices


def find_nearest_axes(to_world: FloatArray) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Return the world's axis that is nearest to each of the grid's, and 1 or -1 for its sign.

    `to_world` is a transform (4, 4), such as `Volume.to_world`. Each axis of the world is nearest
    to one of the grid's only, however the grid is turned.
    """
    columns = to_world[:3, :3] / np.linalg.norm(to_world[:3, :3], axis=0)
    nearest = max(permutations(range(3)), key=lambda rows: abs(columns[rows, range(3)]).prod())
    return nearest, tuple(1 if columns[row, k] > 0 else -1 for k, row in enumerate(nearest))


def name_ends(volume: Volume, patient: Ends = PATIENT) -> Ends:
    """Name where each axis of the grid starts and ends, such as ("left", "right").

    `patient` are the names of the ends of a patient's x, y and z; other volumes have "-x", "+x" ...
    """
    names = patient if volume.axes == "RAS" else WORLD
    axes, ways = find_nearest_axes(volume.to_world)
    return tuple(
        names[axis] if way > 0 else names[axis][::-1] for axis, way in zip(axes, ways, strict=True)
    )


def list_slice_planes(volume: Volume) -> tuple[SlicePlane, ...]:
    """Return the three planes in which slices of a volume are shown.

    Those of a patient are upright, with the patient's right at the left of the axial and coronal
    ones, and the front at the left of the sagittal one. Those of other volumes are along the axes
    of the grid, as they are stored.
    """
    if volume.axes != "RAS":
        return tuple(
            SlicePlane(name, axes, (1, 1, 1), ("", "xyz"[axes[0]], "", "xyz"[axes[1]]))
            for _, name, axes in PLANES
        )
    nearest, ways = find_nearest_axes(volume.to_world)
    planes = []
    for name, _, world in PLANES:
        axes = tuple(nearest.index(axis) for axis in world)
        shown = tuple(way * ways[k] for way, k in zip(PATIENT_WAYS, axes, strict=True))
        ends = (*LETTERS[world[0]][::-1], *LETTERS[world[1]])
        planes.append(SlicePlane(name, axes, shown, ends))
    return tuple(planes)
