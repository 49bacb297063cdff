"""A scene shared among several shadow maps: its parts, and to which of them a point belongs."""

from collections.abc import Callable
from dataclasses import dataclass

import drjit as dr
import numpy as np

from brdfkit.core.projective.body import Empty
from brdfkit.shadows.maps.projection import Projection


@dataclass(frozen=True)
class Part:
    """A part of a scene that has a shadow map of its own: its `projection`, and how many texels the
    map has along a side, its `resolution`."""

    projection: Projection
    resolution: int


@dataclass(frozen=True)
class Partition:
    """The `parts`, and the number of each point's part, `which(p)`, a `mi.UInt32` of a
    `mi.Point3f`: a point has one part, or none where there is no part of that number."""

    parts: list[Part]
    which: Callable


def filled(placements, project, resolution, which):
    """The `Partition` of those `placements` that hold something, in which number i of `which` is
    the i-th placement; `Empty` where none does."""
    parts, numbers = [], []
    for placement in placements:
        try:
            projection = project(placement)
        except Empty as empty:
            nothing = empty
            numbers.append(len(placements))
            continue
        numbers.append(len(parts))
        parts.append(Part(projection, resolution))
    if not parts:
        raise nothing
    return Partition(parts, renumbered(which, numbers))


def renumbered(which, numbers):
    """`which`, whose results are places in the list of `numbers`, with those numbers in place."""
    import mitsuba as mi

    table = mi.UInt32(np.array(numbers, np.uint32))
    dr.make_opaque(table)
    return lambda p: dr.gather(mi.UInt32, table, which(p))
