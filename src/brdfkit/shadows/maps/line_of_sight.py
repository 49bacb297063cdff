"""The line of sight on a light's map, along which a perspective enlarges what is near the eye.

Three projections (trapezoidal, light-space and logarithmic perspective) first project the scene by
the light's own camera to (x, y), and then apply a perspective on the map:

    x' = x / w,  y' = (y - y_0) / w,  w = 1 + (y - y_0) / n

y runs along the line of sight, and y_0 is the y where the visible part begins. The lines of
constant x' meet in the apex, at the distance n before y_0. The three projections choose n
differently [Lloyd et al. 2008]: a smaller n spends more of the map near the eye, and a large n
gives a uniform map.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.projective.homogeneous import (
    make_rigid_matrix,
    project,
    project_points,
    transform,
)
from brdfkit.core.projective.light import Light
from brdfkit.mitsuba_bridge.properties.declarations import declare_float
from brdfkit.shadows.maps.light_camera import fit_projection, view_matrix
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection

APEX = declare_float(
    1.0,
    (1e-3, np.inf),
    "of light_space_ and logarithmic_perspective: n over the formula's; less favours what is near",
)


@dataclass(frozen=True)
class LineOfSight:
    """The line of sight on the map of a light, from the eye to the middle of the visible scene.

    matrix : (4, 4), from the world to the map, turned so that the eye is at (0, 0) and the line of
        sight is the y axis.
    light : the light.
    corners : corners (n, 3) of the part of the scene that the map must enclose.
    eye, middle : two points (3,) of the line in the world: the camera's position, and the middle of
        the visible part of the scene.
    """

    matrix: AnyArray
    light: Light
    corners: AnyArray
    eye: Any
    middle: Any

    @property
    def y_range(self) -> tuple[float, float]:
        """The map coordinates y of the near and the far end of the body that the map encloses."""
        y = project_points(self.matrix, self.corners)[:, 1]
        return y.min(), y.max()

    @property
    def sine_to_light(self) -> float:
        """The sine of the angle γ between the line of sight and the light ray through `middle`."""
        line = self.middle - self.eye
        light = self.light.direction(*self.middle)
        return float(np.linalg.norm(np.cross(line, light)) / np.linalg.norm(line))

    @property
    def map_scale(self) -> float:
        """The ratio of a length on the map to the length in the world, across the light's rays."""
        across = self.sine_to_light * np.linalg.norm(self.middle - self.eye)
        return float(project(self.matrix, *self.middle)[1] / across)

    def make_warped_projection(self, n: float) -> Projection:
        """Return the light's projection, followed by a perspective on the map along the line.

        n : distance of the perspective's apex before the near end of the body, on the map; a small
            distance enlarges what is near the eye.
        """
        warp, (near, _) = np.eye(4), self.y_range
        warp[1, 3] = -near
        warp[3, 1], warp[3, 3] = 1 / n, 1 - near / n
        return fit_projection(warp @ self.matrix, self.light, self.corners)


def find_line_of_sight(placement: Placement) -> LineOfSight | None:
    """Return the line of sight of a placement's camera on its light's map.

    It is None if the eye looks along the light's rays or is behind the light, as then no side of
    the map is nearer to the eye than another.
    """
    light, corners = placement.light, placement.relevant_body.corners
    eye, middle = placement.camera.position, placement.visible_body.centroid
    matrix = view_matrix(light.point, corners, placement.relevant_body.centroid)
    x, y, _, w = transform(matrix, *eye)
    if w < 1e-6 * transform(matrix, *middle)[3]:
        return None
    origin = np.array([x / w, y / w, 0])
    line = np.array(project(matrix, *middle)) - origin
    length = np.hypot(line[0], line[1])
    if length < 1e-6 * np.ptp(project_points(matrix, corners), axis=0)[:2].max():
        return None
    a, b = line[:2] / length
    turned = make_rigid_matrix(np.array([[b, -a, 0], [a, b, 0], [0, 0, 1]]), origin)
    return LineOfSight(turned @ matrix, light, corners, eye, middle)
