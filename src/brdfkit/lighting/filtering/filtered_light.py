"""`FilteredLight`: an environment emitter of Mitsuba's, filtered once and again when it changes."""

import hashlib

import numpy as np

from brdfkit.lighting.filtering.emitted import radiance_of
from brdfkit.lighting.filtering.filtered_map import FilteredMap, LobeMaps, Mips, picture
from brdfkit.lighting.filtering.paraboloid_levels import discs
from brdfkit.lighting.filtering.sphere_filter import convolve, halve
from brdfkit.mitsuba_bridge.arrays import Rows

SIDE = 64  # texels: irradiance is smooth


def irradiance(picture):
    """Discs (2, SIDE, SIDE, channels) over normals, of radiance (height, 2 height, channels)."""
    while len(picture) > 4 * SIDE:
        picture = halve(picture)
    return discs(convolve(picture, lambda cos: np.maximum(cos, 0) / np.pi, np.pi / 2), SIDE)


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


DIRECTIONS = 256  # that stand for all the light, where it may be hidden
FILTERS = {"lobes": LobeMaps, "mips": Mips}


class FilteredLight:
    """The light of an environment: its means over lobes, and its irradiance over normals."""

    def __init__(self, kind, side):
        self.kind, self.side, self.seen = kind, side, None
        self.directions = None

    def of(self, emitter):
        """Itself, filtered from this `emitter` as it is now."""
        seen = emitter, _digest(emitter)
        if self.seen != seen:
            radiance = radiance_of(emitter)
            seen_around = picture(radiance, self.side)
            self.lobes = self.kind(radiance, seen_around)
            self.irradiances = FilteredMap([irradiance(seen_around)])
            self.seen, self.directions = seen, None
        return self

    def drawn(self, rays):
        """The directions from which the light comes, dealt out to the `rays` of a pixel."""
        if self.directions is None or self.directions.rays != rays:
            self.directions = DrawnLight(self.seen[0], DIRECTIONS, rays)
        return self.directions

    def over_lobe(self, axis, kappa):
        """Mean radiance over a von Mises-Fisher lobe, linear sRGB."""
        return self.lobes.at(axis, kappa)

    def irradiance(self, normal):
        """What a white matte surface of this `normal` shows, linear sRGB."""
        return self.irradiances.bilinear(normal, 0)


def _digest(emitter):
    """A digest of the parameters of an `emitter`, by which a change is noticed."""
    import mitsuba as mi

    parameters = mi.traverse(emitter)
    found = hashlib.blake2b()
    for name in sorted(parameters.keys()):
        value = parameters[name]
        text = np.array(value).tobytes() if hasattr(value, "__len__") else str(value).encode()
        found.update(name.encode() + text)
    return found.digest()
