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
from brdfkit.theses.grid import judge_over_grid
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
takes a step backwards by more than ε for a miss; the thesis tells neither ε, here over the sphere's
radius, nor the size of its maps. brdfkit's search takes no step backwards. The last columns: rays
whose answer is wrong where the planes come from a map of so many texels by side, in the mean over
hulls."""


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
        exact = [find_hits(ExactPlaneMap([hull]), o, d, search) for hull in hulls]
        wrong = [int((hit != truth).sum()) for (hit, _), truth in zip(exact, truths, strict=True)]
        lookups = [count[count > 0].mean() for _, count in exact]
        coarse = [
            [
                np.mean(find_hits(RasterisedPlaneMap([hull], side), o, d, search)[0] != truth)
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
    claims = [*claim_exact(found), claim_inside(hulls), claim_raster(found)]
    return Section("Rays and convex parts", TEXT, claims, [table])


def claim_exact(found):
    """Claim that the search ends at the exact answer: over ε as printed, and by brdfkit.

    `found` maps each search to its mean look-ups by hull, wrong rays by hull, and errors by texels.
    """
    wrong = {label: sum(by) for label, (_, by, _) in found.items()}
    says, where, total = (
        "By true planes, the search of a convex part is exact",
        "7.1",
        RAYS * len(CORNERS),
    )
    cells = {(f"{e:g}",): wrong[f"printed, ε = {e:g}"] == 0 for e in EPSILONS}
    _, verdict = judge_over_grid(("ε",), cells)
    counts = ", ".join(f"{wrong[f'printed, ε = {e:g}']:,}" for e in EPSILONS)
    return [
        Claim(
            f"{says}: the thesis's form.",
            where,
            "exact",
            f"{counts} of {total:,} rays wrong with ε = {', '.join(f'{e:g}' for e in EPSILONS)}",
            verdict,
            "A larger ε takes near misses for hits. What maps of planes lose is told below.",
        ),
        Claim(
            f"{says}: brdfkit's form.",
            where,
            "exact",
            f"{wrong[OURS]:,} of {total:,} rays wrong",
            to_verdict(wrong[OURS] == 0),
        ),
    ]


def claim_inside(hulls):
    """Claim that rays from inside the sphere fail, unless the entry may lie behind their origin."""
    o, d = make_inner_rays()
    failed, wrong, hits = 0, 0, 0
    for hull in hulls:
        near = clip_rays(hull, o, d)
        truth = (near >= 0) & (near < np.inf)
        planes = ExactPlaneMap([hull])
        ahead, mended = (
            find_entries(planes, o, d, make_printed_search(EPSILONS[0], first))[:2]
            for first in (True, False)
        )
        found = mended[1] & (mended[0] >= 0)  # a hit behind the origin is none
        failed, wrong = failed + (truth & ~ahead[1]).sum(), wrong + (found != truth).sum()
        hits += truth.sum()
    return Claim(
        "A ray from inside the sphere misses a part before it, unless its entry may lie behind the "
        "origin: the thesis's form.",
        "7.1, Figure 7.5",
        "a failure, and its mend",
        f"{failed:,} of {hits:,} hits are missed; so mended, {wrong:,} of {RAYS * len(hulls):,} "
        "rays are wrong",
        to_verdict(failed > 0 and wrong == 0),
        f"By true planes and ε = {EPSILONS[0]:g}.",
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


def find_hits(planes, o, d, search):
    """Return whether rays enter a hull by a `search` such as Algorithm 3, and its look-ups."""
    return find_entries(planes, o, d, search)[1:]


def find_entries(planes, o, d, search):
    """Return the distances at which rays enter a hull, whether they do, and the look-ups.

    Origins `o` and directions `d` (n, 3) are in the hull's unit frame.
    """
    import mitsuba as mi

    o, d = mi.Vector3f(o.T.astype(np.float32)), mi.Vector3f(d.T.astype(np.float32))
    with replace_part(planes, "look_up_plane"):
        return tuple(map(np.array, search(mi, o, d, planes, mi.UInt32(0))))


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


def make_inner_rays():
    """Return random origins in the unit ball (RAYS, 3), and random unit directions."""
    rng = np.random.default_rng(2)
    o = draw_unit_vectors(rng, RAYS) * rng.random((RAYS, 1)) ** (1 / 3)
    return o, draw_unit_vectors(rng, RAYS)


def draw_unit_vectors(rng, n):
    """Draw random unit vectors (n, 3)."""
    w = rng.normal(size=(n, 3))
    return w / np.linalg.norm(w, axis=1, keepdims=True)
