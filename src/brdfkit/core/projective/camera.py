"""A perspective camera as matrices, in OpenGL's convention: it looks along -z, x points right."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from brdfkit.core.array_types import ArrayLike, FloatArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.body import Empty
from brdfkit.core.projective.homogeneous import project_points, transform

# From the frame of Mitsuba's cameras, which look along z and have x to the left
FROM_MITSUBA = np.diag([-1.0, 1, -1, 1])
CUBE = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)


@dataclass(frozen=True)
class Camera:
    """A perspective camera.

    view : (4, 4), from the world to the camera's frame, in which it looks along -z.
    slope_x, slope_y : tangents of half the field of view, across and upwards.
    near, far : distances, along the view, of the two planes between which it sees.
    """

    view: np.ndarray
    slope_x: float
    slope_y: float
    near: float
    far: float

    @classmethod
    def from_sensor(cls, sensor: MitsubaObject) -> Camera:
        """Read one of Mitsuba's `perspective` or `thinlens` cameras.

        Raises `BrdfkitError` for another camera, and for one whose principal point is not in the
        middle.
        """
        import mitsuba as mi

        parameters = mi.traverse(sensor)
        if "x_fov" not in parameters:
            raise BrdfkitError(
                f"the camera is a {sensor.class_name()}; shadows by projection need a "
                "perspective one."
            )
        offsets = [f"principal_point_offset_{axis}" for axis in "xy"]  # a thin lens has no offsets
        if any(_read_camera_parameter(parameters, name) for name in offsets if name in parameters):
            raise BrdfkitError("the camera's principal point is off the middle; move it there.")
        slope = math.tan(math.radians(_read_camera_parameter(parameters, "x_fov")) / 2)
        width, height = sensor.film().size()
        to_world = np.array(sensor.world_transform().matrix, float).reshape(4, 4)
        to_world[:3, :3] /= np.linalg.norm(to_world[:3, :3], axis=0)
        return cls(
            view=FROM_MITSUBA @ np.linalg.inv(to_world),
            slope_x=slope,
            slope_y=slope * height / width,
            near=sensor.near_clip(),
            far=sensor.far_clip(),
        )

    @property
    def projection(self) -> FloatArray:
        """The matrix from the camera's frame to the cube [-1, 1]³ [Ergun 2008, 2.1.7]."""
        n, f = self.near, self.far
        return self._make_projection(-(f + n) / (f - n), -2 * f * n / (f - n))

    @property
    def infinite_projection(self) -> FloatArray:
        """The limit of `projection` for a far plane at infinity; points there have the depth 1."""
        return self._make_projection(-1, -2 * self.near)

    def _make_projection(self, along: float, shift: float) -> FloatArray:
        matrix = np.diag([1 / self.slope_x, 1 / self.slope_y, along, 0])
        matrix[2, 3], matrix[3, 2] = shift, -1
        return matrix

    @property
    def matrix(self) -> FloatArray:
        """The matrix (4, 4) from the world to the cube [-1, 1]³."""
        return self.projection @ self.view

    @property
    def position(self) -> FloatArray:
        """The position of the eye (3,)."""
        return -self.view[:3, :3].T @ self.view[:3, 3]

    @property
    def direction(self) -> FloatArray:
        """The viewing direction, a unit vector (3,)."""
        return -self.view[2, :3]

    def make_pixel_rays(self, size: tuple[int, int]) -> FloatArray:
        """Return vectors (height, width, 3) from the eye through the middles of a picture's pixels.

        size : (width, height) [pixels]. The vectors have the length 1 along the view.
        """
        width, height = size
        across = self.slope_x * (2 * (np.arange(width) + 0.5) / width - 1)
        upwards = self.slope_y * (1 - 2 * (np.arange(height) + 0.5) / height)
        x, y = np.meshgrid(across, upwards)
        return np.stack([x, y, np.full_like(x, -1)], axis=-1) @ self.view[:3, :3]

    def find_frustum_corners(self) -> FloatArray:
        """Return the corners (8, 3) of the visible space, the first four on the near plane."""
        return project_points(np.linalg.inv(self.matrix), CUBE)

    def compute_depths(self, points: ArrayLike) -> FloatArray:
        """Return the distances (n,) of points (n, 3) from the eye, along the viewing direction."""
        return -transform(self.view, *np.asarray(points, float).T)[2]

    def replace_near_and_far(self, near: float, far: float) -> Camera:
        """Return the camera with other distances of the near and far planes."""
        return replace(self, near=near, far=far)

    def move_behind(self, points: ArrayLike) -> Camera:
        """Return the camera moved back behind all points (n, 3), and opened until it sees them."""
        view = self.view.copy()
        view[2, 3] -= max(0, self.near - self.compute_depths(points).min())
        x, y, z, _ = transform(view, *np.asarray(points, float).T)
        far = max(-z.min(), -1.001 * z.max())  # beyond the near plane, even if all points lie in it
        return Camera(view, np.abs(x / z).max(), np.abs(y / z).max(), -z.max(), far)

    def fit_near_and_far(self, points: ArrayLike) -> Camera:
        """Return the camera with near and far planes moved inwards to points (n, 3) of a scene.

        Raises `Empty` where all of them are behind its near plane or beyond its far plane.
        """
        depths = self.compute_depths(points)
        near, far = max(self.near, depths.min()), min(self.far, depths.max())
        if far <= near:
            raise Empty("the camera does not see the scene: turn it, or move its planes.")
        return self.replace_near_and_far(near, far)


def _read_camera_parameter(parameters: Mapping[str, Any], name: str) -> float:
    """Return a parameter of a camera as a float."""
    return float(np.ravel(parameters[name])[0])
