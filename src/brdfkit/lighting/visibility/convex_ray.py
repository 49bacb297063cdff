"""Where a ray enters a convex part, by its plane map [Ergun 2015, Algorithm 3].

In the unit frame of the part. From the point where the ray enters the unit sphere, on the near or
the far side of its origin, the ray goes on to the plane of the face in that direction, then to the
plane in the direction of the point found, and so on until it stays where it is.

A texel of a rasterised map may hold the plane of a neighbouring face. The printed algorithm takes a
step back for a miss, and so loses hits near the edges of faces. Here a plane that faces the ray can
only move the entry forward, and a plane that the ray leaves by ends the search: the ray has missed
where it is already outside of it. With the true planes both forms give the same.
"""

import drjit as dr

EPSILON = 3e-6  # of a distance, where the part has the radius 1
MOST_LOOKUPS = 32
GOING, HIT, MISSED = 0, 1, 2


def enter(mi, o, d, planes, part, active=True):
    """(distance, whether the ray enters the part, look-ups in the map).

    o, d : the ray in the unit frame of the part, `d` of length 1.
    planes : its plane map; `part`: the part's number there.

    The distance from `o` is below 0 where `o` is inside the part, or behind it.
    """
    # Distances count from the point nearest to the centre, for accuracy where `o` is far away
    middle = -dr.dot(o, d)
    nearest = o + middle * d
    half = dr.safe_sqrt(1 + EPSILON - dr.squared_norm(nearest))  # of the chord in the sphere
    start = dr.select(active & (half > 0), mi.UInt32(GOING), mi.UInt32(MISSED))

    def look_up(t, state, count):
        p = nearest + t * d
        n, distance = planes.at(part, dr.normalize(p), active)
        cos, outside = dr.dot(n, d), dr.dot(n, p) - distance
        facing = cos < 0
        step = dr.select(facing, outside / dr.select(facing, -cos, 1), 0)
        further = step > EPSILON
        rest = dr.select(facing | (outside < EPSILON), mi.UInt32(HIT), mi.UInt32(MISSED))
        onward = dr.select(t + step > half, mi.UInt32(MISSED), mi.UInt32(GOING))
        return t + dr.maximum(step, 0), dr.select(further, onward, rest), count + 1

    t, state, count = dr.while_loop(
        (-half, start, mi.UInt32(0)),
        lambda t, state, count: (state == GOING) & (count < MOST_LOOKUPS),
        look_up,
    )
    return t + middle, state != MISSED, count
