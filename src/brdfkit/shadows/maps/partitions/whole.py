"""The partition with a single map for the whole scene."""

from brdfkit.shadows.maps.partition import Part, Partition, Setup


def make_partition(setup: Setup) -> Partition:
    """Make the partition with a single part."""
    import mitsuba as mi

    part = Part(setup.project(setup.placement), setup.resolution)
    return Partition([part], lambda p: mi.UInt32(0))
