"""Measures how much too deep an isosurface lies that is found by points on rays, eq. 6.2."""

import numpy as np

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section, Table
from brdfkit.volumes.rays.search import find_first_crossing, find_first_positive_step

SECONDS = 1
LENGTH, RADIUS = 2.0, 0.5  # of the rays towards the sphere, and of the sphere
POINTS, RAYS = (10, 32, 128), 100_000
ITERATIONS, FEWER_RAYS = 64, 1_000  # each of the last number of points, and their rays
APART = 0.0916  # the error of 10 points over the rays' length, by an independent simulation
TEXT = f"""Rays of length D towards a half-space that begins at D / 4: the first of N random points
that is inside, and the first after {ITERATIONS} iterations of {POINTS[-1]} points, as the thesis
keeps the nearest over iterations. And rays towards a sphere: the first of N even steps, and what
`isosurface` leaves of that, which then halves the step. {RAYS:,} rays; errors are means over D."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the depth of isosurfaces by points on rays, and return their section."""
    use_variant()
    rng = np.random.default_rng(0)
    found = {n: (measure_random_depth(n, rng), *measure_sphere_errors(n, rng)) for n in POINTS}
    rows = [
        (f"{n}", f"{1 / (n + 1):.5f}", *(f"{v:.5f}" for v in values[:2]), f"{values[2]:.1e}")
        for n, values in found.items()
    ]
    n = POINTS[-1] * ITERATIONS
    converged = measure_random_depth(n, rng, FEWER_RAYS)
    rows.append((f"{n}", f"{1 / (n + 1):.5f}", f"{converged:.5f}", "", ""))
    heads = "N", "1 / (N + 1)", "random points", "even steps", "refined"
    caption = "How much too deep, over D; refined: the largest error in either direction."
    return Section(
        "The depth of isosurfaces",
        TEXT,
        [claim_depth(found, converged)],
        [Table(heads, rows, caption)],
    )


def measure_random_depth(n, rng, rays=RAYS // 10):
    """Return the mean excess depth of the first of n random points inside a half-space.

    It is relative to the length of the rays; rays without a point inside are left out.
    """
    places = rng.random((rays, n))
    places[places < 0.25] = np.inf
    first = places.min(axis=1)
    return first[np.isfinite(first)].mean() - 0.25


def measure_sphere_errors(n, rng):
    """Return errors of the depth of a sphere by n even steps: the mean, and the largest refined."""
    import mitsuba as mi

    across = 0.9 * RADIUS * np.sqrt(rng.random(RAYS))
    start = rng.random(RAYS) * 0.1
    truth = LENGTH / 2 - np.sqrt(RADIUS**2 - across**2)
    side, near = mi.Float(across), mi.Float(start)

    def evaluate_sphere(t):
        z = t - LENGTH / 2
        return RADIUS - (side * side + z * z) ** 0.5

    far, active = near + LENGTH, mi.Bool(True)
    _, t, _ = find_first_positive_step(evaluate_sphere, near, far, n, active)
    refined, _ = find_first_crossing(evaluate_sphere, near, far, n, active)
    inside = np.array(t, float) < LENGTH / 2 + 0.9 * RADIUS  # other rays miss the sphere
    off = np.array(t, float) - truth
    return off[inside].mean() / LENGTH, np.abs(np.array(refined) - truth)[inside].max() / LENGTH


def claim_depth(found, converged):
    """Claim that the nearest of random points inside is on the surface."""
    off = max(abs(values[0] * (n + 1) - 1) for n, values in found.items())
    n, worst = POINTS[-1], max(values[2] for values in found.values())
    return Claim(
        "The nearest of points on a ray that are inside is the surface.",
        "eq. 6.2",
        f"{APART:g} D too deep by 10 points, computed apart",
        f"{found[10][0]:.4f} D by 10 points, {found[n][0]:.4f} D by {n}, {converged:.5f} D after "
        f"{ITERATIONS} iterations of {n}; refined at once, {worst:.0e} D",
        to_verdict(converged < 1e-3),
        f"It is never in front of it, and D / (N + 1) too deep, here to {100 * off:.0f} %: one "
        "iteration shows a surface that is too deep, and it comes near as iterations add up. A "
        "refinement, which the thesis does not have, takes nine look-ups. Confirmed if less than "
        f"0.001 D is left after {ITERATIONS} iterations.",
    )
