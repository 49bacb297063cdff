"""`DrawnLight`: the directions from which an environment lights a scene, a few for every point."""

import numpy as np

from brdfkit.lighting.filtering.emitted import radiance_of
from brdfkit.mitsuba_bridge.arrays import Rows


class DrawnLight:
    """At least `count` directions that an `emitter` draws, brighter light more often; always the
    same. They are dealt out to the `rays` of a pixel."""

    def __init__(self, emitter, count, rays):
        import drjit as dr
        import mitsuba as mi
        from scipy.stats import qmc

        self.rays, self.per_ray = rays, -(-count // rays)
        # Any few of Halton's points that follow each other, as those of a ray do, are spread out
        u = qmc.Halton(2, scramble=False).random(1 + rays * self.per_ray)[1:].astype(np.float32)
        origin = dr.zeros(mi.SurfaceInteraction3f, len(u))
        drawn, _ = emitter.sample_direction(origin, mi.Point2f(u.T))
        directions, density = np.array(drawn.d).T, np.array(drawn.pdf)[:, None]
        self.directions = Rows(directions)
        self.powers = Rows(radiance_of(emitter)(directions) / density)

    def at(self, i, ray):
        """Direction `i` of a ray, and the radiance from it over its density, linear sRGB."""
        import mitsuba as mi

        place = ray * self.per_ray + i
        return self.directions.at(place, mi.Vector3f), self.powers.at(place, mi.Color3f)
