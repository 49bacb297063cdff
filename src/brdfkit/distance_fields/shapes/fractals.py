"""The Mandelbulb, by a distance estimate like that of [Quílez 2009]."""

from dataclasses import dataclass
from typing import Any

from brdfkit.distance_fields.boxes import around, plain
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

ESCAPED = 16.0  # |w| from which w is far: a larger one changes the estimate by less than 1e-8
LARGEST = 0.5  # of the estimate, which is one close to the surface only
MEASURED = 3.0  # how many times the estimate may be the distance


@dataclass(frozen=True, eq=False, repr=False)
class mandelbulb(Node):
    """The points c of which the steps w ↦ wⁿ + c, from w = c on, do not run away.

    wⁿ has the n-fold angles of w and the n-th power of its length. The estimate is
    ½ ‖w‖ log ‖w‖ / s, where a step makes n ‖w‖ⁿ⁻¹ s + 1 of s, and more towards the poles, where it
    stretches azimuths by sin(nθ) / sin(θ) instead of 1. No bound of it is proven: `lipschitz` is
    what held at 10⁵ points, against their distances to a dense set of surface points, where 2.8 was
    needed. Between neighbours f itself may jump.

    Parameters
    ----------
    n : number ≥ 2, default 8
        The power.
    steps : integer ≥ 1, default 6
        How often the step is made; each shows details about n times smaller.
    """

    n: Any = number(8.0, least=2)
    steps: int = count(6, least=1)

    @property
    def lipschitz(self):
        return MEASURED

    def distance(self, p):
        w, size, slope = Point(p.x, p.y, p.z), length(p.x, p.y, p.z), 1.0
        outer = size - self.radius()
        for _ in range(self.steps):
            inside = size < ESCAPED
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
        return maximum(minimum(estimate, LARGEST), outer)

    def radius(self):
        """Of the ball that holds all: from ‖c‖ = 2^(1/(n-1)) on, every step leads further away."""
        return 2.0 ** (1.0 / (self.n - 1.0))

    def bounds(self, level=0.0):
        return around((0.0, 0.0, 0.0), reach=float(plain(self.radius())) + level)
