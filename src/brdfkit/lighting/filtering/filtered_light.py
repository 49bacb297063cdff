"""`FilteredLight`: an environment emitter of Mitsuba's, filtered once and again when it changes."""

import hashlib

import numpy as np

from brdfkit.lighting.filtering.drawn_light import DrawnLight
from brdfkit.lighting.filtering.emitted import radiance_of
from brdfkit.lighting.filtering.filtered_map import FilteredMap, LobeMaps, Mips, picture
from brdfkit.lighting.filtering.irradiance import irradiance

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
