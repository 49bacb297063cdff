"""Makes random occluders in cones of light, of nine kinds that are difficult for a single ray.

Scenes are computed side by side, in "lanes" of arrays. Each lane has a cone along z, and an
occluder that covers a part of it.
"""

import numpy as np
from drjit.llvm import Array3f, Float

from brdfkit.distance_fields import box, plane
from brdfkit.distance_fields import sphere as ball
from brdfkit.distance_fields.shadows import LightCone

LENGTH, START = 6.0, 0.02  # length of the cones, and their radius at the start
RADII = 0.2, 1.0, 2.0  # radii of the cones at the end, at the light


class Lanes:
    """The random cones of n scenes side by side, with functions for random places in them.

    Arguments and results are NumPy arrays (n,), one number for each scene; t is a distance along
    the axis of the cone.
    """

    def __init__(self, n, seed):
        self.n, self.rng = n, np.random.default_rng(seed)
        self.end = self.rng.choice(RADII, n)
        self.tan = (self.end - START) / LENGTH
        axis, zero = to_vector(np.tile([0.0, 0.0, 1.0], (n, 1))), to_vector(np.zeros((n, 3)))
        length = Float(np.full(n, LENGTH, np.float32))
        self.cone = LightCone(
            zero, axis, length, 0 * length + START, Float(self.end.astype(np.float32))
        )

    def draw_uniform(self, low, high):
        return self.rng.uniform(low, high, self.n)

    def compute_radius(self, t):
        return START + t * self.tan

    def draw_azimuth(self):
        """Return random azimuths around the axis [rad]."""
        return self.draw_uniform(0, 2 * np.pi)

    def make_point(self, t, across, azimuth):
        """Return the points at `t` along the axis, at distances `across` from it."""
        return to_vector(np.stack([across * np.cos(azimuth), across * np.sin(azimuth), t], 1))

    def make_wall(self, t, edge, thickness):
        """Return walls across the axis at `t`, with an edge at `edge` radii from the axis."""
        azimuth, size = self.draw_azimuth(), np.stack([0 * t + 6, 0 * t + 18, 2 * thickness], 1)
        centre = self.make_point(t, 3 + edge * self.compute_radius(t), azimuth)
        return box(to_vector(size)).rotate(to_float(azimuth)).translate(centre)

    def make_sphere(self, t, radius):
        """Return spheres at `t` whose rim is from 1.2 cone radii beyond the axis to 1 before it."""
        across = radius + self.draw_uniform(-1.2, 1) * self.compute_radius(t)
        return ball(to_float(radius)).translate(self.make_point(t, across, self.draw_azimuth()))


def half_plane(lanes):
    """Return half-spaces whose plane goes through the apex of the cone.

    Seen from the apex, the share of the light is τ(`lanes.edge`), above one half, as the point at
    the start of the cone lies outside.
    """
    lanes.edge = lanes.draw_uniform(0, 1)
    azimuth, beta = lanes.draw_azimuth(), np.arctan(lanes.edge * lanes.tan)
    across = np.cos(azimuth) * np.cos(beta), np.sin(azimuth) * np.cos(beta)
    normal = to_vector(np.stack([*across, np.sin(beta)], 1))
    return plane(normal).at(0, 0, to_float(-START / lanes.tan))


def edge(lanes):
    """Return bars with a long edge in the cone, turned about themselves at random."""
    azimuth, turn = lanes.draw_azimuth(), lanes.draw_uniform(0, np.pi / 2)
    half = np.stack(
        [lanes.draw_uniform(0.3, 0.6), np.full(lanes.n, 9.0), lanes.draw_uniform(0.3, 0.6)], 1
    )
    reach = half[:, 0] * np.cos(turn) + half[:, 2] * np.sin(turn)
    t = lanes.draw_uniform(1, 5)
    centre = lanes.make_point(
        t, reach + lanes.draw_uniform(-1, 1) * lanes.compute_radius(t), azimuth
    )
    turned = box(to_vector(2 * half)).rotate(to_float(-turn), (0, 1, 0))
    return turned.rotate(to_float(azimuth)).translate(centre)


def corner(lanes):
    """Return plates with a right-angled corner that points to the axis."""
    azimuth, t = lanes.draw_azimuth(), lanes.draw_uniform(1, 5)
    size = np.stack([np.full(lanes.n, 6.0), np.full(lanes.n, 6.0), lanes.draw_uniform(0.2, 0.8)], 1)
    across = 3 * np.sqrt(2) + lanes.draw_uniform(-0.8, 0.8) * lanes.compute_radius(t)
    turned = box(to_vector(size)).rotate(to_float(azimuth + np.pi / 4))
    return turned.translate(lanes.make_point(t, across, azimuth))


def sphere(lanes):
    """Return spheres about as large as the cone or larger."""
    return lanes.make_sphere(lanes.draw_uniform(1, 5), lanes.draw_uniform(0.3, 1))


def small_sphere(lanes):
    """Return spheres within the cone that are about half as wide."""
    t = lanes.draw_uniform(1, 5)
    across = lanes.draw_uniform(0, 1) * lanes.compute_radius(t)
    centre = lanes.make_point(t, across, lanes.draw_azimuth())
    return ball(to_float(lanes.draw_uniform(0.3, 0.8) * lanes.compute_radius(t))).translate(centre)


def two_walls(lanes):
    """Return pairs of walls, one behind the other [Bálint et al. 2019, figure 6.19]."""
    near, far = lanes.draw_uniform(1, 2.5), lanes.draw_uniform(3, 5)
    thick = np.full(lanes.n, 0.2)
    a, b = (lanes.make_wall(t, lanes.draw_uniform(-0.7, 0.7), thick) for t in (near, far))
    return a | b


def two_spheres(lanes):
    """Return pairs of spheres at random places."""
    return sphere(lanes) | sphere(lanes)


def thin_wall(lanes):
    """Return walls that are thinner than the cone [Bálint et al. 2019, figure 6.21]."""
    t = lanes.draw_uniform(1, 5)
    return lanes.make_wall(
        t, lanes.draw_uniform(-1, 0.8), lanes.draw_uniform(0.02, 0.2) * lanes.compute_radius(t)
    )


def thin_rod(lanes):
    """Return rods across the cone that are narrower than it."""
    t, azimuth = lanes.draw_uniform(1, 5), lanes.draw_azimuth()
    rho = lanes.compute_radius(t)
    size = [
        lanes.draw_uniform(0.2, 0.8) * rho,
        np.full(lanes.n, 18.0),
        lanes.draw_uniform(0.2, 0.8) * rho,
    ]
    centre = lanes.make_point(t, lanes.draw_uniform(0, 1) * rho, azimuth)
    return box(to_vector(np.stack(size, 1))).rotate(to_float(azimuth)).translate(centre)


def to_float(values):
    """Return numbers (n,) as an array of Dr.Jit."""
    return Float(np.ascontiguousarray(values, np.float32))


def to_vector(values):
    """Return points (n, 3) as a vector of Dr.Jit."""
    return Array3f(*(to_float(column) for column in np.transpose(values)))


KINDS = [
    half_plane, edge, corner, sphere, small_sphere, two_walls, two_spheres, thin_wall, thin_rod
]  # fmt: skip
