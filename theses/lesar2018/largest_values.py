"""Measures how fast the largest of random points on a ray nears the ray's maximum, eq. 6.1."""

import numpy as np

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section
from brdfkit.volumes.made import make_volume
from brdfkit.volumes.rays.search import find_distance_of_maximum

SECONDS = 3
VOXELS, RAYS, ITERATIONS = 48, 400, 64
POINTS = 4, 16, 64  # look-ups in an iteration
STEPS, DENSE = 128, 8192  # points on a ray for brdfkit's search, and for the true maximum
TEXT = f"""{RAYS} rays of length 2 through smoke of {VOXELS}³ voxels. The thesis looks points up at
random and keeps the largest value; how many in an iteration, and how they are placed, it does not
say. Here they are even, at a random offset. Ours looks about the largest of {STEPS} nearer and
nearer, once. The truth is by {DENSE:,} points."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the largest value along rays; return their section of the page."""
    use_variant()
    volume = make_volume("smoke", (VOXELS,) * 3)
    rng = np.random.default_rng(0)
    ends = rng.normal(size=(2, RAYS, 3))
    o, d = 0.3 * ends[0], ends[1] / np.linalg.norm(ends[1], axis=1, keepdims=True)
    truth = evaluate_along(volume, o, d, (np.arange(DENSE) + 0.5) / DENSE).max(axis=1)
    report(1, 3)
    missing = {n: truth - accumulate_largest(volume, o, d, n, rng) for n in POINTS}
    report(2, 3)
    own = truth - find_refined_largest(volume, o, d, rng)
    picture = Picture("largest_values", draw_missing(missing, own), "Dashed: ours, once.")
    return Section("Maximum intensity", TEXT, [claim_below(missing, own, truth)],
                   pictures=[picture])  # fmt: skip


def evaluate_along(volume, o, d, shares):
    """Return a volume's values (rays, points) at shares of the lengths of rays."""
    t = 2 * np.asarray(shares) - 1
    points = o[:, None] + t[None, :, None] * d[:, None]
    return volume(points.reshape(-1, 3)).reshape(len(o), -1)


def accumulate_largest(volume, o, d, points, rng):
    """Return the largest value so far (iterations, rays), by the thesis's look-ups of points."""
    found = [
        evaluate_along(volume, o, d, (np.arange(points) + rng.random()) / points).max(axis=1)
        for _ in range(ITERATIONS)
    ]
    return np.maximum.accumulate(found)


def find_refined_largest(volume, o, d, rng):
    """Return the largest value (rays,) by brdfkit's search along rays."""
    import mitsuba as mi

    grid = mi.load_dict(volume.scene_dict(), parallel=False)
    o, d = (np.ascontiguousarray(x.T, np.float32) for x in (o, d))
    ray = mi.Ray3f(mi.Point3f(o), mi.Vector3f(d))

    def value(t):
        it = mi.Interaction3f()
        it.p = ray(t)
        return grid.eval_1(it)

    near, place = mi.Float(np.full(RAYS, -1.0)), mi.Float(rng.random(RAYS))
    t = find_distance_of_maximum(value, near, near + 2, STEPS, place, mi.Bool(True))
    return np.array(value(t), float)


def claim_below(missing, own, truth):
    """Claim that the largest value so far comes nearer from below."""
    least = min(m.min() for m in missing.values())
    means = {n: m.mean(axis=1)[[0, -1]] for n, m in missing.items()}
    said = "; ".join(f"{n} points {a:.4f}, {b:.4f}" for n, (a, b) in means.items())
    return Claim(
        "The largest value of the points so far comes nearer in each iteration.",
        "ch. 6, eq. 6.1",
        "no figure",
        f"missing after 1 and {ITERATIONS} iterations: {said}",
        to_verdict(least > -1e-3 * truth.max() and all(b < a / 4 for a, b in means.values())),
        "Never too large. Means over the rays, the values are 0 to 1. `maximum_intensity`, which "
        f"halves the distance about the largest of {STEPS} points, misses {own.mean():.0e}.",
        arithmetic=True,
    )


def draw_missing(missing, own):
    """Draw the missing part, a mean over the rays, over iterations."""
    drawn = make_figure(6, 2.6)
    axes = drawn.subplots()
    n = np.arange(1, ITERATIONS + 1)
    for (points, found), colour in zip(missing.items(), COLOURS, strict=False):
        axes.loglog(n, found.mean(axis=1), color=colour, label=f"{points} points")
    axes.axhline(
        own.mean(), color=COLOURS[-1], linestyle="--", linewidth=1, label="brdfkit's search"
    )
    axes.set_xlabel("iterations")
    axes.legend(fontsize=8)
    style_axes(axes, "", "missing")
    return drawn
