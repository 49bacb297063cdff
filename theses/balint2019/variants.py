"""Reproduces Tables 6.1 to 6.3: times of four marches, in two directions, with four ε."""

from itertools import product

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
from brdfkit.theses.balint2019.scenes import MARCHES
from brdfkit.theses.balint2019.view import View

from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section
from brdfkit.theses.timing import compare_times

SECONDS = 60
SIZE = 160
SCENES = {"table_6_1": scenes.simple, "table_6_2": scenes.complicated, "table_6_3": scenes.fractal}
NAMES = {"table_6_1": "simple", "table_6_2": "complicated", "table_6_3": "the Mandelbulb"}
PRACTICAL = 30  # the largest 1 / ε that the thesis calls useful
TEXT = f"""Pictures of {SIZE} × {SIZE} pixels, a light of radius {RADIUS:g}, and times of the
shadows alone: CPU seconds in one thread, the mean of {TIMES} turns. The printed ones are times of
frames less that of a frame without shadows. Both are ratios to the time of `linear` in direction A
at ε = 1/10, in each scene. A Mandelbulb is not convex: there `convex` marches as `linear`. A march
counts as faster than another one in a row if the whole 95 % interval of the ratio of their times,
by pairs from the same turns, says so."""


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
        claim_direction(printed, counts),
        claim_quality(errors),
    ]
    return Section("Marches, directions and ε", TEXT, claims, tables)


def takes_longer(some, others):
    """Return whether times (turn,) are above `others`, with the whole interval of the ratio."""
    return compare_times(some, others).low > 1


def judge_rows(test, tables):
    """Return whether a test of times (turn, march) holds, by scene, ε and direction."""
    return {
        (NAMES[table], f"1/{n}", direction): bool(test(times[:, row]))
        for table, times in tables.items()
        for row, (n, direction) in enumerate(list_settings())
    }


def claim_base(ours, printed):
    """Claim that the march `linear` is faster than `base`."""
    there = judge_rows(lambda row: takes_longer(row[:, BASE], row[:, LINEAR]), printed)
    turns = {
        NAMES[table]: np.exp(np.log(times[..., [BASE, LINEAR]]).mean(axis=1))
        for table, times in ours.items()
    }
    ratios = {scene: compare_times(both[:, 0], both[:, 1]) for scene, both in turns.items()}
    text, verdict = judge_over_grid(("scene",), {(s,): r.low > 1 for s, r in ratios.items()})
    words = ", ".join(f"{ratio} times in {scene}" for scene, ratio in ratios.items())
    return Claim(
        "`linear` is faster than `base`.",
        "7",
        f"{sum(there.values())} of {len(there)} rows",
        f"as fast {words}; {text}",
        verdict,
        "Geometric means over the rows of each table, as the two are about alike at ε = 1/256 on "
        "the Mandelbulb. `base` inverts τ at each step, here by Newton's method: by bisection it "
        "would be slower.",
    )


def claim_slowest(ours, printed):
    """Claim that the march `base` is the slowest."""
    here, there = (
        judge_rows(
            lambda row: all(takes_longer(row[:, BASE], row[:, m]) for m in range(1, len(MARCHES))),
            tables,
        )
        for tables in (ours, printed)
    )
    return Claim(
        "`base` is the slowest.",
        "7",
        f"{sum(there.values())} of {len(there)} rows",
        f"{sum(here.values())} of {len(here)}",
        to_verdict(all(here.values()) and all(there.values())),
        "The printed tables deny it themselves: in table 6.2 `discrete` and `convex` are slower in "
        "every row. Our number is that of brdfkit's forms: Newton's inverse of τ makes `base` "
        "faster than the thesis's bisection would, and `discrete` inverts τ twice a step here.",
    )


def claim_fastest(ours, printed):
    """Claim that the marches `linear` and `convex` are the fastest, in either direction."""
    here, there = ({}, {})
    for tables, cells in ((ours, here), (printed, there)):
        for table, (i, n) in product(tables, enumerate(INVERSES)):
            times = tables[table][:, 2 * i : 2 * i + 2]
            best = [
                min((times[:, d, m] for d in (0, 1) for m in marches), key=geometric_mean)
                for marches in ((BASE, DISCRETE), (LINEAR, CONVEX))
            ]
            cells[NAMES[table], f"1/{n}"] = takes_longer(*best)
    text, verdict = judge_over_grid(("scene", "ε"), here)
    return Claim(
        "`linear` and `convex` are the fastest marches.",
        "6.2, Tables 6.1-6.3",
        f"in {sum(there.values())} of {len(there)} settings",
        text,
        verdict,
        "The faster of the two against the faster of the other two, each in its better direction.",
    )


def geometric_mean(times):
    """Return the geometric mean of times (turn,)."""
    return float(np.exp(np.log(times).mean()))


def claim_direction(printed, evaluations):
    """Claim that the march `linear` is faster from the light (B) than from the surface (A)."""
    last = sum(n <= PRACTICAL for n in INVERSES)

    def count_smaller(tables):
        rows = [values[: 2 * last, LINEAR].reshape(last, 2) for values in tables]
        return int(sum((row[:, 1] < row[:, 0]).sum() for row in rows))

    many = last * len(evaluations)
    shares = [n[1 : 2 * last : 2, LINEAR] / n[: 2 * last : 2, LINEAR] for n in evaluations.values()]
    return Claim(
        "`linear` is faster from the light than from the surface, at ε of 1/30 and larger.",
        "Tables 6.1-6.3",
        f"{count_smaller(times[0] for times in printed.values())} of {many}",
        f"{count_smaller(evaluations.values())} of {many} by evaluations, which are "
        f"{np.min(shares):.2f} to {np.max(shares):.2f} times as many",
        to_verdict(count_smaller(evaluations.values()) == many),
        "Judged by evaluations, which no other load disturbs; the times, in the tables below, are "
        "smaller from the light in the same rows.",
    )


def claim_quality(errors):
    """Claim that the march `linear` is as exact as `base`, and `discrete` much less so."""
    cells, same, worse = {}, [], []
    for table, found in errors.items():
        for (n, direction), row in zip(list_settings(), found, strict=True):
            same.append(row[LINEAR] / row[BASE])
            worse.append(row[DISCRETE] / row[LINEAR])
            cells[NAMES[table], f"1/{n}", direction] = same[-1] <= 1.1 and worse[-1] >= 2
    text, verdict = judge_over_grid(("scene", "ε", "direction"), cells)
    return Claim(
        "`linear` is as good as `base`, and `discrete` is much worse.",
        "7",
        "by eye",
        f"errors of linear are {min(same):.2f} to {max(same):.2f} times those of base, errors of "
        f"discrete {min(worse):.1f} to {max(worse):.1f} times those of linear; {text}",
        verdict,
        "Against τ(r_min); as good up to 1.1 times, much worse from 2 times on. The distance of "
        "the Mandelbulb is an estimate that may jump: there a smaller ε brings no march nearer.",
    )
