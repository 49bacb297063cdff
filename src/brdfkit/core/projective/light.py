"""A light as one homogeneous point: its position, or the direction from which it shines."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray, JitFloat, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.body import Body
from brdfkit.core.projective.homogeneous import make_axes, normalise

NEAREST = 1e-3  # where a spot's bounding pyramid begins, as a share of its reach
WIDEST_CUTOFF = math.radians(80)  # half the angle of a spot; no pyramid bounds a wider one


@dataclass(frozen=True)
class Light:
    """A point, spot or directional light.

    point : (4,), homogeneous: (x, y, z, 1) for a light at a position; (x, y, z, 0) for one at
        infinity, with the unit vector to it.
    axis, cutoff : the direction of a spot, a unit vector (3,), and half the angle of its cone
        [rad]; None for other lights.
    """

    point: np.ndarray
    axis: np.ndarray | None = None
    cutoff: float | None = None

    @classmethod
    def from_emitter(cls, emitter: MitsubaObject) -> Light:
        """Read one of Mitsuba's emitters `point`, `spot` and `directional`.

        Raises `BrdfkitError` for other emitters, and for a position or direction that is not
        finite.
        """
        import mitsuba as mi

        flags, kinds = emitter.flags(), mi.EmitterFlags
        parameters = mi.traverse(emitter)
        to_world = np.array(emitter.world_transform().matrix, float).reshape(4, 4)
        if mi.has_flag(flags, kinds.DeltaDirection) and mi.has_flag(flags, kinds.Infinite):
            return cls(np.append(-_read_direction(emitter, to_world[:3, 2]), 0))
        if mi.has_flag(flags, kinds.DeltaPosition):
            place = parameters["position"] if "position" in parameters else to_world[:3, 3]
            point = np.append(_require_finite(emitter, np.ravel(place)), 1)
            if "cutoff_angle" in parameters:
                cutoff = np.radians(np.ravel(parameters["cutoff_angle"])[0])
                return cls(point, _read_direction(emitter, to_world[:3, 2]), float(cutoff))
            return cls(point)
        raise BrdfkitError(
            f"{emitter.class_name()} has no single place or direction, which shadow maps and "
            "volumes need; use point, spot or directional lights."
        )

    @property
    def is_directional(self) -> bool:
        """Whether the light is at infinity."""
        return self.point[3] == 0

    @property
    def is_bounded(self) -> bool:
        """Whether the light is a spot so narrow that a pyramid bounds it."""
        return self.cutoff is not None and self.cutoff <= WIDEST_CUTOFF

    def make_bounding_pyramid(self, reach: float) -> Body:
        """Return the square pyramid about a spot's cone between `reach` / 1000 and `reach`."""
        axis, cutoff = self.axis, self.cutoff
        assert axis is not None, "only a spot has a pyramid"
        assert cutoff is not None
        across = make_axes(axis)[:2]
        slope = math.tan(cutoff)
        ends = [
            d * (axis + slope * (i * across[0] + j * across[1]))
            for d in (NEAREST * reach, reach)
            for i in (-1, 1)
            for j in (-1, 1)
        ]
        return Body.from_points(self.point[:3] + np.array(ends))

    def path_length(self, x: JitFloat, y: JitFloat, z: JitFloat) -> JitFloat:
        """Return the distance that light has travelled when it arrives at a point.

        Light from infinity is measured from a plane through the origin, at right angles to it.
        """
        a, b, c = (self.point[i] for i in range(3))
        if self.is_directional:
            return -(a * x + b * y + c * z)
        return ((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) ** 0.5

    def direction(
        self, x: JitFloat, y: JitFloat, z: JitFloat
    ) -> tuple[JitFloat, JitFloat, JitFloat]:
        """Return the direction of the light at a point, as the components of a unit vector."""
        a, b, c = (self.point[i] for i in range(3))
        return (-a, -b, -c) if self.is_directional else normalise(x - a, y - b, z - c)

    def directions_to_light(self, points: ArrayLike) -> FloatArray:
        """Return the unit vectors (n, 3) from points (n, 3) to the light."""
        to_light = self.point[:3] - self.point[3] * np.asarray(points, float)
        return to_light / np.linalg.norm(to_light, axis=1, keepdims=True)


def _read_direction(emitter: MitsubaObject, way: AnyArray) -> FloatArray:
    """Return the unit vector along `way` (3,), a direction of `emitter`, which must be finite."""
    return _require_finite(emitter, way) / np.linalg.norm(way)


def _require_finite(emitter: MitsubaObject, numbers: AnyArray) -> FloatArray:
    """Return the numbers (3,) of a position or direction; raise `BrdfkitError` if not finite."""
    if not np.isfinite(numbers).all():
        raise BrdfkitError(
            f"the place or direction of the light {emitter.id() or emitter.class_name()} is not "
            "finite: check its position, direction or to_world."
        )
    return numbers
