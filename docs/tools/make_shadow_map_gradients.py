# ruff: noqa: I001, for brdfkit comes first: it chooses the LLVM that Dr.Jit loads
"""Makes `docs/shadow_map_gradients.md` and its picture: how wrong gradients of shadow maps are.

    python docs/tools/make_shadow_map_gradients.py    # minutes on two cores

Nine patches of ground receive light that things keep from them. The derivatives by the place of
these things, as Dr.Jit finds them through shadow maps, stand beside exact ones; see
`shadow_map_gradients/truth.py`. The words are in `shadow_map_gradients/page.py`.
"""

import sys
from functools import cached_property

import brdfkit  # noqa: F401
import drjit as dr
import numpy as np
from shadow_map_gradients import truth
from shadow_map_gradients import page
from shadow_map_gradients.scenes import LIGHTS, SCENES, load

from brdfkit.core.jit.llvm import use_variant
from brdfkit.shadows.maps.light_shadow import LightShadow
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.techniques import FILES

PROJECTIONS = tuple(FILES["projection"])
SIDE = 160  # points along a side of the ground that ask a map
RESOLUTION = page.RESOLUTION


class Case:
    """A scene in a light, of which the thing can be moved."""

    def __init__(self, name, light):
        import mitsuba as mi

        self.solid, self.scene = SCENES[name][0], load(name, light)
        (sensor,), (emitter,) = self.scene.sensors(), self.scene.emitters()
        self.placement = Placement.from_scene(self.scene, sensor, emitter)
        self.light = self.placement.light
        self.parameters = mi.traverse(self.scene)
        self.corners = mi.Point3f(self.solid.corners.T)
        x, y, area = truth.grid(SIDE)
        self.weights = truth.weights(x, y) * area
        self.p = mi.Point3f(mi.Float(x), mi.Float(y), mi.Float(np.zeros(len(x))))

    def move(self, way):
        """Put the thing where it is moved to by a `mi.Vector3f`."""
        self.parameters["thing.vertex_positions"] = dr.ravel(self.corners + way)
        self.parameters.update()

    @cached_property
    def true(self):
        """The derivatives (patches, 3), by the integral over the borders of shadows."""
        return truth.by_borders(self.scene, self.light, self.solid)

    @cached_property
    def by_rays(self):
        """The same by differences of what dense shadow rays find."""
        import mitsuba as mi

        x, y, area = truth.grid(truth.SIDE)
        w = truth.weights(x, y) * area

        def received(way):
            self.move(mi.Vector3f(way))
            return w @ truth.lit(self.scene, self.light, x, y)

        return self.at_rest(truth.by_differences(received))

    def lit(self, technique):
        import mitsuba as mi

        shadow = LightShadow(self.scene, self.placement, **{"resolution": RESOLUTION} | technique)
        return shadow.visibility(self.p, mi.Normal3f(0, 0, 1))

    def by_map(self, **technique):
        """The derivatives of what arrives by a technique, as Dr.Jit finds them."""
        import mitsuba as mi

        found = []
        for axis in np.eye(3):
            way = mi.Float(0)
            dr.enable_grad(way)
            self.move(mi.Vector3f(axis) * way)
            shares = self.lit(technique)
            if not dr.grad_enabled(shares):
                return np.zeros_like(self.true)
            dr.forward(way)
            found.append(self.weights @ np.array(dr.grad(shares), float))
        return self.at_rest(np.stack(found, axis=1))

    def by_differences_of_map(self, **technique):
        """The same by differences."""
        import mitsuba as mi

        def received(way):
            self.move(mi.Vector3f(way))
            return self.weights @ np.array(self.lit(technique), float)

        return self.at_rest(truth.by_differences(received))

    def at_rest(self, found):
        import mitsuba as mi

        self.move(mi.Vector3f(0))
        return found


def derivatives(report):
    """(scene, light, filter, projection, resolution) → exact derivatives, and those by the filter,
    both (patches, 3); and (scene, light, filter) → those of the filter by differences; and (scene,
    light) → those of rays by differences."""
    focused = [(its, "focused", n) for its in page.FILTERS for n in page.RESOLUTIONS]
    others = [(its, projection, RESOLUTION) for its in page.FILTERS for projection in PROJECTIONS]
    by_dr_jit, by_differences, by_rays = {}, {}, {}
    for name in SCENES:
        for light in LIGHTS:
            case = Case(name, light)
            by_rays[name, light] = case.true, case.by_rays
            for its, projection, resolution in dict.fromkeys(focused + others):
                how = page.FILTERS[its] | {"projection": projection, "resolution": resolution}
                found = case.by_map(**how)
                by_dr_jit[name, light, its, projection, resolution] = case.true, found
            for its, how in page.FILTERS.items():
                by_differences[name, light, its] = case.true, case.by_differences_of_map(**how)
            report(f"{name}, {light}")
    return by_dr_jit, by_differences, by_rays


def main():
    """Measure, and write the page."""
    use_variant()
    page.write(*derivatives(lambda done: print(done, file=sys.stderr)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
