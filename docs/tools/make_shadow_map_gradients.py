# ruff: noqa: I001, for brdfkit comes first: it chooses the LLVM that Dr.Jit loads
"""Makes `docs/shadow_map_gradients.md` and its figure: how wrong gradients of shadow maps are.

    python docs/tools/make_shadow_map_gradients.py    # minutes on two cores

An object casts shadows on nine patches of ground. The derivatives of their light by the object's
position, as Dr.Jit finds them through shadow maps, are compared with exact ones, which
`shadow_map_gradients/truth.py` computes. The text is in `shadow_map_gradients/page.py`.
"""

import sys
from functools import cached_property

import brdfkit  # noqa: F401
import drjit as dr
import numpy as np
from shadow_map_gradients import truth
from shadow_map_gradients import page
from shadow_map_gradients.scenes import LIGHTS, SCENES, load_scene

from brdfkit.core.jit.llvm import use_variant
from brdfkit.shadows.maps.light_shadow import LightShadow
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.techniques import FILES

PROJECTIONS = tuple(FILES["projection"])
SIDE = 160  # number of points along a side of the ground, where maps are evaluated
RESOLUTION = page.RESOLUTION


class Case:
    """A scene under a light whose object can be moved; the object casts shadows on the ground."""

    def __init__(self, name, light):
        import mitsuba as mi

        self.solid, self.scene = SCENES[name][0], load_scene(name, light)
        (sensor,), (emitter,) = self.scene.sensors(), self.scene.emitters()
        self.placement = Placement.from_scene(self.scene, sensor, emitter)
        self.light = self.placement.light
        self.parameters = mi.traverse(self.scene)
        self.corners = mi.Point3f(self.solid.corners.T)
        x, y, area = truth.make_grid(SIDE)
        self.weights = truth.weigh_places(x, y) * area
        self.p = mi.Point3f(mi.Float(x), mi.Float(y), mi.Float(np.zeros(len(x))))

    def move_thing(self, way):
        """Move the object from its original position by `way`, a `mi.Vector3f`."""
        self.parameters["thing.vertex_positions"] = dr.ravel(self.corners + way)
        self.parameters.update()

    @cached_property
    def exact(self):
        """The exact derivatives (patches, 3) of the light, by an integral along shadow borders."""
        return truth.integrate_borders(self.scene, self.light, self.solid)

    @cached_property
    def ray_derivatives(self):
        """The derivatives (patches, 3) of the light by finite differences of dense shadow rays."""
        import mitsuba as mi

        x, y, area = truth.make_grid(truth.SIDE)
        w = truth.weigh_places(x, y) * area

        def compute_light(way):
            """Return the light of the patches with the object moved by `way`."""
            self.move_thing(mi.Vector3f(way))
            return w @ truth.trace_visibility(self.scene, self.light, x, y)

        return self.return_at_rest(truth.differentiate_numerically(compute_light))

    def evaluate_visibility(self, technique):
        """Return the share of the light at the points of the ground, by a shadow map."""
        import mitsuba as mi

        shadow = LightShadow(self.scene, self.placement, **{"resolution": RESOLUTION} | technique)
        return shadow.visibility(self.p, mi.Normal3f(0, 0, 1))

    def differentiate_map(self, **technique):
        """Return the derivatives (patches, 3) of the light by Dr.Jit through a shadow map."""
        import mitsuba as mi

        found = []
        for axis in np.eye(3):
            way = mi.Float(0)
            dr.enable_grad(way)
            self.move_thing(mi.Vector3f(axis) * way)
            shares = self.evaluate_visibility(technique)
            if not dr.grad_enabled(shares):
                return np.zeros_like(self.exact)
            dr.forward(way)
            found.append(self.weights @ np.array(dr.grad(shares), float))
        return self.return_at_rest(np.stack(found, axis=1))

    def differentiate_map_numerically(self, **technique):
        """Return the derivatives (patches, 3) of a shadow map's light by finite differences."""
        import mitsuba as mi

        def compute_light(way):
            """Return the light of the patches with the object moved by `way`."""
            self.move_thing(mi.Vector3f(way))
            return self.weights @ np.array(self.evaluate_visibility(technique), float)

        return self.return_at_rest(truth.differentiate_numerically(compute_light))

    def return_at_rest(self, found):
        """Move the object back to its original position, and return `found`."""
        import mitsuba as mi

        self.move_thing(mi.Vector3f(0))
        return found


def measure_derivatives(report):
    """Measure the derivatives of all scenes, lights and shadow maps, and return three dictionaries.

    Values are pairs (exact derivatives, measured derivatives), both (patches, 3). The first one has
    derivatives by Dr.Jit, by (scene, light, filter, projection, resolution); the second one finite
    differences of maps, by (scene, light, filter); the third one finite differences of rays, by
    (scene, light). `report`: a function that is called with each finished scene.
    """
    focused = [(its, "focused", n) for its in page.FILTERS for n in page.RESOLUTIONS]
    others = [(its, projection, RESOLUTION) for its in page.FILTERS for projection in PROJECTIONS]
    by_dr_jit, by_differences, by_rays = {}, {}, {}
    for name in SCENES:
        for light in LIGHTS:
            case = Case(name, light)
            by_rays[name, light] = case.exact, case.ray_derivatives
            for its, projection, resolution in dict.fromkeys(focused + others):
                how = page.FILTERS[its] | {"projection": projection, "resolution": resolution}
                found = case.differentiate_map(**how)
                by_dr_jit[name, light, its, projection, resolution] = case.exact, found
            for its, how in page.FILTERS.items():
                by_differences[name, light, its] = (
                    case.exact,
                    case.differentiate_map_numerically(**how),
                )
            report(f"{name}, {light}")
    return by_dr_jit, by_differences, by_rays


def main():
    """Make all measurements, and write the page."""
    use_variant()
    page.write_page(*measure_derivatives(lambda done: print(done, file=sys.stderr)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
