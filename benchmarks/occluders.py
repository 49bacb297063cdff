"""Random occluders in cones of light: one kind for each way in which a single ray may be wrong.

Every lane is another scene: a cone along z, and an occluder in its way that covers a part of it.
"""

import numpy as np
from drjit.llvm import Array3f, Float

from brdfkit.distance_fields import box, plane
from brdfkit.distance_fields import sphere as ball
from brdfkit.distance_fields.shadows import LightCone

LENGTH, START = 6.0, 0.02  # of the cones, and their first radius
RADII = 0.2, 1.0, 2.0  # their last one


class Lanes:
    """n random cones, and random places in them."""

    def __init__(self, n, seed):
        self.n, self.rng = n, np.random.default_rng(seed)
        self.end = self.rng.choice(RADII, n)
        self.tan = (self.end - START) / LENGTH
        axis, zero = vector(np.tile([0.0, 0.0, 1.0], (n, 1))), vector(np.zeros((n, 3)))
        length = Float(np.full(n, LENGTH, np.float32))
        self.cone = LightCone(
            zero, axis, length, 0 * length + START, Float(self.end.astype(np.float32))
        )

    def uniform(self, low, high):
        return self.rng.uniform(low, high, self.n)

    def radius(self, t):
        return START + t * self.tan

    def azimuth(self):
        """Random directions across the axis [rad]."""
        return self.uniform(0, 2 * np.pi)

    def place(self, t, across, azimuth):
        """The point at t, this far from the axis."""
        return vector(np.stack([across * np.cos(azimuth), across * np.sin(azimuth), t], 1))

    def wall(self, t, edge, thickness):
        """A wall across the axis at t, with a straight edge at `edge` radii from the axis."""
        azimuth, size = self.azimuth(), np.stack([0 * t + 6, 0 * t + 18, 2 * thickness], 1)
        centre = self.place(t, 3 + edge * self.radius(t), azimuth)
        return box(vector(size)).rotate(number(azimuth)).translate(centre)

    def sphere(self, t, radius):
        """A sphere whose rim is between 1.2 radii of the cone beyond the axis and 1 before it."""
        across = radius + self.uniform(-1.2, 1) * self.radius(t)
        return ball(number(radius)).translate(self.place(t, across, self.azimuth()))


def half_plane(lanes):
    """A half-space whose plane goes through the apex of the cone; its share is τ(`lanes.edge`)."""
    lanes.edge = lanes.uniform(-1, 1)
    azimuth, beta = lanes.azimuth(), np.arctan(lanes.edge * lanes.tan)
    across = np.cos(azimuth) * np.cos(beta), np.sin(azimuth) * np.cos(beta)
    normal = vector(np.stack([*across, np.sin(beta)], 1))
    return plane(normal).at(0, 0, number(-START / lanes.tan))


def edge(lanes):
    """The long edge of a bar, turned about itself at random."""
    azimuth, turn = lanes.azimuth(), lanes.uniform(0, np.pi / 2)
    half = np.stack([lanes.uniform(0.3, 0.6), np.full(lanes.n, 9.0), lanes.uniform(0.3, 0.6)], 1)
    reach = half[:, 0] * np.cos(turn) + half[:, 2] * np.sin(turn)
    t = lanes.uniform(1, 5)
    centre = lanes.place(t, reach + lanes.uniform(-1, 1) * lanes.radius(t), azimuth)
    turned = box(vector(2 * half)).rotate(number(-turn), (0, 1, 0))
    return turned.rotate(number(azimuth)).translate(centre)


def corner(lanes):
    """The right-angled corner of a plate, pointing to the axis."""
    azimuth, t = lanes.azimuth(), lanes.uniform(1, 5)
    size = np.stack([np.full(lanes.n, 6.0), np.full(lanes.n, 6.0), lanes.uniform(0.2, 0.8)], 1)
    across = 3 * np.sqrt(2) + lanes.uniform(-0.8, 0.8) * lanes.radius(t)
    turned = box(vector(size)).rotate(number(azimuth + np.pi / 4))
    return turned.translate(lanes.place(t, across, azimuth))


def sphere(lanes):
    """A sphere about as large as the cone or larger."""
    return lanes.sphere(lanes.uniform(1, 5), lanes.uniform(0.3, 1))


def small_sphere(lanes):
    """A sphere that lies within the cone, about half as wide."""
    t = lanes.uniform(1, 5)
    across = lanes.uniform(0, 1) * lanes.radius(t)
    centre = lanes.place(t, across, lanes.azimuth())
    return ball(number(lanes.uniform(0.3, 0.8) * lanes.radius(t))).translate(centre)


def two_walls(lanes):
    """The edges of two walls, one behind the other: Fig. 6.19."""
    near, far = lanes.uniform(1, 2.5), lanes.uniform(3, 5)
    thick = np.full(lanes.n, 0.2)
    a, b = (lanes.wall(t, lanes.uniform(-0.7, 0.7), thick) for t in (near, far))
    return a | b


def two_spheres(lanes):
    """Two spheres, anywhere."""
    return sphere(lanes) | sphere(lanes)


def thin_wall(lanes):
    """The edge of a wall that is thinner than the cone: Fig. 6.21."""
    t = lanes.uniform(1, 5)
    return lanes.wall(t, lanes.uniform(-1, 0.8), lanes.uniform(0.02, 0.2) * lanes.radius(t))


def thin_rod(lanes):
    """A rod across the cone, narrower than it."""
    t, azimuth = lanes.uniform(1, 5), lanes.azimuth()
    rho = lanes.radius(t)
    size = [lanes.uniform(0.2, 0.8) * rho, np.full(lanes.n, 18.0), lanes.uniform(0.2, 0.8) * rho]
    centre = lanes.place(t, lanes.uniform(0, 1) * rho, azimuth)
    return box(vector(np.stack(size, 1))).rotate(number(azimuth)).translate(centre)


def number(values):
    """Numbers (n,) as an array of Dr.Jit's."""
    return Float(np.ascontiguousarray(values, np.float32))


def vector(values):
    """Points (n, 3) as a vector of Dr.Jit's."""
    return Array3f(*(number(column) for column in np.transpose(values)))


KINDS = [
    half_plane, edge, corner, sphere, small_sphere, two_walls, two_spheres, thin_wall, thin_rod
]  # fmt: skip
