"""All shadow maps of one light."""

from dataclasses import replace

import drjit as dr

from brdfkit.errors import no_such
from brdfkit.shadow_maps.bias import AUTOMATIC
from brdfkit.shadow_maps.light_depth import LightDepth
from brdfkit.shadow_maps.shadow_map import ShadowMap
from brdfkit.shadow_maps.techniques import seen_by, techniques

DEPTHS = ("projected", "linear")


class LightShadow:
    """The shadow of a scene in one light, by a technique.

    scene : a `mi.Scene`.
    placement : the `Placement` of the camera and the light in it.
    projection, filter, partition : names of files in the folders of those names.
    resolution : texels along a side of each map.
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
        if depth not in DEPTHS:
            raise no_such("depth", depth, DEPTHS)
        linear = LightDepth.through(placement) if depth == "linear" else None
        self.parts = chosen["partition"](placement, chosen["projection"])
        see = seen_by(filter)
        self.maps = [
            ShadowMap(scene, projection, placement.reach, chosen["filter"], resolution, bias, see)
            for projection in (replace(part.projection, depth=linear) for part in self.parts)
        ]

    def lit(self, p, n, active=True):
        """The share of the light, in [0, 1], that arrives at points `p` with normals `n`."""
        import mitsuba as mi

        found, left = mi.Float(1), mi.Bool(active)
        for part, its_map in zip(self.parts, self.maps, strict=True):
            here = left & part.contains(p)
            found = dr.select(here, its_map.lit(p, n, here), found)
            left &= ~here
        return found
