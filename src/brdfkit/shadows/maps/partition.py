"""The division of a scene among several shadow maps, and the map to which each point belongs."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import JitInt, JitVector, MitsubaObject
from brdfkit.core.projective.body import Empty
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import AnyProjection, Projection


@dataclass(frozen=True)
class Setup:
    """The scene and the settings of its shadow maps, from which a partition is made.

    scene : a `mi.Scene`.
    placement : the camera and the light in it.
    project : function from a placement to the projection of its map.
    resolution : number of texels along a side of a map.
    """

    scene: MitsubaObject
    placement: Placement
    project: Callable[[Placement], Projection]
    resolution: int


@dataclass(frozen=True)
class Part:
    """A part of a scene with its own shadow map.

    projection : the projection of the map.
    resolution : number of texels along a side.
    """

    projection: AnyProjection
    resolution: int


@dataclass(frozen=True)
class Partition:
    """The division of a scene into parts with a shadow map each.

    parts : the parts.
    find_part : function from points, a `mi.Point3f`, to the indices of their parts, a `mi.UInt32`.
        For a point that no part contains, the index is beyond the end of `parts`.
    """

    parts: list[Part]
    find_part: Callable[[Any], Any]


def make_partition_from_placements(
    setup: Setup, placements: Iterable[Placement], find_placement: Callable[[Any], Any]
) -> Partition:
    """Make the partition with a part for each placement; placements without surfaces are left out.

    placements : cameras and lights that each cover a part of the scene.
    find_placement : function from points to the indices of the placements that cover them.

    Raises `Empty` if all placements are empty.
    """
    placements = list(placements)
    parts: list[Part] = []
    indices: list[int] = []
    for placement in placements:
        try:
            projection = setup.project(placement)
        except Empty as error:
            empty = error
            indices.append(len(placements))
            continue
        indices.append(len(parts))
        parts.append(Part(projection, setup.resolution))
    if not parts:
        raise empty
    return Partition(parts, _renumber_parts(find_placement, indices))


def _renumber_parts(
    find_placement: Callable[[Any], Any], indices: list[int]
) -> Callable[[Any], Any]:
    """Return a function that finds the index of a point's part, `indices[i]` in placement i."""
    import mitsuba as mi

    table = mi.UInt32(np.array(indices, np.uint32))
    dr.make_opaque(table)

    def find_part(p: JitVector) -> JitInt:
        return dr.gather(mi.UInt32, table, find_placement(p))

    return find_part
