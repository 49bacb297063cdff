"""Counts the planes that a ray looks up in a convex part, and its errors with rasterised planes."""

import numpy as np
from brdfkit.theses.ergun2015.printed_ray import make_printed_search

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
EPSILONS = 1e-5, 0.001, 0.01, 0.03
SEARCHES = {f"printed, ε = {e:g}": make_printed_search(e) for e in EPSILONS}
PRINTED, OURS = next(iter(SEARCHES)), "brdfkit"
SEARCHES[OURS] = find_ray_entry
TEXT = f"""{RAYS:,} rays from twice the radius of the sphere around a random hull to points inside
that sphere. The truth clips each ray at all of the hull's planes. *Printed*: Algorithm 3, which
takes a step backwards by more than ε for a miss; the thesis does not tell ε, here over the sphere's
radius. brdfkit's search takes no step backwards. The last columns: rays whose answer is wrong where
the planes come from a map of so many texels by side, in the mean over hulls."""


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
    hulls, (o, d) = [make_random_hull(corners) for corners in CORNERS], make_random_rays()
    truths = [clip_rays(hull, o, d) < np.inf for hull in hulls]
    found, rows = {}, []
    for label, search in SEARCHES.items():
        exact = [find_hits(hull, ExactPlaneMap([hull]), o, d, search) for hull in hulls]
        wrong = [int((hit != truth).sum()) for (hit, _), truth in zip(exact, truths, strict=True)]
        lookups = [count[count > 0].mean() for _, count in exact]
        coarse = [
            [
                np.mean(find_hits(hull, RasterisedPlaneMap([hull], side), o, d, search)[0] != truth)
                for hull, truth in zip(hulls, truths, strict=True)
            ]
            for side in SIDES
        ]
        shares = 100 * np.mean(coarse, axis=1)
        found[label] = lookups, wrong, shares
        most = max(count.max() for _, count in exact)
        numbers = f"{min(lookups):.2f} to {max(lookups):.2f}", str(most), f"{sum(wrong):,}"
        rows.append((label, *numbers, *(f"{share:.2f} %" for share in shares)))
        report(len(rows), len(SEARCHES))
    faces = " ".join(str(len(hull.planes)) for hull in hulls)
    heads = "search", "look-ups", "most", "wrong", *(f"{side} texels" for side in SIDES)
    table = Table(heads, rows, f"Hulls of {faces} faces; look-ups and wrong rays by true planes.")
    claims = [claim_lookup(found), claim_exact(found), claim_raster(found)]
    return Section("Rays and convex parts", TEXT, claims, [table])


def claim_lookup(found):
    """Claim that a ray takes as many look-ups as in the thesis.

    `found` maps each search to its mean look-ups by hull, wrong rays by hull, and errors by texels.
    """
    each = [mean for label in (PRINTED, OURS) for mean in found[label][0]]
    return Claim(
        "A convex part and a ray take 2.1 look-ups on average.",
        "7.1",
        "2.1",
        f"{min(each):.2f} to {max(each):.2f}, as printed and by brdfkit",
        to_verdict(min(each) >= 2.0 and max(each) <= 2.5),
        "Of rays that enter the sphere, by the number of faces; confirmed from 2.0 to 2.5, because "
        "the thesis's parts are not known.",
    )


def claim_exact(found):
    """Claim that the search ends at the exact answer."""
    wrong = [sum(found[label][1]) for label in (PRINTED, OURS)]
    return Claim(
        "They lead to the exact answer.",
        "7.1",
        "exact",
        f"{wrong[0]:,} of {RAYS * len(CORNERS):,} rays wrong as {PRINTED}, {wrong[1]:,} by brdfkit",
        to_verdict(max(wrong) == 0),
        "With the true planes. A larger ε takes near misses for hits.",
    )


def claim_raster(found):
    """Claim that planes may come from a map of texels, by how often each search errs."""
    words = (
        f"{label} " + ", ".join(f"{share:.2f}" for share in found[label][2])
        for label in (PRINTED, OURS)
    )
    sides = ", ".join(map(str, SIDES))
    return Claim(
        "Planes may come from a map of texels.",
        "7.1",
        "no figure",
        f"wrong in the mean [%]: {'; '.join(words)}, at {sides} texels",
        UNSTATED,
        "Where a texel holds a neighbouring face, its plane may lie behind the point: the printed "
        "algorithm takes that for a miss, and most of its errors are such misses. brdfkit's search "
        "stays in place, and errs towards hits only.",
    )


def find_hits(found, planes, o, d, search=find_ray_entry):
    """Return whether rays enter a hull by a `search` such as Algorithm 3, and its look-ups.

    Origins `o` and directions `d` (n, 3) are in the hull's unit frame.
    """
    import mitsuba as mi

    o, d = mi.Vector3f(o.T.astype(np.float32)), mi.Vector3f(d.T.astype(np.float32))
    with replace_part(planes, "look_up_plane"):
        _, hit, lookups = search(mi, o, d, planes, mi.UInt32(0))
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
