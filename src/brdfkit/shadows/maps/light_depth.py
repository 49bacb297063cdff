"""Depth that grows evenly along every ray of light, whatever a projection does to it.

Moments of it bound the light more closely. But a plane is bent on a warped map of it, so that wide
filters, which follow the receiver's plane, see the plane shadow itself where texels are large;
depths by the projection's own matrix keep planes planes, and are the default.
"""

from dataclasses import dataclass, replace
from typing import Any


@dataclass(frozen=True)
class LightDepth:
    """How far the light has come, from -1 at `start` to 1 a `length` later [unit of length]."""

    start: Any
    length: Any

    @classmethod
    def through(cls, placement):
        """From where the light enters a `Placement`'s scene, a point light from itself, to its
        reach."""
        light, reach = placement.light, placement.reach
        if not light.is_directional:
            return cls(0.0, reach)
        return cls(light.path_length(*(placement.low + placement.high) / 2) - reach / 2, reach)

    def opaque(self):
        """The same for Dr.Jit."""
        import drjit as dr
        import mitsuba as mi

        return replace(
            self, start=dr.opaque(mi.Float, self.start), length=dr.opaque(mi.Float, self.length)
        )

    def of(self, way):
        """The depth of what the light reaches after a `way`."""
        return 2 * (way - self.start) / self.length - 1

    def way(self, depth):
        """The way to a depth."""
        return self.start + (depth + 1) / 2 * self.length
