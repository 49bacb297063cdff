"""`Camera`: a camera that orbits around a point, z up."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.rendering.volumes.camera import to_direction


@dataclass(frozen=True)
class Camera:
    """A camera at an `azimuth` and `elevation` [degrees] around its `target`, (x, y, z).

    `distance` is that to the target, in the volume's unit. `fov` is the field of view along the
    shorter side of the picture [degrees]. `front` is the sign of the y axis on which the camera
    stands at azimuth 0.
    """

    azimuth: float
    elevation: float
    distance: float
    fov: float
    target: tuple[float, float, float]
    front: int = -1

    @property
    def towards(self) -> FloatArray:
        """The unit vector (3,) from the target to the camera."""
        return to_direction(self.azimuth, self.elevation, self.front)

    @property
    def axes(self) -> FloatArray:
        """The unit vectors (3, 3) to the left, up and forwards of the picture, as rows."""
        forwards = -self.towards
        left = np.cross([0, 0, 1], forwards)
        left /= np.linalg.norm(left)
        return np.stack([left, np.cross(forwards, left), forwards])

    @property
    def to_world(self) -> FloatArray:
        """The transform (4, 4) of a sensor of Mitsuba."""
        matrix = np.eye(4)
        matrix[:3, :3] = self.axes.T
        matrix[:3, 3] = np.asarray(self.target) + self.distance * self.towards
        return matrix

    def horizontal_fov(self, aspect: float) -> float:
        """Return the field of view [degrees] along the width; `aspect` is width over height."""
        half = np.tan(np.radians(self.fov / 2)) * max(aspect, 1.0)
        return float(np.degrees(2 * np.arctan(half)))

    def project(self, points: FloatArray, aspect: float) -> FloatArray:
        """Return the places (n, 3) of points (n, 3): x and y in 0 to 1 from the top left, depth."""
        seen = (points - self.to_world[:3, 3]) @ self.axes.T
        half = np.tan(np.radians(self.fov / 2))
        depth = np.maximum(seen[:, 2], 1e-6 * self.distance)
        x = 0.5 - seen[:, 0] / depth / (2 * half * max(aspect, 1.0))
        y = 0.5 - seen[:, 1] / depth / (2 * half * max(1 / aspect, 1.0))
        return np.stack([x, y, seen[:, 2]], axis=1)

    def cast_ray(
        self, x: FloatArray | float, y: FloatArray | float, aspect: float
    ) -> tuple[FloatArray, FloatArray]:
        """Return the origin (3,) and the unit direction (3,) of the ray through a place.

        `x` and `y` are 0 to 1 from the picture's top left. If they are arrays (n,), the directions
        are (n, 3).
        """
        half = np.tan(np.radians(self.fov / 2))
        across = (0.5 - np.asarray(x)) * 2 * half * max(aspect, 1.0)
        up = (0.5 - np.asarray(y)) * 2 * half * max(1 / aspect, 1.0)
        direction = np.stack([across, up, np.ones_like(up)], axis=-1) @ self.axes
        length = np.linalg.norm(direction, axis=-1, keepdims=True)
        return self.to_world[:3, 3], direction / length
