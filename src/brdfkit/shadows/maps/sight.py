"""The line of sight on the map of a light: along it texels are shifted from far to near.

Three projections are one: that of the light, then a perspective across the map,

    x' = x / w,  y' = (y - y_0) / w,  w = 1 + (y - y_0) / n

with y along the line of sight and y_0 where what is seen begins; n before it lies the apex, in
which lines of constant x' meet. They differ by n [Lloyd et al. 2008]: the smaller, the more of the
map the near end gets; as n grows, the map becomes uniform.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.projective.homogeneous import make_rigid, project, project_all, transform
from brdfkit.core.projective.light import Light
from brdfkit.mitsuba_bridge.properties.declarations import plain_number
from brdfkit.shadows.maps.light_camera import fitted, view

APEX = plain_number(
    1.0,
    (1e-3, np.inf),
    "of light_space_ and logarithmic_perspective: n over the formula's; less favours what is near",
)


@dataclass(frozen=True)
class Sight:
    """The line from an eye through the middle of what it sees, on the map of a light.

    matrix : (4, 4), from the world to the light's view, in which the eye is at (0, 0), the line
        is y, and x across.
    light : the `Light`.
    corners : (n, 3), of the body that the map must hold.
    eye, middle : (3,), two points of the line.
    """

    matrix: np.ndarray
    light: Light
    corners: np.ndarray
    eye: np.ndarray
    middle: np.ndarray

    @property
    def ends(self):
        """y_0, where what the map must hold begins along the line, and where it ends."""
        y = project_all(self.matrix, self.corners)[:, 1]
        return y.min(), y.max()

    @property
    def sine(self):
        """sin γ, of the angle between the line and the light in the middle."""
        line = self.middle - self.eye
        light = self.light.direction(*self.middle)
        return np.linalg.norm(np.cross(line, light)) / np.linalg.norm(line)

    @property
    def scale(self):
        """Lengths on the map per unit of length at right angles to the light."""
        across = self.sine * np.linalg.norm(self.middle - self.eye)
        return project(self.matrix, *self.middle)[1] / across

    def warped(self, n):
        """The `Projection` whose apex lies `n` before y_0, in lengths on the map."""
        warp, (near, _) = np.eye(4), self.ends
        warp[1, 3] = -near
        warp[3, 1], warp[3, 3] = 1 / n, 1 - near / n
        return fitted(warp @ self.matrix, self.light, self.corners)


def line_of_sight(placement):
    """The `Sight` of a `Placement`.

    None where the eye looks along the light, or is not before it: what is near the eye has then no
    side of the map of its own.
    """
    light, corners = placement.light, placement.body.corners
    eye, middle = placement.camera.position, placement.seen.middle
    matrix = view(light.point, corners, placement.body.middle)
    x, y, _, w = transform(matrix, *eye)
    if w < 1e-6 * transform(matrix, *middle)[3]:
        return None
    origin = np.array([x / w, y / w, 0])
    line = np.array(project(matrix, *middle)) - origin
    length = np.hypot(line[0], line[1])
    if length < 1e-6 * np.ptp(project_all(matrix, corners), axis=0)[:2].max():
        return None
    a, b = line[:2] / length
    turned = make_rigid([[b, -a, 0], [a, b, 0], [0, 0, 1]], origin)
    return Sight(turned @ matrix, light, corners, eye, middle)
