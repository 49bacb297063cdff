"""`LightShadow`: one or more shadow maps of a light, which tell how much light reaches a point."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask, JitVector, MitsubaObject
from brdfkit.core.errors import no_such_error
from brdfkit.shadows.maps.depth_pass import render_depths
from brdfkit.shadows.maps.map_point import AUTOMATIC, Bias, find_map_point
from brdfkit.shadows.maps.partition import Partition, Setup
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import AnyProjection, LightDepth, Projection
from brdfkit.shadows.maps.techniques import find_map_renderer, make_techniques

DEPTHS = ("projected", "linear")


class ShadowMap:
    """One shadow map: the depths that a light sees, and a filter that looks receivers up in them.

    scene : a `mi.Scene`.
    projection : the map's projection, through the light.
    reach : length of the longest light ray through the scene [unit of length].
    lookup : the class `Lookup` of a filter, with its settings bound.
    resolution : number of texels along a side.
    bias : how receivers are moved before they are compared, so that they do not shadow themselves.
    render : the function that renders the map: `render_depths`, or the filter's own `render_map`.
    """

    def __init__(
        self,
        scene: MitsubaObject,
        projection: AnyProjection,
        reach: float,
        lookup: Callable[[Any], Any],
        resolution: int = 1024,
        bias: Bias = AUTOMATIC,
        render: Callable[..., Any] = render_depths,
    ) -> None:
        self.depths = render(scene, projection, resolution)
        self.lookup = lookup(self.depths)
        self.projection = projection.make_opaque()
        self.resolution, self.bias, self.reach = resolution, bias, reach

    def visibility(self, p: JitVector, n: JitVector, active: JitMask = True) -> JitFloat:
        """Return the share of the light that arrives at points `p` with surface normals `n`."""
        settings = self.bias, self.reach, active
        point = find_map_point(self.projection, self.resolution, p, n, *settings)
        return self.lookup.visibility(point)


class LightShadow:
    """The shadow of a scene in one light, by one or more shadow maps.

    scene : a `mi.Scene`.
    placement : the camera and the light in the scene.
    projection, filter, partition : names of techniques, that is, of files in `projections/`,
        `filters/` and `partitions/`.
    resolution : number of texels along a side of each map; the partition `tiled` divides the texels
        of one such map among its tiles.
    bias : how receivers are moved before they are compared, so that they do not shadow themselves.
    depth : "projected" stores the third coordinate of the projection, in which planes stay planes;
        "linear" stores the distance from the light.
    settings : settings of the three techniques, which the `SETTINGS` of their files declare.
    """

    def __init__(
        self,
        scene: MitsubaObject,
        placement: Placement,
        projection: str = "focused",
        filter: str = "depth",
        partition: str = "whole",
        resolution: int = 1024,
        bias: Bias = AUTOMATIC,
        depth: str = "projected",
        **settings: Any,
    ) -> None:
        names = {"projection": projection, "filter": filter, "partition": partition}
        technique = make_techniques(names, settings)
        project = _apply_depth_kind(depth, technique["projection"], placement)
        divided: Partition = technique["partition"](Setup(scene, placement, project, resolution))
        self.find_part = divided.find_part
        lookup, render = technique["filter"], find_map_renderer(filter)
        self.maps = [
            ShadowMap(
                scene, part.projection, placement.reach, lookup, part.resolution, bias, render
            )
            for part in divided.parts
        ]

    def visibility(self, p: JitVector, n: JitVector, active: JitMask = True) -> JitFloat:
        """Return the share of the light, in [0, 1], at points `p` with surface normals `n`."""
        import mitsuba as mi

        part = self.find_part(p)
        inside = mi.Bool(active) & (part < len(self.maps))
        # All maps are looked up by the same code, which `dr.switch` compiles only once
        lit = dr.switch(part, [each.visibility for each in self.maps], p, n, inside)
        return dr.select(inside, lit, 1)


def _apply_depth_kind(
    depth: str, project: Callable[[Placement], Projection], whole: Placement
) -> Callable[[Placement], Projection]:
    """Return the function `project`, changed to make projections with the named kind of depth.

    depth : a name in `DEPTHS`.
    project : function from a placement to the projection of its map.
    whole : placement of the whole scene, which sets the scale of linear depth.
    """
    if depth not in DEPTHS:
        raise no_such_error("depth", depth, DEPTHS)
    if depth == "projected":
        return project
    linear = LightDepth.from_placement(whole)
    return lambda placement: replace(project(placement), depth=linear)
