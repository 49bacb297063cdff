"""Compares shading by one march, by samples that a march decides, and by rays.

The thesis does so in Figures 6.15 and 6.16.
"""

import numpy as np
from brdfkit.theses.balint2019 import scenes
from brdfkit.theses.balint2019.measuring import compute_rms
from brdfkit.theses.balint2019.shading_claims import (
    claim_dark,
    claim_faster,
    claim_more_leaks,
    claim_near,
    claim_rectangle,
    claim_same_leak,
    claim_times,
)

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn, use_one_thread
from brdfkit.theses.claims import measure_cpu_seconds
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section, Table
from brdfkit.theses.timing import compare_times

SECONDS = 40
SIZE, MANY, FEW, TRUE_SAMPLES, TIMES = 128, 150, 50, 1024, 15
RADIUS, SIDES = 0.6, (0.9, 0.5)  # the spherical light's radius, half of the other one's edges
SPLIT, ESTIMATED, EXACT = ({"shading": s} for s in ("split", "estimated", "exact"))
# The pictures of Figure 6.16: light, settings of the integrator, printed time [ms]
METHODS = {
    "a, quilez": ("sphere", SPLIT | {"shadow": "quilez"}, 1.17),
    "a', aaltonen": ("sphere", SPLIT | {"shadow": "aaltonen"}, 1.17),
    "b, one march": ("sphere", SPLIT, 1.49),
    "c, rays for the share": ("sphere", SPLIT | {"shadow": "monte_carlo", "rays": MANY}, 49.7),
    "d, samples by a march": ("sphere", ESTIMATED | {"samples": MANY}, 41.3),
    "e, samples by rays": ("sphere", EXACT | {"samples": MANY}, 74.7),
    "f, samples by a march": ("rectangle", ESTIMATED | {"samples": MANY}, 33.6),
    "g, fewer by rays": ("rectangle", EXACT | {"samples": FEW}, 27.5),
    "h, fewer by a march": ("rectangle", ESTIMATED | {"samples": FEW}, 12.6),
}
# Pictures that the thesis does not have: light, settings
OTHERS = {
    "none": ("sphere", SPLIT | {"shadow": "none"}),
    "rays": ("rectangle", EXACT | {"samples": MANY}),
}
WHITE, SHOWN = 1.5, 0.05  # how many times as bright the figure is; the largest difference it shows
TEXT = f"""A sphere, a cube and a cylinder, of rough plastic on a matte ground, under a sphere of
radius {RADIUS:g} or a rectangle; {SIZE} × {SIZE} pixels, one ray for each, by the integrator
`distance_field` with `linear` at ε = 1/20. Times are CPU seconds of whole pictures in one thread,
by {TIMES} turns; those of the thesis are of whole pictures, too. It names no BSDF, and does not say
whether a is by Quílez's or by Aaltonen's formula. Truth: {TRUE_SAMPLES:,} samples by rays."""


@in_turn
def check_claims(sources, report):
    """Check the claims on shading by marches and by rays; return their section of the page."""
    use_variant()
    truths = {
        light: render_radiance(light, EXACT | {"samples": TRUE_SAMPLES}) for light in make_lamps()
    }
    calls = {get_letter(n): make_renderer(light, how) for n, (light, how, _) in METHODS.items()}
    calls |= {name: make_renderer(*how) for name, how in OTHERS.items()}
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
            f"{compare_times(seconds[get_letter(name)], seconds['b']).value:.2f}",
            f"{printed / METHODS['b, one march'][2]:.2f}",
            f"{compute_rms(pictures[get_letter(name)] - truths[light]):.4f}",
            f"{np.mean(pictures[get_letter(name)] - truths[light]):+.4f}",
        )
        for name, (light, _, printed) in METHODS.items()
    ]
    heads = "Figure 6.16", "light", "time", "printed", "error", "mean error"
    table = Table(heads, rows, "Times over those of b; errors of radiance, 1 is white.")
    lights = {get_letter(n): how[0] for n, how in (METHODS | OTHERS).items()}
    errors = {n: pictures[n] - truths[light] for n, light in lights.items()}
    claims = [
        claim_dark(pictures),
        claim_near(pictures),
        claim_more_leaks(pictures),
        claim_times("c", f"{MANY} rays for the share", 49.7 / 1.49, seconds),
        claim_times("d", f"{MANY} samples that a march decides", 41.3 / 1.49, seconds),
        claim_times("e", f"{MANY} samples by rays", 74.7 / 1.49, seconds),
        claim_same_leak(errors),
        claim_faster("d", "e", 74.7 / 41.3, seconds, f"{MANY} samples of a sphere"),
        claim_faster("h", "g", 27.5 / 12.6, seconds, f"{FEW} samples of a rectangle"),
        claim_rectangle(errors, FEW),
    ]
    caption = (
        f"Figure 6.16, {WHITE:g} times as bright, and below each picture its difference from the "
        f"truth, ±{SHOWN:g}; red is too dark, blue too bright."
    )
    shown = Picture("shading", draw_pictures(pictures, truths), caption)
    return Section("Shading", TEXT, claims, [table], [shown])


def get_letter(name):
    """Return the letter of a picture in Figure 6.16, or the name of another one."""
    return name.partition(",")[0]


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


def draw_pictures(pictures, truths):
    """Draw the pictures of Figure 6.16, the truths, and what is too bright or too dark in some."""
    shown = {
        "truth, a sphere": truths["sphere"],
        "a: Quílez": pictures["a"],
        "b: one march": pictures["b"],
        "c: rays for the share": pictures["c"],
        "d: samples by a march": pictures["d"],
        "e: samples by rays": pictures["e"],
        "truth, a rectangle": truths["rectangle"],
        "f: samples by a march": pictures["f"],
        "g: fewer, by rays": pictures["g"],
        "h: fewer, by a march": pictures["h"],
    }
    drawn = make_figure(9, 8.4)
    grid = drawn.subplots(4, 5)
    for i, (title, picture) in enumerate(shown.items()):
        truth = truths["sphere" if i < 6 else "rectangle"]
        above, below = grid[2 * (i // 5), i % 5], grid[2 * (i // 5) + 1, i % 5]
        above.imshow(np.clip(WHITE * picture, 0, 1) ** (1 / 2.2), cmap="gray", vmin=0, vmax=1)
        above.set_title(title, size=9)
        below.imshow(picture - truth, cmap="RdBu", vmin=-SHOWN, vmax=SHOWN)
        for axes in (above, below):
            axes.set_axis_off()
    return drawn
