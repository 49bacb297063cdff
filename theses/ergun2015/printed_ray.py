"""Defines convex parts and the search of a ray's entry into them as the thesis prints it.

brdfkit's search (`convex_ray.py`) never takes a step backwards, which Algorithm 3 takes for a miss;
with true planes both find the same. brdfkit also stretches each part to be as round as possible,
where the thesis encloses it in a sphere, and lets parts shade nothing within a clearance.
"""

import drjit as dr
import numpy as np

from brdfkit.lighting.visibility.convex_ray import EPSILON, GOING, HIT, LOOKUP_LIMIT, MISSED
from brdfkit.lighting.visibility.hull import Hull
from brdfkit.lighting.visibility.occluders import Occluders


class PrintedOccluders(Occluders):
    """Convex parts in spheres, which rays enter by Algorithm 3, without a clearance."""

    def __init__(self, objects, epsilon):
        round_parts = {
            name: [enclose_in_sphere(h) for h in parts] for name, parts in objects.items()
        }
        super().__init__(round_parts, clearance=0)
        self.search = make_printed_search(epsilon)

    def _find_part_entry(self, ray, part, active):
        """Find where a ray in world coordinates enters a part, by Algorithm 3."""
        import mitsuba as mi

        o, d = self.frames.transform_ray(part, ray, active)
        length = dr.select(active, dr.norm(d), 1)
        t, entered, count = self.search(mi, o, d / length, self.maps, part, active)
        return t / length, entered, count


def enclose_in_sphere(hull):
    """Return a `Hull` whose unit frame is only moved and scaled, about the same centre."""
    linear, offset = hull.to_unit[:, :3], hull.to_unit[:, 3]
    centre, radius = -np.linalg.solve(linear, offset), hull.radius
    # A plane n·(A x + b) = d of the stretched frame, at x = radius y + centre
    normals = hull.planes[:, :3] @ linear
    distances = hull.planes[:, 3] / radius  # A centre + b = 0
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    planes = np.column_stack([normals, distances]) / length
    return Hull(hull.vertices, np.column_stack([np.eye(3), -centre]) / radius, planes)


def make_printed_search(epsilon, ahead=False):
    """Return a function like `find_ray_entry` by Algorithm 3 with an ε, which the thesis omits.

    The unit of length is the radius of the sphere around a part. The search starts where the ray
    enters that sphere, or, if it has to be `ahead` of the origin, where the ray first meets it.
    """

    def find_printed_entry(mi, o, d, planes, part, active=True):
        middle = -dr.dot(o, d)
        nearest = o + middle * d
        half = dr.safe_sqrt(1 + EPSILON - dr.squared_norm(nearest))
        start = dr.select(active & (half > 0), mi.UInt32(GOING), mi.UInt32(MISSED))
        first = dr.select(mi.Bool(ahead) & (middle < half), half, -half)

        def step_to_plane(t0, state, count):
            p0 = nearest + t0 * d
            n, distance = planes.look_up_plane(part, dr.normalize(p0), active)
            cos = dr.dot(n, d)
            t1 = t0 + (distance - dr.dot(n, p0)) / dr.select(cos == 0, 1, cos)
            miss = (cos == 0) | (dr.abs(t1) > half) | (t1 < t0 - epsilon)
            found = dr.select(t1 - t0 < epsilon, mi.UInt32(HIT), mi.UInt32(GOING))
            state = dr.select(miss, mi.UInt32(MISSED), found)
            return dr.select(state == GOING, t1, t0), state, count + 1

        t, state, count = dr.while_loop(
            (first, start, mi.UInt32(0)),
            lambda t0, state, count: (state == GOING) & (count < LOOKUP_LIMIT),
            step_to_plane,
        )
        return t + middle, state != MISSED, count

    return find_printed_entry
