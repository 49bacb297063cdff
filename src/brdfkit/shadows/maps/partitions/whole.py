"""One map for the whole scene."""

from collections.abc import Callable

from brdfkit.core.array_types import MitsubaObject
from brdfkit.shadows.maps.partition import Part, Partition
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection


def make_partition(
    scene: MitsubaObject,
    placement: Placement,
    project: Callable[[Placement], Projection],
    resolution: int,
) -> Partition:
    """Make the partition with a single part."""
    import mitsuba as mi

    return Partition([Part(project(placement), resolution)], lambda p: mi.UInt32(0))
