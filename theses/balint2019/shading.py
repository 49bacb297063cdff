"""Compares shading by one march, by samples that a march decides, and by rays.

The thesis does so in Figures 6.15 and 6.16.
"""

import numpy as np
from brdfkit.theses.balint2019 import scenes
from brdfkit.theses.balint2019.measuring import compute_rms

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn, use_one_thread
from brdfkit.theses.claims import Claim, measure_cpu_seconds, to_verdict
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section, Table
from brdfkit.theses.timing import ALIKE, compare_times

SECONDS = 25
SIZE, MANY, FEW, TRUE_SAMPLES, TIMES = 128, 150, 50, 1024, 5
RADIUS, SIDES = 0.6, (0.9, 0.5)  # the spherical light's radius, half of the other one's edges
SPLIT, ESTIMATED, EXACT = ({"shading": s} for s in ("split", "estimated", "exact"))
# The pictures of Figure 6.16: light, settings of the integrator, printed time [ms]
METHODS = {
    "a, quilez": ("sphere", SPLIT | {"shadow": "quilez"}, 1.17),
    "b, one march": ("sphere", SPLIT, 1.49),
    "c, rays for the share": ("sphere", SPLIT | {"shadow": "monte_carlo", "rays": MANY}, 49.7),
    "d, samples by a march": ("sphere", ESTIMATED | {"samples": MANY}, 41.3),
    "e, samples by rays": ("sphere", EXACT | {"samples": MANY}, 74.7),
    "f, samples by a march": ("rectangle", ESTIMATED | {"samples": MANY}, 33.6),
    "g, fewer by rays": ("rectangle", EXACT | {"samples": FEW}, 27.5),
    "h, fewer by a march": ("rectangle", ESTIMATED | {"samples": FEW}, 12.6),
}
TEXT = f"""A sphere, a cube and a cylinder, of rough plastic on a matte ground, under a sphere of
radius {RADIUS:g} or a rectangle; {SIZE} × {SIZE} pixels, one ray for each, by the integrator
`distance_field` with `linear` at ε = 1/20. Times are CPU seconds of whole pictures in one thread,
by {TIMES} turns; those of the thesis are of whole pictures, too. It names no BSDF. Truth:
{TRUE_SAMPLES:,} samples by rays."""


@in_turn
def check_claims(sources, report):
    """Check the claims on shading by marches and by rays; return their section of the page."""
    use_variant()
    truths = {
        light: render_radiance(light, EXACT | {"samples": TRUE_SAMPLES}) for light in make_lamps()
    }
    calls = {n[0]: make_renderer(light, how) for n, (light, how, _) in METHODS.items()}
    pictures = {name: call() for name, call in calls.items()}  # compiles, which is not timed
    seconds = {name: [] for name in calls}
    with use_one_thread():
        for turn in range(1 + TIMES):  # the first one is not counted
            for name, call in calls.items():
                seconds[name].append(measure_cpu_seconds(call))
            report(turn + 1, 1 + TIMES)
    seconds = {name: found[1:] for name, found in seconds.items()}
    rows = [
        (
            name,
            light,
            f"{compare_times(seconds[name[0]], seconds['b']).value:.2f}",
            f"{printed / METHODS['b, one march'][2]:.2f}",
            f"{compute_rms(pictures[name[0]] - truths[light]):.4f}",
            f"{np.mean(pictures[name[0]] - truths[light]):+.4f}",
        )
        for name, (light, _, printed) in METHODS.items()
    ]
    heads = "Figure 6.16", "light", "time", "printed", "error", "mean error"
    table = Table(heads, rows, "Times over those of b; errors of radiance, 1 is white.")
    errors = {name: pictures[name] - truths["sphere"] for name in "abcde"}
    claims = [
        claim_dark(pictures),
        claim_near(pictures),
        claim_leak(errors),
        claim_faster("d", "e", 74.7 / 41.3, seconds, f"{MANY} samples of a sphere"),
        claim_faster("h", "g", 27.5 / 12.6, seconds, f"{FEW} samples of a rectangle"),
    ]
    shown = Picture("shading", draw_pictures(pictures), "Figure 6.16, from a to h.")
    return Section("Shading", TEXT, claims, [table], [shown])


def make_lamps():
    """Return the Mitsuba dictionaries of both lights by name."""
    import mitsuba as mi

    scene = scenes.three_solids()
    centre, to_world = list(scene.light), mi.ScalarTransform4f
    glow = {"type": "area", "radiance": {"type": "rgb", "value": [72.0] * 3}}
    place = to_world().look_at(centre, [0, 0, 0.5], [0, 0, 1]).scale([*SIDES, 1])
    return {
        "sphere": {"type": "sphere", "center": centre, "radius": RADIUS, "emitter": glow},
        "rectangle": {"type": "rectangle", "to_world": place, "emitter": glow},
    }


def make_renderer(light, settings):
    """Return a function that renders the scene under a light, by settings of the integrator."""
    import mitsuba as mi

    scene = scenes.three_solids()
    camera = mi.ScalarTransform4f().look_at(list(scene.eye), list(scene.target), [0, 0, 1])
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}}
    plastic = {"type": "roughplastic", "alpha": 0.2, "diffuse_reflectance": 0.4}
    field = scene.field.children
    solids = field[0] | field[1] | field[2]
    loaded = mi.load_dict(
        {
            "type": "scene",
            "integrator": {
                "type": "distance_field",
                "field": (solids.made_of("plastic") | field[3]).to_json(),
                "plastic": plastic,
                "bsdf": {"type": "diffuse", "reflectance": 0.5},
                "epsilon": 1 / 20,
                **settings,
            },
            "sensor": {"type": "perspective", "fov": scene.fov, "to_world": camera, "film": film},
            "light": make_lamps()[light],
        },
        parallel=False,
    )
    return lambda: np.array(mi.render(loaded, spp=1), float)[..., 0]


def render_radiance(light, settings):
    """Render the radiance of one channel (size, size)."""
    return make_renderer(light, settings)()


def claim_dark(pictures):
    """Claim that shadows of a rival method are too large, by pictures of Figure 6.16."""
    a, b = (np.mean(pictures[name] - pictures["c"]) for name in "ab")
    return Claim(
        "The shadows of Quílez's and Aaltonen's method are too large.",
        "Figure 6.16 a",
        "a picture",
        f"mean radiance {a:+.4f} against the share by rays; {b:+.4f} of one march",
        to_verdict(a < -2 * abs(b)),
        "Confirmed where it is darker by twice what one march is off.",
    )


def claim_near(pictures):
    """Claim that one march is far closer to rays than a rival, by pictures of Figure 6.16."""
    a, b = (compute_rms(pictures[name] - pictures["c"]) for name in "ab")
    return Claim(
        "One march is far closer to the share by rays.",
        "Figure 6.16 a-c",
        "pictures",
        f"errors {a:.4f} and {b:.4f}",
        to_verdict(b < a / 2),
        "Confirmed below half.",
    )


def claim_leak(errors):
    """Claim that samples decided by a march have the errors of one march."""
    return Claim(
        "Samples that a march decides have the errors of one march.",
        "Figure 6.16 d, e",
        "the same leak",
        f"errors {compute_rms(errors['d']):.4f} and {compute_rms(errors['b']):.4f}; of rays for "
        f"the share {compute_rms(errors['c']):.4f}",
        to_verdict(0.5 < compute_rms(errors["d"]) / compute_rms(errors["b"]) < 1.5),
        "Confirmed from 0.5 to 1.5 times. What is left of c is the BSDF, taken at the middle of "
        "the light.",
    )


def claim_faster(march, rays, printed, seconds, what):
    """Claim that samples by a march take less time than samples by rays."""
    ours = compare_times(seconds[rays], seconds[march])
    return Claim(
        f"{what} by a march take less time than by rays.",
        f"Figure 6.16 {min(march, rays)}, {max(march, rays)}",
        f"{printed:.2f} times as fast",
        f"{ours} times as fast",
        to_verdict(ours.is_at_least(printed)),
        f"Confirmed within {ALIKE:g} times of what is printed.",
    )


def draw_pictures(pictures):
    """Draw all pictures of Figure 6.16."""
    drawn = make_figure(9, 4.8)
    for axes, (name, picture) in zip(drawn.subplots(2, 4).flat, pictures.items(), strict=True):
        axes.imshow(np.clip(picture, 0, 1) ** (1 / 2.2), cmap="gray", vmin=0, vmax=1)
        axes.set_title(name, size=10)
        axes.set_axis_off()
    return drawn
