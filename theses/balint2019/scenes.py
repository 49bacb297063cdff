"""Defines scenes like those of the thesis, which prints their objects, but not their places."""

from dataclasses import dataclass

import numpy as np
from brdfkit.theses.balint2019.rivals import base, discrete

from brdfkit.distance_fields import Node, box, capped_cylinder, mandelbulb, plane, sphere, union
from brdfkit.distance_fields.shadows.marches import compute_convex_shadow, compute_linear_shadow

MARCHES = {
    "base": base,
    "linear": compute_linear_shadow,
    "discrete": discrete,
    "convex": compute_convex_shadow,
}


Triple = tuple[float, float, float]


@dataclass(frozen=True)
class Scene:
    """A distance field, the centre of a light, and a camera at `eye` that looks at `target`.

    fov : the angle of view [degrees].
    """

    field: Node
    light: Triple
    eye: Triple
    target: Triple
    fov: float = 40.0


def cube() -> Scene:
    """Return scene S0: a cube of edge 2, whose top is 9 from the light."""
    field = box(2).at(0, 0, 1) | plane()
    return Scene(field, (-5.0, -2.0, 9.2), (5.0, -7.0, 6.0), (-0.6, 0.4, 0.4))


def simple() -> Scene:
    """Return scene S1: three spheres, a box and a plane."""
    field = (
        sphere(0.8).at(-1.2, 0.3, 0.8)
        | sphere(0.5).at(0.7, 1.0, 0.5)
        | sphere(0.4).at(0.2, -1.2, 0.4)
        | box((0.8, 0.8, 1.2)).at(1.3, -0.4, 0.6)
        | plane()
    )
    return Scene(field, (2.0, -1.5, 6.0), (3.5, -6.5, 4.5), (-0.2, 0.3, 0.3))


def horizon() -> Scene:
    """Return scene S1, spheres and a box, from a lower camera with the horizon in view."""
    return Scene(simple().field, simple().light, (3.5, -6.5, 1.5), (1.65, -2.4, 0.0))


def complicated() -> Scene:
    """Return scene S2: 25 objects and a plane."""
    rng = np.random.default_rng(2)
    places = np.column_stack([rng.uniform(-3, 3, (25, 2)), rng.uniform(0.2, 1, 25)])
    spheres = [sphere(0.6 * place[2]).at(place) for place in places[:12]]
    boxes = [box(2 * rng.uniform(0.1, 0.5, 3)).at(place) for place in places[12:]]
    field = union((*spheres, *boxes, plane()))
    return Scene(field, (2.0, -1.5, 6.0), (4.0, -8.0, 6.0), (0.0, 0.0, 0.2))


def fractal() -> Scene:
    """Return scene S3: a Mandelbulb."""
    return Scene(mandelbulb(), (3.0, -3.0, 4.0), (1.6, -2.6, 1.2), (0.0, 0.0, 0.0), 45.0)


def near_light() -> Scene:
    """Return scene S4: the 25 objects of S2 and a cylinder of radius 1, whose top is 6 from the
    light.
    """
    cylinder = capped_cylinder((0, 0, 0), (0, 0, 1.5), 1)
    field = complicated().field | cylinder.at(-1.0, -1.0, 0.0)
    return Scene(field, (1.0, -3.0, 6.8), (-5.0, -5.5, 4.5), (-0.5, -0.3, 0.5))


def three_solids() -> Scene:
    """Return scene S5: a sphere, a cube and a cylinder on a plane."""
    field = (
        sphere(0.7).at(-1.5, 0.2, 0.7)
        | box(1.2).rotate(0.5).at(0.1, -0.3, 0.6)
        | capped_cylinder((0, 0, 0), (0, 0, 1.6), 0.4).at(1.4, 0.9, 0.0)
        | plane()
    )
    return Scene(field, (2.5, -2.0, 4.5), (0.5, -6.5, 3.5), (0.0, 0.3, 0.4))
