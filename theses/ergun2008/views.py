"""Sets up the scenes, views and lights of all measurements, and shadow maps in them."""

from dataclasses import dataclass

import numpy as np
from brdfkit.theses.ergun2008.compact import make_compact_scene

from brdfkit.images.errors.psnr import psnr
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.maps.light_shadow import LightShadow
from brdfkit.shadows.maps.map_point import AUTOMATIC, Bias
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.scenes import LIGHTS, VIEWS
from brdfkit.shadows.maps.scenes import SCENES as DEEP_SCENES
from brdfkit.theses.drawing import make_figure

SIZE = 256  # pixels along a side of a picture
RESOLUTION = 512  # texels along a side of a map
SCENES = DEEP_SCENES | {
    "compact": make_compact_scene(7.0),
    "compact_from_afar": make_compact_scene(14.0),
}
# Moves of receivers towards the light. Constant ones, a share of the longest ray, were the usual
BIASES = {
    "by the receiver's plane": AUTOMATIC,
    **{f"{share:g}": Bias(constant=share) for share in (5e-4, 1e-3, 2e-3)},
}
MOST = 99.0  # dB: the PSNR of a picture without an error, which would be infinite
PROJECTIONS = {
    "uniform": "uniform",
    "focused": "focused",
    "perspective": "perspective (PSM)",
    "light_space_perspective": "light-space perspective (LiSPSM)",
    "trapezoidal": "trapezoidal (TSM)",
    "plane_optimal": "plane-optimal (POSM)",
}


@dataclass(frozen=True)
class View:
    """A scene of Mitsuba in one light, with the placement of its shadow maps and its visible
    points.
    """

    scene: object
    placement: Placement
    seen: LitView

    @classmethod
    def load(cls, name, view, light):
        """Make the view of one of brdfkit's scenes."""
        return cls.from_dictionary(SCENES[name](view, light, (SIZE, SIZE)))

    @classmethod
    def from_dictionary(cls, description):
        """Make the view of a scene's dictionary."""
        import mitsuba as mi

        scene = mi.load_dict(description, parallel=False)
        (sensor,), (emitter,) = scene.sensors(), scene.emitters()
        width, height = sensor.film().size()
        placement = Placement.from_scene(scene, sensor, emitter)
        return cls(scene, placement, LitView.from_sensor(scene, sensor, emitter, (height, width)))

    def make_shadow(self, **technique):
        """Return the `LightShadow` by a technique."""
        return LightShadow(self.scene, self.placement, **({"resolution": RESOLUTION} | technique))

    def compute_lit(self, shadow):
        """Return the shares (pixels,) of the light that a `LightShadow` lets through."""
        si = self.seen.si
        return np.array(shadow.visibility(si.p, si.n, si.is_valid()))

    def compute_lit_by_bias(self, biases, **technique):
        """Yield the shares (pixels,) of the light by a technique with each of the `biases`.

        The maps are made once, which takes most of the time: biases only move receivers.
        """
        shadow = self.make_shadow(**technique)
        for bias in biases:
            for each in shadow.maps:
                each.bias = bias
            yield self.compute_lit(shadow)

    def measure_error(self, lit):
        """Return the mean error of shares of the light, where surfaces face it."""
        return float(np.abs(lit - self.seen.exact)[self.seen.facing].mean())

    def compute_psnr(self, lit):
        """Return the PSNR [dB] of a picture with shares of the light, against exact shadows."""
        seen = self.seen
        true, found = seen.compute_picture(seen.exact), seen.compute_picture(lit)
        return min(psnr(true, found, seen.facing.reshape(seen.size)), MOST)

    def draw_techniques(self, techniques):
        """Draw the picture with exact shadows, and beside it those by `techniques`, by name."""
        lit = {
            name: self.compute_lit(self.make_shadow(**each)) for name, each in techniques.items()
        }
        lit = {"exact": self.seen.exact} | lit
        drawn, most = make_figure(10, 2.8), self.seen.unshadowed.max()
        for axes, (name, shares) in zip(drawn.subplots(1, len(lit)), lit.items(), strict=True):
            picture = self.seen.compute_picture(0.85 * shares + 0.15) / most
            axes.imshow(picture.clip(0, 1) ** (1 / 2.2))
            axes.set_title(name, size=10)
            axes.set_axis_off()
        return drawn


def load_placements(name, light=1):
    """Return the `Placement` of a scene in each view; the scene is loaded once."""
    import mitsuba as mi

    views = {view: SCENES[name](view, light, (SIZE, SIZE)) for view in VIEWS}
    scene = mi.load_dict(next(iter(views.values())), parallel=False)
    (emitter,) = scene.emitters()
    sensors = {view: mi.load_dict(its["camera"]) for view, its in views.items()}
    return {view: Placement.from_scene(scene, its, emitter) for view, its in sensors.items()}


def measure_all(function, scenes, report):
    """Return for each scene an array (view, light, ...) of the results of `function(view)`."""
    scenes, found, done = list(scenes or SCENES), {}, 0
    total = len(scenes) * len(VIEWS) * len(LIGHTS)
    for name in scenes:
        rows = []
        for view in VIEWS:
            for light in LIGHTS:
                rows.append(function(View.load(name, view, light)))
                report(done := done + 1, total)
        shape = len(VIEWS), len(LIGHTS)
        found[name] = np.array(rows).reshape(*shape, *np.shape(rows[0]))
    return found
