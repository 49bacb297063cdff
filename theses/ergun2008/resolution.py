"""Checks that errors of shadow maps go to 0 as their resolution grows, section 3.1."""

import numpy as np
from brdfkit.theses.ergun2008.views import BIASES, PROJECTIONS, View

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Picture, Section

SECONDS = 40
RESOLUTIONS = 128, 256, 512, 1024, 2048, 4096
SCENE = "objects_on_a_ground"  # by all projections
SCENES = SCENE, "street", "compact"
TRIED = {name: BIASES[name] for name in (next(iter(BIASES)), "0.001")}
FOCUSED = "focused"
POWER = 0.7  # of the resolution, with which errors have to fall at least
TEXT = f"""Depth maps, views V1 and V3, light 1, one look-up a pixel: the share of the light that is
wrong where surfaces face it. All projections in `{SCENE}` by brdfkit's bias, and the focused one in
{len(SCENES)} scenes by two biases."""


@in_turn
def check_claims(sources, report):
    """Check the claims on errors of shadow maps by their resolution, and return their section."""
    use_variant()
    views, found = [View.load(SCENE, view, 1) for view in ("V1", "V3")], {}
    for done, name in enumerate(PROJECTIONS):
        found[name] = [
            float(
                np.mean([view.measure_error(compute_light_shares(view, name, n)) for view in views])
            )
            for n in RESOLUTIONS
        ]
        report(done + 1, len(PROJECTIONS) + len(SCENES))
    by_bias = {}
    for done, scene in enumerate(SCENES):
        by_bias |= measure_by_bias(scene)
        report(len(PROJECTIONS) + done + 1, len(PROJECTIONS) + len(SCENES))
    pictures = [Picture("resolution", draw_errors(found))]
    return Section("Resolution", TEXT, [claim_falling(found, by_bias)], [], pictures)


def measure_by_bias(scene):
    """Return the errors of focused maps by their resolution, for a scene and each bias."""
    errors = {bias: np.zeros(len(RESOLUTIONS)) for bias in TRIED}
    for view in ("V1", "V3"):
        seen = View.load(scene, view, 1)
        for i, n in enumerate(RESOLUTIONS):
            lits = seen.compute_lit_by_bias(TRIED.values(), projection=FOCUSED, resolution=n)
            for bias, lit in zip(TRIED, lits, strict=True):
                errors[bias][i] += seen.measure_error(lit) / 2
    return {(scene, bias): its for bias, its in errors.items()}


def compute_light_shares(view, name, resolution):
    """Return the shares of the light by a depth map of a projection and a resolution."""
    return view.compute_lit(view.make_shadow(projection=name, resolution=resolution))


def fit_powers(found):
    """Return the power of the resolution with which each projection's error falls."""
    return {
        name: -np.polyfit(np.log(RESOLUTIONS), np.log(errors), 1)[0]
        for name, errors in found.items()
    }


def claim_falling(found, by_bias):
    """Claim that errors go to 0, by all projections in one scene and in each scene by each bias."""
    power, last = fit_powers(found), {name: errors[-1] for name, errors in found.items()}
    powers = fit_powers(by_bias)
    holds = {cell: powers[cell] > POWER for cell in by_bias}
    every = min(power.values()) > POWER
    holds = {cell: bool(ok and every) for cell, ok in holds.items()}
    ours, verdict = judge_over_grid(("scene", "bias"), holds)
    return Claim(
        "Errors of shadow maps come of their resolution: they go to 0 as it grows.",
        "3.1",
        "no figure",
        f"{ours}; by brdfkit's bias in `{SCENE}` as its power {-min(power.values()):.2f} to "
        f"{-max(power.values()):.2f}, at {RESOLUTIONS[-1]}² {100 * min(last.values()):.2f} to "
        f"{100 * max(last.values()):.2f} % of the light; else {-max(powers.values()):.2f} to "
        f"{-min(powers.values()):.2f}",
        verdict,
        "A strip along the borders of shadows is wrong, as wide as a texel: power -1. It holds "
        f"where errors fall by -{POWER:g} or faster.",
    )


def draw_errors(found):
    """Draw errors of shadow maps over their resolution."""
    drawn = make_figure(5.5, 3.2)
    axes = drawn.subplots()
    for (name, errors), colour in zip(found.items(), COLOURS, strict=False):
        axes.loglog(RESOLUTIONS, 100 * np.array(errors), "o-", color=colour, ms=3,
                    label=PROJECTIONS[name])  # fmt: skip
    style_axes(axes, "", "wrong light [%]")
    axes.set_xlabel("texels along a side")
    axes.set_xticks(RESOLUTIONS, [str(n) for n in RESOLUTIONS])
    axes.minorticks_off()
    axes.legend(frameon=False, fontsize=8)
    return drawn
