"""A ground seen from above: the cones of light at a grid of its points."""

import drjit as dr
from drjit.llvm import Array3f, Float, UInt

from brdfkit.distance_fields.shadows import light_cone


def ground(size, half, light, radius, ball):
    """The `LightCone`s (size², in rows) of a square about the origin of the plane z = 0.

    half : half of the square's edge; light : the centre of a light of this `radius`; ball : the
    radius of the empty balls about the points, which they touch the plane with.
    """
    i = dr.arange(UInt, size * size)
    x = (Float(i % size) + 0.5) / size * 2 * half - half
    y = (Float(i // size) + 0.5) / size * 2 * half - half
    cones = light_cone(Array3f(x, y, 1.05 * ball), Array3f(light), radius, ball)
    dr.eval(cones)
    return cones
