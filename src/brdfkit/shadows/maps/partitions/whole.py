"""One map for all."""

from brdfkit.shadows.maps.partition import Part, Partition


def partition(scene, placement, project, resolution):
    import mitsuba as mi

    return Partition([Part(project(placement), resolution)], lambda p: mi.UInt32(0))
