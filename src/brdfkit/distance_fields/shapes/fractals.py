"""The Mandelbulb fractal, by a distance estimate similar to [Quílez 2009]."""

from dataclasses import dataclass
from typing import Any

from brdfkit.core.array_types import JitFloat, JitVector
from brdfkit.distance_fields.boxes import Box, bound_points, to_floats
from brdfkit.distance_fields.functions import (
    Point,
    absolute,
    acos,
    atan2,
    clip,
    cos,
    length,
    log,
    maximum,
    minimum,
    power,
    select,
    sin,
)
from brdfkit.distance_fields.node import Node
from brdfkit.distance_fields.parameters import count, number

# The distance from the origin beyond which the iteration of a point ends; a larger one would change
# the estimate by less than 1e-8
ESCAPE_RADIUS = 16.0
LARGEST_ESTIMATE = 0.5  # the limit of estimates: far from the surface the formula gives too much
MEASURED_SLOPE = 3.0  # in tests, the estimate was at most this multiple of the distance


@dataclass(frozen=True, eq=False, repr=False)
class mandelbulb(Node):
    """The points c for which the iteration w ↦ wⁿ + c, which starts with w = c, does not diverge.

    The power wⁿ has n times the angles of w and the n-th power of its length. The estimate of the
    distance is ½ ‖w‖ log ‖w‖ / s, where s, at first 1, bounds how fast w changes with c. Each
    iteration replaces s by n ‖w‖ⁿ⁻¹ s + 1, or by more towards the poles, where azimuths are
    stretched by sin(nθ) / sin(θ), at the polar angle θ.

    No bound on the estimate is proven. `lipschitz` is 3: in a test at 10⁵ points the estimate was
    at most 2.8 times the distance to a dense set of surface points. The estimate itself may jump.

    Parameters
    ----------
    n : number ≥ 2, default 8
        The power.
    steps : integer ≥ 1, default 6
        The number of iterations; each one adds details about n times smaller.
    """

    n: Any = number(8.0, least=2)
    steps: int = count(6, least=1)
    lipschitz = MEASURED_SLOPE

    def distance(self, p: JitVector) -> JitFloat:
        w, size, slope = Point(p.x, p.y, p.z), length(p.x, p.y, p.z), 1.0
        outer = size - self.bounding_radius()
        for _ in range(self.steps):
            inside = size < ESCAPE_RADIUS
            size = maximum(size, 1e-9)
            polar = self.n * acos(clip(w.z / size, -1.0, 1.0))
            azimuth = self.n * atan2(w.y, w.x)
            far, across = power(size, self.n), sin(polar)
            sine = maximum(length(w.x, w.y) / size, 1e-9)
            stretch = maximum(1.0, minimum(absolute(across) / sine, self.n))
            steepest = self.n * power(size, self.n - 1.0) * stretch
            slope = select(inside, steepest * slope + 1.0, slope)
            w = Point(
                select(inside, far * across * cos(azimuth) + p.x, w.x),
                select(inside, far * across * sin(azimuth) + p.y, w.y),
                select(inside, far * cos(polar) + p.z, w.z),
            )
            size = select(inside, length(w.x, w.y, w.z), size)
        estimate = 0.5 * log(maximum(size, 1e-9)) * size / slope
        return maximum(minimum(estimate, LARGEST_ESTIMATE), outer)

    def bounding_radius(self) -> JitFloat:
        """Return the radius of a ball that contains the fractal.

        From any point c with ‖c‖ ≥ 2^(1/(n-1)), every iteration leads further away.
        """
        return 2.0 ** (1.0 / (self.n - 1.0))

    def bounds(self, level: float = 0.0) -> Box:
        radius = float(to_floats(self.bounding_radius()))
        return bound_points((0.0, 0.0, 0.0), margin=radius + level)
