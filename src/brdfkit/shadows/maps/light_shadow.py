"""All shadow maps of one light."""

from dataclasses import replace

import drjit as dr

from brdfkit.core.errors import no_such
from brdfkit.shadows.maps.bias import AUTOMATIC
from brdfkit.shadows.maps.depth_pass import depth_pass
from brdfkit.shadows.maps.light_depth import LightDepth
from brdfkit.shadows.maps.map_point import map_point
from brdfkit.shadows.maps.techniques import seen_by, techniques


class ShadowMap:
    """What a light sees of a scene, to be looked up.

    scene : a `mi.Scene`.
    projection : a `Projection` through the light.
    reach : of the light through the scene [unit of length].
    lookup : of a file of `filters/`, its class `Lookup`.
    resolution : texels along a side.
    bias : a `Bias`.
    see : of that file, its function `see` where it has one: what the map holds in place of depths.
    """

    def __init__(
        self, scene, projection, reach, lookup, resolution=1024, bias=AUTOMATIC, see=depth_pass
    ):
        self.depths = see(scene, projection, resolution)
        self.lookup = lookup(self.depths)
        self.projection = projection.opaque()
        self.resolution, self.bias, self.reach = resolution, bias, reach

    def lit(self, p, n, active=True):
        """The share of the light that arrives at points `p` of surfaces with normals `n`."""
        point = map_point(self.projection, self.resolution, p, n, self.bias, self.reach, active)
        return self.lookup.lit(point)


DEPTHS = ("projected", "linear")


class LightShadow:
    """The shadow of a scene in one light, by a technique.

    scene : a `mi.Scene`.
    placement : the `Placement` of the camera and the light in it.
    projection, filter, partition : names of files in the folders of those names.
    resolution : texels along a side of each map; `tiled` shares out those of one map.
    bias : a `Bias`.
    depth : what maps hold: "projected", the third coordinate of the projection's cube, in which
        planes stay planes, or "linear", the way of the light.
    settings : those of the three files, by the names in their `SETTINGS`.
    """

    def __init__(
        self,
        scene,
        placement,
        projection="focused",
        filter="depth",
        partition="whole",
        resolution=1024,
        bias=AUTOMATIC,
        depth="projected",
        **settings,
    ):
        names = {"projection": projection, "filter": filter, "partition": partition}
        chosen = techniques(names, settings)
        project = _holding(depth, chosen["projection"], placement)
        shared = chosen["partition"](scene, placement, project, resolution)
        self.which = shared.which
        reach, see = placement.reach, seen_by(filter)
        self.maps = [
            ShadowMap(scene, part.projection, reach, chosen["filter"], part.resolution, bias, see)
            for part in shared.parts
        ]

    def lit(self, p, n, active=True):
        """The share of the light, in [0, 1], that arrives at points `p` with normals `n`."""
        import mitsuba as mi

        part = self.which(p)
        inside = mi.Bool(active) & (part < len(self.maps))
        # all look-ups have the same code, and so a kernel has it once, however many parts there are
        lit = dr.switch(part, [each.lit for each in self.maps], p, n, inside)
        return dr.select(inside, lit, 1)


def _holding(depth, project, whole):
    """`project`, its maps holding this depth; linear ones the same for all parts of the whole."""
    if depth not in DEPTHS:
        raise no_such("depth", depth, DEPTHS)
    if depth == "projected":
        return project
    linear = LightDepth.through(whole)
    return lambda placement: replace(project(placement), depth=linear)
