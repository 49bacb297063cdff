"""Intersection of rays with a convex part by its plane map [Ergun 2015, Algorithm 3].

A plane map stores the part's face in each direction from its centre. Coordinates are transformed so
that the unit sphere encloses the part. The search begins with the point where the ray enters the
sphere, even behind the ray's origin. It looks up the face in the direction of the point, and moves
the point along the ray to the plane of the face. It ends when the point no longer moves.

A texel of the map may have the plane of a neighbouring face. The published algorithm then counts a
step backwards as a miss, and loses hits near the edges of faces. Here a plane that faces the ray
can only move the point forwards. A plane that faces away ends the search, with a miss if the point
is already outside it. With exact planes, both algorithms give the same result.
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, JitMask, JitVector, MitsubaModule
from brdfkit.lighting.visibility.plane_map import PlaneMap

EPSILON = 3e-6  # distances below this count as 0; the unit of length is the radius of a convex part
LOOKUP_LIMIT = 32  # number of look-ups of planes after which the search ends
GOING, HIT, MISSED = 0, 1, 2  # states of the search


def find_ray_entry(
    mi: MitsubaModule,
    o: JitVector,
    d: JitVector,
    planes: PlaneMap,
    part: JitInt,
    active: JitMask = True,
) -> tuple[JitFloat, JitMask, JitInt]:
    """Find where a ray enters a convex part.

    `o` and the unit vector `d` are the ray's origin and direction, in coordinates in which the unit
    sphere encloses the part. `part` is the part's number in the plane map `planes`. Returns the
    distance of the entry from `o`, whether the ray enters, and the number of look-ups. The distance
    is negative if `o` lies inside the part, or beyond it.
    """
    # Distances t are measured from the ray's point nearest to the centre; if measured from a far
    # origin `o`, they would lose digits
    middle = -dr.dot(o, d)
    nearest = o + middle * d
    half = dr.safe_sqrt(1 + EPSILON - dr.squared_norm(nearest))  # t is ±half on the unit sphere
    start = dr.select(active & (half > 0), mi.UInt32(GOING), mi.UInt32(MISSED))

    def step_to_plane(t: JitFloat, state: JitInt, count: JitInt) -> tuple[JitFloat, JitInt, JitInt]:
        p = nearest + t * d
        n, distance = planes.look_up_plane(part, dr.normalize(p), active)
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
        step_to_plane,
    )
    return t + middle, state != MISSED, count
