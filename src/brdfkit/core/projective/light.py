"""A light as one homogeneous point: where it is, or the direction from which it shines."""

import math
from dataclasses import dataclass

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.body import Body
from brdfkit.core.projective.homogeneous import make_axes, normalise

NEAREST = 1e-3  # where the pyramid of a spot begins, over where it ends
WIDEST = math.radians(80)  # half the angle of a pyramid; wider ones bound nothing


@dataclass(frozen=True)
class Light:
    """A point, spot or directional light.

    point : (4,), (x, y, z, 1) of a light at a place, (x, y, z, 0) of one far away: the unit vector
        to it.
    axis, cutoff : where a spot shines, a unit vector (3,), and half the angle of its cone [rad];
        None of other lights.
    """

    point: np.ndarray
    axis: np.ndarray | None = None
    cutoff: float | None = None

    @classmethod
    def of_emitter(cls, emitter):
        """Of one of Mitsuba's emitters `point`, `spot` and `directional`.

        Raises `BrdfkitError` for others, and for one at no finite place or of no direction.
        """
        import mitsuba as mi

        flags, kinds = emitter.flags(), mi.EmitterFlags
        parameters = mi.traverse(emitter)
        to_world = np.array(emitter.world_transform().matrix, float).reshape(4, 4)
        if mi.has_flag(flags, kinds.DeltaDirection) and mi.has_flag(flags, kinds.Infinite):
            return cls(np.append(-_unit(emitter, to_world[:3, 2]), 0))
        if mi.has_flag(flags, kinds.DeltaPosition):
            place = parameters["position"] if "position" in parameters else to_world[:3, 3]
            point = np.append(_finite(emitter, np.ravel(place)), 1)
            if "cutoff_angle" in parameters:
                cutoff = np.radians(np.ravel(parameters["cutoff_angle"])[0])
                return cls(point, _unit(emitter, to_world[:3, 2]), float(cutoff))
            return cls(point)
        raise BrdfkitError(
            f"{emitter.class_name()} has no single place or direction, which shadow maps and "
            "volumes need; use point, spot or directional lights."
        )

    @property
    def is_directional(self):
        return self.point[3] == 0

    @property
    def is_bounded(self):
        """Whether a `pyramid` holds all of the light."""
        return self.axis is not None and self.cutoff <= WIDEST

    def pyramid(self, reach):
        """The `Body` of the square pyramid about a spot's cone, from 1/1000 of `reach` to it."""
        across = make_axes(self.axis)[:2]
        slope = math.tan(self.cutoff)
        ends = [
            d * (self.axis + slope * (i * across[0] + j * across[1]))
            for d in (NEAREST * reach, reach)
            for i in (-1, 1)
            for j in (-1, 1)
        ]
        return Body.around(self.point[:3] + np.array(ends))

    def way(self, x, y, z):
        """How far light has come when it is at a point; of a light far away, from the origin."""
        a, b, c = (self.point[i] for i in range(3))
        if self.is_directional:
            return -(a * x + b * y + c * z)
        return ((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) ** 0.5

    def direction(self, x, y, z):
        """Where light goes at a point: the components of a unit vector."""
        a, b, c = (self.point[i] for i in range(3))
        return (-a, -b, -c) if self.is_directional else normalise(x - a, y - b, z - c)

    def towards(self, points):
        """The unit vectors (n, 3) from points (n, 3) to the light."""
        to_light = self.point[:3] - self.point[3] * np.asarray(points, float)
        return to_light / np.linalg.norm(to_light, axis=1, keepdims=True)


def _unit(emitter, way):
    """The unit vector (3,) along a direction of an emitter's."""
    return _finite(emitter, way) / np.linalg.norm(way)


def _finite(emitter, numbers):
    """`numbers` (3,); `BrdfkitError` where they are no place or direction."""
    if not np.isfinite(numbers).all():
        raise BrdfkitError(
            f"the place or direction of the light {emitter.id() or emitter.class_name()} is not "
            "finite: check its position, direction or to_world."
        )
    return numbers
