"""Reproduces Tables 6.1 to 6.3: times of four marches, in two directions, with four ε."""

from collections import Counter
from functools import partial

import numpy as np
from brdfkit.theses.balint2019 import scenes
from brdfkit.theses.balint2019.march_times import (
    BASE,
    CONVEX,
    DISCRETE,
    INVERSES,
    LINEAR,
    RADIUS,
    TIMES,
    list_settings,
    make_error_table,
    make_times_table,
    measure_marches,
    read_printed_times,
)
from brdfkit.theses.balint2019.measuring import measure_in_turns
from brdfkit.theses.balint2019.scenes import MARCHES
from brdfkit.theses.balint2019.view import View
from brdfkit.theses.balint2019.whole_frames import measure_horizon

from brdfkit.core.jit.threads import in_turn
from brdfkit.distance_fields.shadows.marches import compute_convex_shadow, compute_linear_shadow
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.page import Section
from brdfkit.theses.timing import ALIKE, compare_times

SECONDS = 60
SIZE, HORIZON_SIZE = 160, 256
SCENES = {"table_6_1": scenes.simple, "table_6_2": scenes.complicated, "table_6_3": scenes.fractal}
FRACTAL = "table_6_3"
BARE = 0.7005  # [ms] of the frame of table 6.1 without shadows
PRACTICAL = 30  # the largest 1 / ε that the thesis calls useful
TEXT = f"""Pictures of {SIZE} × {SIZE} pixels, a light of radius {RADIUS:g}, and times of the
shadows alone: CPU seconds in one thread, the mean of {TIMES} turns. The printed ones are times of
frames less that of a frame without shadows. Both are told over the time of `linear` in direction A
at ε = 1/10, in each scene.
The thesis's rule for `convex` is not printed; ours is the line through the last two distances of
every convex object, also within objects. A Mandelbulb is not convex: there it marches as
`linear`. A march counts as faster than another one in a row unless the 95 % interval of the
ratio of their times, by pairs from the same turns, denies it."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the times of four marches; return their section of the page."""
    ours, counts, errors, tables = {}, {}, {}, []
    printed = {name: read_printed_times(name) for name in SCENES}
    for done, (name, scene) in enumerate(SCENES.items()):
        view = View(scene(), SIZE)
        times, counts[name], errors[name] = measure_marches(view)
        ours[name] = times / times[:, :1, LINEAR, None].mean(axis=0)
        tables.append(make_times_table(name, ours[name], printed[name], counts[name]))
        report(done + 1, len(SCENES) + 1)
    tables.append(make_error_table(errors))
    claims = [
        claim_fastest(ours, printed),
        claim_base(ours, printed),
        claim_slowest(ours, printed),
        claim_convex(ours, printed),
        claim_direction(printed, counts),
        claim_horizon(),
        claim_quality(errors),
    ]
    return Section("Marches, directions and ε", TEXT, claims, tables)


def takes_longer(some, others):
    """Return whether times (turn,) are above `others`, unless the ratio's interval denies it."""
    return compare_times(some, others).high > 1


def count_rows(test, tables):
    """Return in how many rows of tables a test of times (turn, march) holds, and how many exist."""
    rows = [times[:, row] for times in tables for row in range(len(list_settings()))]
    return sum(map(test, rows)), len(rows)


def claim_in_all_rows(says, where, test, ours, printed, why=""):
    """Claim that a test holds in all rows, and count those of the printed tables, too."""
    (here, many), (there, _) = (count_rows(test, tables.values()) for tables in (ours, printed))
    return Claim(
        says, where, f"{there} of {many} rows", f"{here} of {many}", to_verdict(here == many), why
    )


def claim_base(ours, printed):
    """Claim that the march `linear` is faster than `base`."""
    return claim_in_all_rows(
        "`linear` is faster than `base`.",
        "7",
        lambda row: takes_longer(row[:, BASE], row[:, LINEAR]),
        ours,
        printed,
        "It needs more evaluations, and no inverse of τ.",
    )


def claim_slowest(ours, printed):
    """Claim that the march `base` is the slowest."""
    return claim_in_all_rows(
        "`base` is the slowest.",
        "7",
        lambda row: all(takes_longer(row[:, BASE], row[:, m]) for m in range(1, len(MARCHES))),
        ours,
        printed,
        "The thesis's own tables say so of the Mandelbulb and of the simple scene alone. "
        "`discrete` inverts τ, too, and twice a step here; of evaluations `linear` needs most.",
    )


def claim_convex(ours, printed):
    """Claim that the march `convex` is faster than `linear`, where objects are convex."""
    kept = [name for name in ours if name != FRACTAL]
    return claim_in_all_rows(
        "Where objects are convex, `convex` is faster than `linear`.",
        "7",
        lambda row: takes_longer(row[:, LINEAR], row[:, CONVEX]),
        {name: ours[name] for name in kept},
        {name: printed[name] for name in kept},
        "In table 6.2 the printed times of `convex` are those of `discrete` to 0.3 %: it may have "
        "run without its steps.",
    )


def claim_fastest(ours, printed):
    """Claim which march is the fastest in each scene, with each ε."""
    names, same, found = list(MARCHES), 0, []
    for table in ours:
        for i in range(len(INVERSES)):
            last = CONVEX if table == FRACTAL else None  # there it is `linear` once more
            both = [
                np.log(times[table][:, 2 * i : 2 * i + 2, :last]).mean(axis=0)
                for times in (ours, printed)
            ]
            here, there = (np.unravel_index(np.argmin(times), times.shape) for times in both)
            same += names[here[1]] == names[there[1]]
            found.append(f"{names[here[1]]} {'AB'[here[0]]}")
    ours_in_words = ", ".join(f"{who} {many}" for who, many in Counter(found).most_common())
    return Claim(
        "The fastest march by scene and ε.",
        "Tables 6.1-6.3",
        "linear B 7, convex B 3, linear A 2",
        f"{ours_in_words}; the same march in {same} of {len(found)}",
        to_verdict(same == len(found)),
    )


def claim_direction(printed, evaluations):
    """Claim that the march `linear` is faster from the light (B) than from the surface (A)."""
    last = sum(n <= PRACTICAL for n in INVERSES)

    def count_smaller(tables):
        rows = [values[: 2 * last, LINEAR].reshape(last, 2) for values in tables]
        return int(sum((row[:, 1] < row[:, 0]).sum() for row in rows))

    many = last * len(evaluations)
    shares = [n[1 : 2 * last : 2, LINEAR] / n[: 2 * last : 2, LINEAR] for n in evaluations.values()]
    return Claim(
        f"`linear` is faster from the light than from the surface, from ε = 1/{PRACTICAL} on.",
        "Tables 6.1-6.3",
        f"{count_smaller(times[0] for times in printed.values())} of {many}",
        f"{count_smaller(evaluations.values())} of {many} by evaluations, which are "
        f"{np.min(shares):.2f} to {np.max(shares):.2f} times as many",
        to_verdict(count_smaller(evaluations.values()) == many),
    )


def claim_horizon():
    """Claim that the march `convex` is up to three times as fast as `linear` near the horizon."""
    view = View(scenes.horizon(), HORIZON_SIZE)
    field, cone = view.scene.field, view.make_cones(RADIUS)
    methods = {
        (m, way): partial(m, field, cone, 1 / 30, way)
        for m in (compute_linear_shadow, compute_convex_shadow)
        for way in "AB"
    }
    seconds = measure_in_turns(methods, TIMES)
    ours = [
        compare_times(seconds[compute_linear_shadow, way], seconds[compute_convex_shadow, way])
        for way in "AB"
    ]
    frames = measure_horizon(1 / 30)
    alone = (4.55 - BARE) / (1.53 - BARE)
    return Claim(
        "With the horizon in view `convex` is up to 3 times as fast as `linear`.",
        "6.2",
        f"{4.55 / 1.53:.2f} times, of frames; about {alone:.1f} of shadows, by the frame without "
        "any of table 6.1",
        f"{ours[0]} and {ours[1]} times, of shadows from the surface and from the light",
        to_verdict(any(ratio.is_at_least(alone) for ratio in ours)),
        f"ε = 1/30; the direction is not printed. Confirmed if one is within {ALIKE:g} times of "
        f"the printed one. Of whole frames ours is {frames[0]} and {frames[1]} times as fast, "
        "as eye rays towards the horizon take most of the time here.",
    )


def claim_quality(errors):
    """Claim that the march `linear` is as exact as `base`, and `discrete` much less so."""
    last = 2 * sum(n <= PRACTICAL for n in INVERSES)
    some = np.concatenate([e[:last] for name, e in errors.items() if name != FRACTAL])
    same, worse = some[:, LINEAR] / some[:, BASE], some[:, DISCRETE] / some[:, LINEAR]
    return Claim(
        "`linear` is as good as `base`, and `discrete` is much worse.",
        "7",
        "by eye",
        f"errors of linear are {same.min():.2f} to {same.max():.2f} times those of base, errors of "
        f"discrete {worse.min():.1f} to {worse.max():.1f} times those of linear",
        to_verdict(same.max() <= 1.1 and worse.min() >= 2),
        "Against τ(r_min), where distances are exact; confirmed up to 1.1 and from 2 times on. The "
        "distance of the Mandelbulb is an estimate that may jump: there a smaller ε brings no "
        "march nearer.",
    )
