"""The scenes, views and lights of all measurements, and the shadow maps in them."""

from dataclasses import dataclass

import numpy as np

from brdfkit.images.errors.psnr import psnr
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.maps.light_shadow import LightShadow
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.scenes import LIGHTS, SCENES, VIEWS
from brdfkit.theses.drawing import figure

SIZE = 256  # pixels along a side of a picture
RESOLUTION = 512  # texels along a side of a map
MOST = 99.0  # dB of a picture without an error
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
    """A `scene` of Mitsuba's in one light: its `Placement`, and what is `Seen` of it."""

    scene: object
    placement: Placement
    seen: LitView

    @classmethod
    def of(cls, name, view, light):
        """Of one of the scenes that come along."""
        return cls.by(SCENES[name](view, light, (SIZE, SIZE)))

    @classmethod
    def by(cls, description):
        """Of a scene's dictionary."""
        import mitsuba as mi

        scene = mi.load_dict(description, parallel=False)
        (sensor,), (emitter,) = scene.sensors(), scene.emitters()
        width, height = sensor.film().size()
        placement = Placement.from_scene(scene, sensor, emitter)
        return cls(scene, placement, LitView.from_sensor(scene, sensor, emitter, (height, width)))

    def shadow(self, **technique):
        """The `LightShadow` by a technique."""
        return LightShadow(self.scene, self.placement, **({"resolution": RESOLUTION} | technique))

    def lit(self, shadow):
        """The shares (pixels,) of the light that a `LightShadow` lets through."""
        si = self.seen.si
        return np.array(shadow.visibility(si.p, si.n, si.is_valid()))

    def wrong(self, lit):
        """The mean error of shares of the light, where surfaces face it."""
        return float(np.abs(lit - self.seen.exact)[self.seen.facing].mean())

    def psnr(self, lit):
        """Q3 [dB], of the picture with these shares against the one with exact shadows."""
        seen = self.seen
        true, found = seen.compute_picture(seen.exact), seen.compute_picture(lit)
        return min(psnr(true, found, seen.facing.reshape(seen.size)), MOST)

    def draw(self, techniques):
        """The picture with exact shadows, and beside it those by `techniques`, by their names."""
        lit = {name: self.lit(self.shadow(**each)) for name, each in techniques.items()}
        lit = {"exact": self.seen.exact} | lit
        drawn, most = figure(10, 2.8), self.seen.unshadowed.max()
        for axes, (name, shares) in zip(drawn.subplots(1, len(lit)), lit.items(), strict=True):
            picture = self.seen.compute_picture(0.85 * shares + 0.15) / most
            axes.imshow(picture.clip(0, 1) ** (1 / 2.2))
            axes.set_title(name, size=10)
            axes.set_axis_off()
        return drawn


def measured(function, scenes, report):
    """Scene → what `function(view)` gives, an array (view, light, ...)."""
    scenes, found, done = list(scenes or SCENES), {}, 0
    total = len(scenes) * len(VIEWS) * len(LIGHTS)
    for name in scenes:
        rows = []
        for view in VIEWS:
            for light in LIGHTS:
                rows.append(function(View.of(name, view, light)))
                report(done := done + 1, total)
        shape = len(VIEWS), len(LIGHTS)
        found[name] = np.array(rows).reshape(*shape, *np.shape(rows[0]))
    return found
