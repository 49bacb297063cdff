"""Fields for the benchmark of shadows: convex solids whose parameters may be arrays, and unions."""

import drjit as dr
import numpy as np
from drjit.llvm import Array3f as P
from drjit.llvm import Float


class Sphere:
    is_convex = True

    def __init__(self, centre, radius):
        self.centre, self.radius = vector(centre), Float(radius)

    def distance(self, p):
        return dr.norm(p - self.centre) - self.radius


class HalfSpace:
    is_convex = True

    def __init__(self, normal, height):
        self.normal, self.height = vector(normal), Float(height)

    def distance(self, p):
        return dr.dot(p, self.normal) - self.height


class Box:
    """A box of half sizes `half` along three `axes`."""

    is_convex = True

    def __init__(self, centre, half, axes=((1, 0, 0), (0, 1, 0), (0, 0, 1))):
        self.centre, self.half = vector(centre), vector(half)
        self.axes = [vector(axis) for axis in axes]

    def distance(self, p):
        q = p - self.centre
        q = dr.abs(P(*(dr.dot(q, axis) for axis in self.axes))) - self.half
        return dr.norm(dr.maximum(q, 0)) + dr.minimum(dr.max(q), 0)


class Union:
    kind, is_sharp, is_convex = "union", True, False

    def __init__(self, *children):
        self.children = children

    def distance(self, p):
        first, *others = (child.distance(p) for child in self.children)
        for other in others:
            first = dr.minimum(first, other)
        return first


def vector(values):
    """(3,) or (n, 3) numbers as a vector of Dr.Jit's."""
    return P(*(Float(np.ascontiguousarray(column, np.float32)) for column in np.transpose(values)))
