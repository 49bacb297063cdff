"""Where a ray enters a convex part, by its plane map [Ergun 2015, Algorithm 3].

All computations are in the unit frame of the part. From the point where the ray enters the unit
sphere, on the near or the far side of its origin, the search moves along the ray to the plane of
the face in that direction, then to the plane in the direction of the new point, and so on until
it no longer moves.

A texel of a rasterised map may hold the plane of a neighbouring face. The printed algorithm then
takes a step back for a miss, and so loses hits near the edges of faces. Here a plane that faces the
ray can only move the entry forward, and a plane by which the ray leaves ends the search: the ray
misses if it is already outside that plane. With the true planes both forms give the same.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, JitMask, JitVector, MitsubaModule
from brdfkit.lighting.visibility.plane_map import PlaneMap

EPSILON = 3e-6  # tolerance of distances, where the part has the radius 1
LOOKUP_LIMIT = 32
GOING, HIT, MISSED = 0, 1, 2  # states of the search


def find_entry(
    mi: MitsubaModule,
    o: JitVector,
    d: JitVector,
    planes: PlaneMap,
    part: JitInt,
    active: JitMask = True,
) -> tuple[JitFloat, JitMask, JitInt]:
    """Return (distance, whether the ray enters the part, number of look-ups in the map).

    `o` and the unit vector `d` are the ray in the unit frame of the `part`, a number in the plane
    map `planes`. The distance from `o` is negative where `o` is inside the part, or beyond it.
    """
    # Distances count from the point nearest to the centre, for accuracy where `o` is far away
    middle = -dr.dot(o, d)
    nearest = o + middle * d
    half = dr.safe_sqrt(1 + EPSILON - dr.squared_norm(nearest))  # of the chord in the sphere
    start = dr.select(active & (half > 0), mi.UInt32(GOING), mi.UInt32(MISSED))

    def look_up(t: JitFloat, state: JitInt, count: JitInt) -> tuple[JitFloat, JitInt, JitInt]:
        p = nearest + t * d
        n, distance = planes.at(part, dr.normalize(p), active)
        cos, outside = dr.dot(n, d), dr.dot(n, p) - distance
        facing = cos < 0
        step = dr.select(facing, outside / dr.select(facing, -cos, 1), 0)
        further = step > EPSILON
        end = dr.select(facing | (outside < EPSILON), mi.UInt32(HIT), mi.UInt32(MISSED))
        onward = dr.select(t + step > half, mi.UInt32(MISSED), mi.UInt32(GOING))
        return t + dr.maximum(step, 0), dr.select(further, onward, end), count + 1

    t, state, count = dr.while_loop(
        (-half, start, mi.UInt32(0)),
        lambda t, state, count: (state == GOING) & (count < LOOKUP_LIMIT),
        look_up,
    )
    return t + middle, state != MISSED, count
