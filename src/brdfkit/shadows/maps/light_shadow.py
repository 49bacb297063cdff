"""`LightShadow`: all shadow maps of one light, and the share of its light at surface points."""

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
from brdfkit.shadows.maps.techniques import find_renderer, make_techniques

DEPTHS = ("projected", "linear")


class ShadowMap:
    """One shadow map: the light's view of a scene, in which points are looked up.

    scene : a `mi.Scene`.
    projection : a projection through the light.
    reach : the longest way of light through the scene [unit of length].
    lookup : the class `Lookup` of a file in `filters/`.
    resolution : texels along a side.
    bias : how receivers are moved towards the light.
    render : the function that renders the map: `render_depths`, or the file's own `render_map`.
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
        self.projection = projection.opaque()
        self.resolution, self.bias, self.reach = resolution, bias, reach

    def lit_share(self, p: JitVector, n: JitVector, active: JitMask = True) -> JitFloat:
        """Return the share of the light that arrives at points `p` with surface normals `n`."""
        settings = self.bias, self.reach, active
        point = find_map_point(self.projection, self.resolution, p, n, *settings)
        return self.lookup.lit_share(point)


class LightShadow:
    """The shadow of a scene in one light, by a technique.

    scene : a `mi.Scene`.
    placement : the camera and the light in the scene.
    projection, filter, partition : names of files in the folders of those names.
    resolution : texels along a side of each map; `tiled` shares out those of one map.
    bias : how receivers are moved towards the light.
    depth : what maps hold: "projected", the third coordinate of the projection's cube, in which
        planes stay planes, or "linear", the distance that the light has come.
    settings : of the three files, by the names in their `SETTINGS`.
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
        project = _use_depth(depth, technique["projection"], placement)
        divided: Partition = technique["partition"](Setup(scene, placement, project, resolution))
        self.part_of = divided.part_of
        lookup, render = technique["filter"], find_renderer(filter)
        self.maps = [
            ShadowMap(
                scene, part.projection, placement.reach, lookup, part.resolution, bias, render
            )
            for part in divided.parts
        ]

    def lit_share(self, p: JitVector, n: JitVector, active: JitMask = True) -> JitFloat:
        """Return the share of the light, in [0, 1], at points `p` with surface normals `n`."""
        import mitsuba as mi

        part = self.part_of(p)
        inside = mi.Bool(active) & (part < len(self.maps))
        # The look-ups of all parts have the same code, so that a kernel contains it only once
        lit = dr.switch(part, [each.lit_share for each in self.maps], p, n, inside)
        return dr.select(inside, lit, 1)


def _use_depth(
    depth: str, project: Callable[[Placement], Projection], whole: Placement
) -> Callable[[Placement], Projection]:
    """Return `project`, changed to hold this kind of depth, which `whole` scales if linear."""
    if depth not in DEPTHS:
        raise no_such_error("depth", depth, DEPTHS)
    if depth == "projected":
        return project
    linear = LightDepth.from_placement(whole)
    return lambda placement: replace(project(placement), depth=linear)
