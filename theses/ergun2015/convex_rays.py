"""Counts the planes that a ray looks up in a convex part, and its errors with rasterised planes."""

import numpy as np

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.lighting.visibility.convex_ray import find_ray_entry
from brdfkit.lighting.visibility.hull import Hull, make_hull
from brdfkit.lighting.visibility.plane_map import RasterisedPlaneMap
from brdfkit.mitsuba_bridge.arrays import Integers, Rows
from brdfkit.theses.claims import UNSTATED, Claim, to_verdict
from brdfkit.theses.page import Section, Table
from brdfkit.theses.replacing import replace_part

SECONDS = 2
RAYS = 20_000
CORNERS = 7, 12, 27, 40
SIDES = 16, 32, 64, 128
TEXT = f"""{RAYS:,} rays from twice the radius of the sphere around a random hull to points inside
that sphere. The truth clips each ray at all of the hull's planes. The last columns: rays whose
answer is wrong where the planes come from a map of so many texels by side."""


class ExactPlaneMap:
    """A `PlaneMap` with the true face of each part of `hulls`, found among all of its faces.

    It replaces the map of texels to show whether the search itself is exact.
    """

    def __init__(self, hulls):
        self.planes = Rows(np.concatenate([hull.planes for hull in hulls]))
        self.first = Integers(np.cumsum([0] + [len(hull.planes) for hull in hulls]))

    def look_up_plane(self, part, direction, active=True):
        """Return the normal and the distance of a part's plane in a unit `direction`."""
        import drjit as dr
        import mitsuba as mi

        def compare(i, largest, plane):
            candidate = self.planes.at(i, mi.Vector4f, active)
            value = dr.dot(normal(candidate), direction) / candidate.w
            nearer = value > largest
            return i + 1, dr.select(nearer, value, largest), dr.select(nearer, candidate, plane)

        def normal(plane):
            return mi.Vector3f(plane.x, plane.y, plane.z)

        end = self.first.at(part + 1, active)
        _, _, plane = dr.while_loop(
            (self.first.at(part, active), mi.Float(0), mi.Vector4f(0, 0, 1, 1)),
            lambda i, largest, plane: active & (i < end),
            compare,
        )
        return normal(plane), plane.w


@in_turn
def check_claims(sources, report):
    """Check the claims on rays that meet convex parts; return their section of the page."""
    use_variant()
    rows, lookups, wrong, coarse = [], [], [], []
    for done, corners in enumerate(CORNERS):
        found = make_random_hull(corners)
        o, d = make_random_rays()
        truth = clip_rays(found, o, d) < np.inf
        hit, count = find_hits(found, ExactPlaneMap([found]), o, d)
        lookups.append(count[count > 0].mean())
        wrong.append(int((hit != truth).sum()))
        maps = (RasterisedPlaneMap([found], side) for side in SIDES)
        coarse.append([(find_hits(found, planes, o, d)[0] != truth).mean() for planes in maps])
        share = (f"{100 * w:.2f} %" for w in coarse[-1])
        row = len(found.planes), f"{lookups[-1]:.2f}", count.max(), wrong[-1], *share
        rows.append(tuple(map(str, row)))
        report(done + 1, len(CORNERS))
    heads = "faces", "look-ups, mean", "most", "wrong", *(f"{side} texels" for side in SIDES)
    claims = [claim_lookup(lookups), claim_exact(wrong), claim_raster(np.array(coarse))]
    return Section("Rays and convex parts", TEXT, claims, [Table(heads, rows)])


def claim_lookup(lookups):
    """Claim that a ray takes as many look-ups as in the thesis."""
    return Claim(
        "A convex part and a ray take 2.1 look-ups on average.",
        "7.1",
        "2.1",
        f"{min(lookups):.2f} to {max(lookups):.2f}",
        to_verdict(min(lookups) >= 2.0 and max(lookups) <= 2.5),
        "Of rays that enter the sphere, by the number of faces; confirmed from 2.0 to 2.5, because "
        "the thesis's parts are not known.",
    )


def claim_exact(wrong):
    """Claim that the search ends at the exact answer."""
    return Claim(
        "They lead to the exact answer.",
        "7.1",
        "exact",
        f"{sum(wrong)} of {RAYS * len(wrong):,} rays wrong",
        to_verdict(sum(wrong) == 0),
        "With the true planes.",
    )


def claim_raster(coarse):
    """Claim that planes may come from a map of texels, by how often it errs."""
    ours = ", ".join(
        f"{100 * mean:.2f} % at {side}"
        for side, mean in zip(SIDES, coarse.mean(axis=0), strict=True)
    )
    return Claim(
        "Planes may come from a map of texels.",
        "7.1",
        "no figure",
        f"wrong in the mean: {ours}",
        UNSTATED,
        "Ours takes no step back where a texel holds a neighbouring face; the printed algorithm "
        "does, takes that for a miss, and errs more often than twice as much.",
    )


def find_hits(found, planes, o, d):
    """Return whether rays enter a hull by the thesis's Algorithm 3, and its look-ups.

    Origins `o` and directions `d` (n, 3) are in the hull's unit frame.
    """
    import mitsuba as mi

    o, d = mi.Vector3f(o.T.astype(np.float32)), mi.Vector3f(d.T.astype(np.float32))
    with replace_part(planes, "look_up_plane"):
        _, hit, lookups = find_ray_entry(mi, o, d, planes, mi.UInt32(0))
    return np.array(hit), np.array(lookups)


def clip_rays(found, o, d):
    """Return the distances at which rays enter a hull, by its planes; inf for rays that miss."""
    cos = d @ found.planes[:, :3].T
    t = (found.planes[:, 3] - o @ found.planes[:, :3].T) / cos
    near = np.where(cos < 0, t, -np.inf).max(axis=1)
    return np.where(near <= np.where(cos > 0, t, np.inf).min(axis=1), near, np.inf)


def make_random_hull(corners):
    """Return the convex hull of random points in its unit frame."""
    rng = np.random.default_rng(corners)
    found = make_hull(draw_unit_vectors(rng, corners) * rng.uniform(0.7, 1, (corners, 1)))
    vertices = found.vertices @ found.to_unit[:, :3].T + found.to_unit[:, 3]
    return Hull(vertices, np.eye(3, 4), found.planes)


def make_random_rays():
    """Return origins and unit directions (RAYS, 3) of rays to points of the unit ball."""
    rng = np.random.default_rng(1)
    o = 2 * draw_unit_vectors(rng, RAYS)
    d = draw_unit_vectors(rng, RAYS) * rng.random((RAYS, 1)) ** (1 / 3) - o
    return o, d / np.linalg.norm(d, axis=1, keepdims=True)


def draw_unit_vectors(rng, n):
    """Draw random unit vectors (n, 3)."""
    w = rng.normal(size=(n, 3))
    return w / np.linalg.norm(w, axis=1, keepdims=True)
