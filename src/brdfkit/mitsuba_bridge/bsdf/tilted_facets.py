"""The geometry of facets that a normal map tilts: bent normals, and light that leaves below.

Directions are unit vectors in the frame of the surface, whose normal is z. A facet has the normal
n, which is tilted by θ towards h; d = h cos θ - z sin θ points down its slope, l = z × h across.
Light that it sends below the surface goes to directions w in the wedge between the two horizons:

    w · l = b,   w · d = τ √(1 - b²),   τ = cos θ + (1 - cos θ) t,   0 ≤ t ≤ 1.

This light is spread over all directions w' above the surface, those at t = 0 staying in place:

    w' · l = b,   w' · h = (1 - 2 t) √(1 - b²).

Then (w · n) dω = δ (w' · z) dω' with δ = (1 - cos θ) / 2. So no energy is lost, and a matt facet of
the albedo ρ, which sends ρ δ below the surface, gets a matt term of the albedo ρ δ.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitMask, JitVector
from brdfkit.core.geometry.vectors import dot, normalise

# The cosine between a normal and the viewer is at least this share of that of the surface's normal
LEAST_FACING = 0.5
STEEPEST = 0.01  # smallest z of the vector in a normal map, so that the facet's front is above
TINY = 1e-7  # facets with a smaller δ are flat; it also keeps divisors and roots above 0


def decode_normal(colour: JitVector) -> JitVector:
    """Return the unit normal of a normal map's colour: each channel is (component + 1) / 2."""
    x, y, z = (2 * channel - 1 for channel in (colour.x, colour.y, colour.z))
    return normalise(type(colour)(x, y, dr.maximum(z, STEEPEST)))


def bend_normal(n: JitVector, wi: JitVector) -> JitVector:
    """Bend the normal n towards z, as little as is needed for it to face the viewer at `wi`.

    The result is (n + s z) / |n + s z| with the smallest s ≥ 0 for which its cosine to `wi` is at
    least k |wi.z|, with k = `LEAST_FACING`. Below the surface, the same holds for -`wi`.

    [Keller et al. 2017] bend normals until the mirror direction is above the surface.
    """
    k2 = LEAST_FACING * LEAST_FACING
    u = dr.maximum(dr.abs(wi.z), 1e-6)
    c = dr.select(wi.z < 0, -1, 1) * dot(n, wi)
    bends = c < LEAST_FACING * u
    # s solves (c + s u)² = k² u² (1 + 2 s n.z + s²); select keeps the root's derivative finite
    root = dr.square(c - u * n.z) + (1 - k2) * dr.square(u) * (1 - dr.square(n.z))
    root = LEAST_FACING * dr.sqrt(dr.select(bends, root, 1))
    s = dr.select(bends, (root - c + k2 * u * n.z) / (u * (1 - k2)), 0)
    return normalise(type(n)(n.x, n.y, n.z + s))


def find_slope(n: JitVector) -> tuple[JitVector, JitVector, JitVector]:
    """Return the horizontal axes h and l of a facet with the normal n, and the axis d."""
    length = dr.sqrt(dr.select(is_flat(n), 1, dr.square(n.x) + dr.square(n.y)))
    x, y = n.x / length, n.y / length
    return type(n)(x, y, 0), type(n)(-y, x, 0), type(n)(x * n.z, y * n.z, -length)


def is_flat(n: JitVector) -> JitMask:
    """Return whether a normal is that of the surface, so that no light goes below it."""
    return 1 - n.z < 2 * TINY


def raise_direction(n: JitVector, w: JitVector) -> JitVector:
    """Return the direction w' to which light is raised that a facet sends to w below the surface.

    For a w above the surface, behind a facet that transmits light, w' is below.
    """
    side = dr.select(w.z < 0, 1, -1)
    h, l, d = find_slope(n)
    b = side * dot(w, l)
    root = dr.sqrt(dr.maximum(1 - dr.square(b), TINY))
    t = (side * dot(w, d) / root - n.z) / dr.maximum(1 - n.z, TINY)
    along = root * dr.clip(1 - 2 * t, -1, 1)
    z = dr.sqrt(dr.maximum(1 - dr.square(along) - dr.square(b), TINY))
    up = type(w)(0, 0, 1)
    return (h * along + l * b + up * z) * side


def find_raised(n: JitVector, wo: JitVector) -> tuple[JitVector, JitFloat]:
    """Return the direction w of the wedge from which light is raised to `wo`, and dω / dω'.

    It is the inverse of `raise_direction` and has derivatives by n. For a flat facet, dω is 0.
    """
    side = dr.select(wo.z < 0, -1, 1)
    h, l, d = find_slope(n)
    b = side * dot(wo, l)
    root = dr.sqrt(dr.maximum(1 - dr.square(b), TINY))
    t = dr.clip((1 - side * dot(wo, h) / root) / 2, TINY, 1 - TINY)
    tau = n.z + (1 - n.z) * t
    across = root * dr.sqrt(dr.maximum(1 - dr.square(tau), TINY))
    w = (d * (root * tau) + l * b + n * across) * side
    # δ (w' · z) / (w · n), with both cosines by t
    ratio = dr.sqrt(dr.maximum(1 - n.z, TINY) * t / (1 + tau))
    return normalise(w), dr.select(is_flat(n), 0, ratio)


def compute_shadowing(n: JitVector, wo: JitVector) -> JitFloat:
    """Return the share of the light at `wo` that is not shadowed [Estevez et al. 2019].

    2 / (1 + √(1 + α² tan² θ_o)) with α² = min(tan² θ / 8, 1).
    """
    n_z2, z2 = (dr.maximum(dr.square(z), 1e-12) for z in (n.z, wo.z))
    alpha2 = dr.minimum((1 - n_z2) / (8 * n_z2), 1)
    return 2 / (1 + dr.sqrt(1 + alpha2 * (1 - z2) / z2))
