"""A scene divided among several shadow maps: its parts, and to which of them a point belongs."""

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
    """The scene, its placement and the maps' settings, from which a partition is made.

    scene : a `mi.Scene`.
    placement : the camera and the light in it.
    project : the function from a placement to the projection of a map.
    resolution : texels along a side of a map.
    """

    scene: MitsubaObject
    placement: Placement
    project: Callable[[Placement], Projection]
    resolution: int


@dataclass(frozen=True)
class Part:
    """A part of a scene with its own map: the `projection`, and the texels along a side."""

    projection: AnyProjection
    resolution: int


@dataclass(frozen=True)
class Partition:
    """The `parts` of a scene, and a function from points to the indices of their parts.

    `part_of(p)` is a `mi.UInt32` for a `mi.Point3f`; a point without a part has an index beyond
    the list.
    """

    parts: list[Part]
    part_of: Callable[[Any], Any]


def make_parts(
    setup: Setup, placements: Iterable[Placement], placement_of: Callable[[Any], Any]
) -> Partition:
    """Make the partition with a part for each of the placements that is not empty.

    placement_of : function from points to the indices of their placements.

    Raises `Empty` if all placements are.
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
    return Partition(parts, _renumber(placement_of, indices))


def _renumber(placement_of: Callable[[Any], Any], indices: list[int]) -> Callable[[Any], Any]:
    """Return the function that looks the results of `placement_of` up in a list of indices."""
    import mitsuba as mi

    table = mi.UInt32(np.array(indices, np.uint32))
    dr.make_opaque(table)

    def part_of(p: JitVector) -> JitInt:
        return dr.gather(mi.UInt32, table, placement_of(p))

    return part_of
