"""The line of sight on a light's map, along which perspectives enlarge what is near the eye.

Three projections have the same form: the light's own projection, then a perspective across the map,

    x' = x / w,  y' = (y - y_0) / w,  w = 1 + (y - y_0) / n

where y runs along the line of sight, and y_0 is where the visible part begins. The lines of
constant x' meet in the apex, at the distance n before y_0. The projections differ by n [Lloyd et
al. 2008]: the smaller it is, the more of the map is spent near the eye; for a large n the map
becomes uniform.
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
    """The line from the eye through the middle of the visible body, on the map of a light.

    matrix : (4, 4), from the world to the light's view, turned so that the eye is at (0, 0) and the
        line is the y axis.
    light : the light.
    corners : points (n, 3) of the body that the map must enclose.
    eye, middle : two points (3,) of the line: the camera, and the middle of the visible body.
    """

    matrix: AnyArray
    light: Light
    corners: AnyArray
    eye: Any
    middle: Any

    @property
    def y_range(self) -> tuple[float, float]:
        """The y of the near end (y_0) and of the far end of the body that the map must enclose."""
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
        """The length on the map of a unit of length at right angles to the light."""
        across = self.sine_to_light * np.linalg.norm(self.middle - self.eye)
        return float(project(self.matrix, *self.middle)[1] / across)

    def make_warped_projection(self, n: float) -> Projection:
        """Return the light's projection, warped by a perspective with its apex `n` before y_0.

        n : distance of the apex, in lengths on the map.
        """
        warp, (near, _) = np.eye(4), self.y_range
        warp[1, 3] = -near
        warp[3, 1], warp[3, 3] = 1 / n, 1 - near / n
        return fit_projection(warp @ self.matrix, self.light, self.corners)


def find_line_of_sight(placement: Placement) -> LineOfSight | None:
    """Return the line of sight of a placement's camera on its light's map.

    It is None if the eye looks along the light or is behind it, as then no side of the map belongs
    to what is near the eye.
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
