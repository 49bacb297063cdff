"""Judges the march `convex`: where it is faster than `linear`, and the reasons that are given."""

from functools import partial
from itertools import product

import drjit as dr
import numpy as np
from brdfkit.theses.balint2019 import scenes
from brdfkit.theses.balint2019.march_times import (
    CONVEX,
    LINEAR,
    RADIUS,
    TIMES,
    list_settings,
    read_printed_times,
)
from brdfkit.theses.balint2019.measuring import measure_in_turns, read_shares
from brdfkit.theses.balint2019.view import View
from brdfkit.theses.balint2019.whole_frames import measure_horizon

from brdfkit.core.jit.threads import in_turn
from brdfkit.distance_fields.shadows.march import make_cone_tracing_step
from brdfkit.distance_fields.shadows.marches import (
    compute_convex_shadow,
    compute_linear_shadow,
    make_convex_step,
    make_linear_rule,
)
from brdfkit.distance_fields.shadows.shadow import trace_shadow
from brdfkit.theses.claims import Claim
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table
from brdfkit.theses.timing import ALIKE, compare_times

SECONDS = 40
SIZE = 160
SCENES = {"simple": scenes.simple, "horizon": scenes.horizon, "complicated": scenes.complicated}
TABLES = {"table_6_1": "simple", "table_6_2": "complicated"}
EPSILON = 1 / 30  # of the frames with the horizon
LIT = 1 - 1 / 256  # the least share of the light that is seen as all of it
TEXT = f"""The thesis names `convex` and prints no rule for its steps, nor the march that it was
built on. It says that they need a convex object, and hold outside of it alone: where the radius of
the cone becomes negative, steps are those of the other marches again. Ours follow the line through
the last two distances of each convex object, in `linear`, and hold within objects, too. So they are
tried with two reaches: *everywhere*, which is brdfkit's, and *outside*, the same steps with the
thesis's condition. Pictures of {SIZE} × {SIZE} pixels, a light of radius {RADIUS:g}. Times are
those of shadows alone, except with the horizon; a march is faster where the whole 95 % interval of
the ratio says so."""


def make_outer_step(field, cone):
    """Return a function for steps that are long outside of objects alone, and its memory."""
    go_far, memory = make_convex_step(field, cone)
    go_near, _ = make_cone_tracing_step(field, cone)

    def choose_step(t, F, R_C, memory):
        far, memory = go_far(t, F, R_C, memory)
        near, _ = go_near(t, F, R_C, ())
        return dr.select((F > 0) & (R_C >= 0), far, near), memory

    return choose_step, memory


def compute_outer_shadow(field, cone, epsilon=1 / 20, direction="A"):
    """Compute a shadow by `convex`, with its long steps only where the thesis allows them."""
    rule = make_linear_rule(epsilon)
    return trace_shadow(field, cone, rule, epsilon, direction, make_outer_step)


FORMS = {"outside": compute_outer_shadow, "everywhere": compute_convex_shadow}


@in_turn
def check_claims(sources, report):
    """Check the claims on the march `convex`; return their section of the page."""
    ratios, gains = {}, {}
    for done, (name, scene) in enumerate(SCENES.items()):
        view = View(scene(), SIZE)
        if name in TABLES.values():
            ratios |= {(name, *key): ratio for key, ratio in measure_ratios(view).items()}
        gains |= {(name, *key): gain for key, gain in count_gains(view).items()}
        report(done + 1, len(SCENES) + 1)
    claims = [claim_faster(ratios), claim_reason(gains), claim_horizon()]
    rows = [
        (scene, form, way, *(f"{gains[scene, form, way, some]:.1f}" for some in POINTS))
        for scene, form, way in product(SCENES, FORMS, "AB")
    ]
    caption = "How many times as many evaluations `linear` needs, at ε = 1/30."
    table = Table(("scene", "reach", "direction", *POINTS), rows, caption)
    return Section("Convex objects", TEXT, claims, [table])


def measure_ratios(view):
    """Return how long `linear` takes over `convex`, by form, inverse error bound and direction."""
    field, cone = view.scene.field, view.make_cones(RADIUS)
    methods = {
        (form, n, way): partial(march, field, cone, 1 / n, way)
        for form, march in ({"linear": compute_linear_shadow} | FORMS).items()
        for n, way in list_settings()
    }
    seconds = measure_in_turns(methods, TIMES)
    return {
        (form, n, way): compare_times(seconds["linear", n, way], seconds[form, n, way])
        for form in FORMS
        for n, way in list_settings()
    }


POINTS = "all points", "fully lit", "partly lit or dark", "far from the light", "near the light"


def count_gains(view):
    """Return how many times as many evaluations `linear` needs, by form, direction and points."""
    field, cone = view.scene.field, view.make_cones(RADIUS)
    d, gains = np.array(cone.d), {}
    for way in "AB":
        plain = compute_linear_shadow(field, cone, EPSILON, way)
        lit, far = read_shares(plain) > LIT, d > np.median(d)
        for form, march in FORMS.items():
            counts = [
                np.array(s.evaluations, float) for s in (plain, march(field, cone, EPSILON, way))
            ]
            for what, some in zip(POINTS, (d > 0, lit, ~lit, far, ~far), strict=True):
                gains[form, way, what] = counts[0][some].mean() / counts[1][some].mean()
    return gains


def claim_faster(ratios):
    """Claim that `convex` is faster than `linear` where objects are convex."""
    printed = [read_printed_times(table)[0] for table in TABLES]
    there = sum(int((times[:, CONVEX] < times[:, LINEAR]).sum()) for times in printed)
    cells = {(scene, form, f"1/{n}", way): r.low > 1 for (scene, form, n, way), r in ratios.items()}
    ours, verdict = judge_over_grid(("scene", "reach", "ε", "direction"), cells)
    spans = ", ".join(
        f"{min(values):.1f} to {max(values):.1f} times {form}"
        for form in FORMS
        for values in [[r.value for (_, f, *_), r in ratios.items() if f == form]]
    )
    return Claim(
        "Where objects are convex, `convex` is faster than `linear`.",
        "7",
        f"{there} of {sum(map(len, printed))} rows",
        f"with our steps {spans}; {ours}",
        verdict,
        "The steps are ours, so that this says nothing of the thesis's own times. In table 6.2 the "
        "printed times of `convex` are those of `discrete` to 0.3 %: it may have run without its "
        "steps.",
    )


def claim_reason(gains):
    """Claim that `convex` gains most where light arrives unblocked, or has far to go."""
    causes = {"light that arrives": POINTS[1:3], "distance": POINTS[3:]}
    cells = {
        (cause, scene, form, way): gains[scene, form, way, more] > gains[scene, form, way, less]
        for cause, (more, less) in causes.items()
        for scene, form, way in product(SCENES, FORMS, "AB")
    }
    ours, verdict = judge_over_grid(("reason", "scene", "reach", "direction"), cells)
    return Claim(
        "`convex` wins where much of the picture is fully lit, or light travels far.",
        "6.2",
        "no figure",
        f"{ours}; it needs fewer evaluations everywhere",
        verdict,
        "By evaluations, at ε = 1/30: whether `convex` saves a larger share of them at fully lit "
        "points than at others, and at points further from the light than the median of the "
        "picture than at nearer ones.",
    )


def claim_horizon():
    """Claim that `convex` is up to three times as fast as `linear` near the horizon."""
    ratios, printed = measure_horizon(EPSILON, FORMS), 4.55 / 1.53
    ways = {"A": "from the surface", "B": "from the light"}
    cells = {(ways[way],): ratios["outside", way].is_at_least(printed) for way in ways}
    _, verdict = judge_over_grid(("direction",), cells)
    words = ", ".join(f"{r} {form} and {ways[way]}" for (form, way), r in ratios.items())
    return Claim(
        "With the horizon in view `convex` is up to 3 times as fast as `linear`.",
        "6.2",
        f"{printed:.2f} times, of frames",
        f"{words}, of frames",
        verdict,
        "Judged by the thesis's reach, outside of objects; ε = 1/30, and the direction is not "
        f"printed. It would hold from {printed / ALIKE:.2f} times on, with the whole interval: "
        f"less by the factor {ALIKE:g}. "
        "Eye rays towards the horizon take most of the time of our frames; of the shadows alone "
        "the table below has the evaluations.",
    )
