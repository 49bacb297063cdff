"""Light in a medium of constant extinction σ: exact shares, and collisions by inversion.

Over the length L the share T = exp(-σL) of light passes, and c = 1 - T collides. The distance t of
a collision has the density σ exp(-σt) / c, and its distribution function is inverted:

    t = -ln(1 - u c) / σ,    u uniform in [0, 1)
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, MitsubaObject

# Below this optical depth, c and t come from series: the differences above would be rounded
THIN = 1e-2


def is_constant(extinction: MitsubaObject) -> bool:
    """Return whether an extinction, a Mitsuba volume, has one value everywhere in its box."""
    return bool(extinction.class_name() == "ConstVolume")


def split_light(
    sigma: JitFloat, length: JitFloat, u: JitFloat
) -> tuple[JitFloat, JitFloat, JitFloat]:
    """Return the share of light that passes a `length`, the share that collides, and a distance.

    The distance is that of a collision, for the uniform random number `u`; it is infinite where
    nothing collides.
    """
    depth = sigma * length
    passed = dr.exp(-depth)
    thin = depth < THIN
    collided = dr.select(thin, depth * (1 - depth / 2 * (1 - depth / 3)), 1 - passed)
    # For small depths, t / L = u (1 - (1 - u) σL / 2) to first order
    short = u * length * (1 - (1 - u) * depth / 2)
    distance = dr.select(thin, short, -dr.log(1 - u * collided) / sigma)
    return passed, collided, dr.select(collided > 0, distance, dr.inf)
