"""Random occluders in cones of light: one kind for each way in which a single ray may be wrong.

Every lane is another scene: a cone along z, and an occluder in its way that covers a part of it.
"""

import numpy as np
from drjit.llvm import Float
from shadow_fields import Box, HalfSpace, Sphere, Union, vector

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

    def frame(self):
        """Unit vectors: across the axis in a random direction, across both, along the axis."""
        phi = self.uniform(0, 2 * np.pi)
        cos, sin, zero = np.cos(phi), np.sin(phi), 0 * phi
        return [
            np.stack(v, 1) for v in ((cos, sin, zero), (-sin, cos, zero), (zero, zero, zero + 1))
        ]

    def place(self, t, across, direction):
        """The point at t, this far from the axis in a `direction`."""
        return direction * across[:, None] + np.stack([0 * t, 0 * t, t], 1)

    def wall(self, t, edge, thickness):
        """A wall across the axis at t, with a straight edge at `edge` radii from the axis."""
        e = self.frame()
        centre = self.place(t, 3 + edge * self.radius(t), e[0])
        return Box(centre, np.stack([0 * t + 3, 0 * t + 9, thickness], 1), e)

    def sphere(self, t, radius):
        """A sphere whose rim is between 1.2 radii of the cone beyond the axis and 1 before it."""
        across = radius + self.uniform(-1.2, 1) * self.radius(t)
        return Sphere(self.place(t, across, self.frame()[0]), radius)


def half_plane(lanes):
    """A half-space through the apex of the cone, whose share is known: `true_half_plane`."""
    lanes.edge = lanes.uniform(-1, 1)
    e, beta = lanes.frame(), np.arctan(lanes.edge * lanes.tan)[:, None]
    normal = e[0] * np.cos(beta) + e[2] * np.sin(beta)
    return HalfSpace(normal, (-normal[:, 2] * START / lanes.tan).astype(np.float32))


def edge(lanes):
    """The long edge of a bar, turned about itself at random."""
    e, turn = lanes.frame(), lanes.uniform(0, np.pi / 2)[:, None]
    axes = [
        e[0] * np.cos(turn) + e[2] * np.sin(turn),
        e[1],
        e[2] * np.cos(turn) - e[0] * np.sin(turn),
    ]
    half = np.stack([lanes.uniform(0.3, 0.6), np.full(lanes.n, 9.0), lanes.uniform(0.3, 0.6)], 1)
    reach = half[:, 0] * np.cos(turn[:, 0]) + half[:, 2] * np.sin(turn[:, 0])
    t = lanes.uniform(1, 5)
    return Box(lanes.place(t, reach + lanes.uniform(-1, 1) * lanes.radius(t), e[0]), half, axes)


def corner(lanes):
    """The right-angled corner of a plate, pointing to the axis."""
    e = lanes.frame()
    axes = [(e[0] + e[1]) / np.sqrt(2), (e[0] - e[1]) / np.sqrt(2), e[2]]
    t = lanes.uniform(1, 5)
    half = np.stack([np.full(lanes.n, 3.0), np.full(lanes.n, 3.0), lanes.uniform(0.1, 0.4)], 1)
    across = 3 * np.sqrt(2) + lanes.uniform(-0.8, 0.8) * lanes.radius(t)
    return Box(lanes.place(t, across, e[0]), half, axes)


def sphere(lanes):
    """A sphere about as large as the cone or larger."""
    return lanes.sphere(lanes.uniform(1, 5), lanes.uniform(0.3, 1))


def small_sphere(lanes):
    """A sphere that lies within the cone, about half as wide."""
    t = lanes.uniform(1, 5)
    across = lanes.uniform(0, 1) * lanes.radius(t)
    return Sphere(
        lanes.place(t, across, lanes.frame()[0]), lanes.uniform(0.3, 0.8) * lanes.radius(t)
    )


def two_walls(lanes):
    """The edges of two walls, one behind the other: Fig. 6.19."""
    near, far = lanes.uniform(1, 2.5), lanes.uniform(3, 5)
    thick = np.full(lanes.n, 0.2)
    walls = (lanes.wall(t, lanes.uniform(-0.7, 0.7), thick) for t in (near, far))
    return Union(*walls)


def two_spheres(lanes):
    """Two spheres, anywhere."""
    return Union(*(sphere(lanes) for _ in range(2)))


def thin_wall(lanes):
    """The edge of a wall that is thinner than the cone: Fig. 6.21."""
    t = lanes.uniform(1, 5)
    return lanes.wall(t, lanes.uniform(-1, 0.8), lanes.uniform(0.02, 0.2) * lanes.radius(t))


def thin_rod(lanes):
    """A rod across the cone, narrower than it."""
    t, e = lanes.uniform(1, 5), lanes.frame()
    rho = lanes.radius(t)
    half = [lanes.uniform(0.1, 0.4) * rho, np.full(lanes.n, 9.0), lanes.uniform(0.1, 0.4) * rho]
    return Box(lanes.place(t, lanes.uniform(0, 1) * rho, e[0]), np.stack(half, 1), e)


KINDS = [
    half_plane, edge, corner, sphere, small_sphere, two_walls, two_spheres, thin_wall, thin_rod
]  # fmt: skip
