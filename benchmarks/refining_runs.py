"""Measures how often `refine` is right with its defaults, and whether it warns when it is wrong.

    python benchmarks/refining_runs.py [SCENE ...] [--samples N] [--seeds 0 1 ...] [-o runs.json]

It makes 100 runs with known truths in some 20 minutes: five scenes, four guesses of the width of a
lobe, five seeds; pictures of 24 × 24 pixels have relative noise of 1 %. A run is right if every
number is within 3 of its own standard errors of the truth. It is warned if it did not converge,
ended on a bound, or has a note that something is wrong. A line is printed for each run; the last
lines are the table that `docs/tools/make_refining.py` puts on its page.
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np

import brdfkit as bk
from brdfkit.core.jit.llvm import use_variant
from brdfkit.rendering.scenes._meshes import make_grid_mesh
from brdfkit.rendering.scenes.knot import make_knot_tube

FILE = Path(__file__).with_suffix(".json")
SIZE, NOISE = 24, 0.01
RIGHT = 3  # largest error of a right run, in standard errors
SEEDS = range(5)
WARNINGS = "are not noise", "not determined", "twice the samples"
RED, GREY, GREEN = (0.5, 0.15, 0.1), (0.3, 0.3, 0.3), (0.15, 0.4, 0.2)
WIDTHS = 0.5, 0.9, 0.05, 0.01  # guesses of a roughness from which searches start

# By name: shape, light, model, true values of the searched parameters, known values, guesses
SCENES = {
    "plastic knot, small lamp": (
        "knot",
        "small lamp",
        "ggx",
        {"alpha_u": 0.18, "diffuse_reflectance": GREY},
        {"f0": 0.04, "specular_reflectance": (1.0, 1.0, 1.0)},
        WIDTHS,
    ),
    "metal ball, sun": (
        "ball",
        "sun",
        "ward",
        {"alpha_u": 0.1, "specular_reflectance": RED},
        {"diffuse_reflectance": (0.05, 0.05, 0.05)},
        WIDTHS,
    ),
    "ball in a corner, wide lamp": (
        "corner",
        "wide lamp",
        "ggx",
        {"alpha_u": 0.25, "diffuse_reflectance": GREEN, "specular_reflectance": RED},
        {"f0": 0.9},
        WIDTHS,
    ),
    "phong knot, sun and sky": (
        "knot",
        "sun and sky",
        "ashikhmin_shirley",
        {"exponent_u": 150.0, "diffuse_reflectance": GREEN, "specular_reflectance": GREY},
        {},
        (5.0, 30.0, 1000.0, 10_000.0),
    ),
    "narrow lobe, point light": (
        "ball",
        "point light",
        "cook_torrance",
        {"alpha": 0.06, "diffuse_reflectance": RED},
        {"f0": 0.1, "specular_reflectance": (1.0, 1.0, 1.0)},
        WIDTHS,
    ),
}


def make_scene(shape, light, model, values, size=SIZE):
    """Return the Mitsuba scene of a shape under a light.

    `values`: numbers or colours of the `model`'s parameters; `size`: side of the picture [pixels].
    """
    import mitsuba as mi

    colours = {k: {"type": "rgb", "value": list(v)} for k, v in values.items() if np.ndim(v)}
    bsdf, at = {"type": model, **values, **colours}, mi.ScalarTransform4f
    ball = {"type": "sphere", "center": [0, 0, 0.9], "radius": 0.9, "bsdf": bsdf}
    place = [1.5, -3, 4]
    walls = {
        "floor": {"type": "rectangle", "to_world": at().scale(4), "bsdf": {"type": "diffuse"}},
        "wall": {
            "type": "rectangle",
            "to_world": at().look_at([0, 1.3, 1], [0, 0, 1], [0, 0, 1]).scale(4),
            "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.7, 0.3, 0.2]}},
        },
    }
    shapes = {"ball": {"ball": ball}, "corner": {"ball": ball, **walls}}
    sun = {"type": "directional", "direction": [-0.4, 0.6, -1], "irradiance": 3.0}
    wide = at().look_at(place, [0, 0, 0.8], [0, 1, 0]).scale(0.6)
    lights = {
        "small lamp": make_sphere_lamp(place, 0.05, 3000.0),
        "point light": {"type": "point", "position": place, "intensity": 30.0},
        "wide lamp": {"type": "rectangle", "to_world": wide, "emitter": make_emitter(20.0)},
        "sun": sun,
        "sun and sky": sun,
    }
    seen = shapes[shape] if shape in shapes else {"ball": make_grid_mesh(*make_knot_tube(), bsdf)}
    sky = {"sky": {"type": "constant", "radiance": 0.3}} if light == "sun and sky" else {}
    film = {"type": "hdrfilm", "width": size, "height": size, "pixel_format": "rgb"}
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 4},
        "sensor": {
            "type": "perspective",
            "fov": 28,
            "to_world": at().look_at([0, -5, 2.2], [0, 0, 0.9], [0, 0, 1]),
            "film": {**film, "rfilter": {"type": "box"}},
        },
        "lamp": lights[light],
        **seen,
        **sky,
    }


def make_sphere_lamp(place, radius, radiance):
    """Return a lamp in the shape of a ball."""
    return {"type": "sphere", "center": place, "radius": radius, "emitter": make_emitter(radiance)}


def make_emitter(radiance):
    """Return the emitter that makes a shape a lamp."""
    return {"type": "area", "radiance": radiance}


def render_truth(name, size=SIZE, spp=2**16):
    """Return the picture of a scene with the true values, almost without noise."""
    import mitsuba as mi

    shape, light, model, truth, known, _ = SCENES[name]
    loaded = mi.load_dict(make_scene(shape, light, model, truth | known, size))
    return np.array(mi.render(loaded, spp=spp, seed=99), float)


def add_noise(picture, *seed):
    """Return a picture with relative noise."""
    rng = np.random.default_rng(seed)
    return picture * (1 + NOISE * rng.standard_normal(picture.shape))


def make_start(name, guess, size=SIZE):
    """Return the scene at which a search starts, and the names of the searched parameters."""
    shape, light, model, truth, known, _ = SCENES[name]
    values = {k: (0.4, 0.4, 0.4) if np.ndim(v) else guess for k, v in truth.items()}
    return make_scene(shape, light, model, values | known, size), [f"ball.bsdf.{k}" for k in truth]


def judge_run(name, found):
    """Return the largest error of a run in standard errors, and its outcome.

    The outcome is "right", "warned" (wrong with a warning) or "silent" (wrong without one).
    """
    away = []
    for key, true in SCENES[name][3].items():
        error = np.asarray(found.standard_errors[f"ball.bsdf.{key}"])
        off = np.abs(np.asarray(found.values[f"ball.bsdf.{key}"]) - true)
        away.append(np.where(np.isfinite(error), off / np.where(error > 0, error, 1e-30), np.inf))
    off, said = float(np.max(np.hstack(away))), " ".join(found.notes)
    warned = not found.converged or found.at_bounds or any(words in said for words in WARNINGS)
    return off, "right" if off < RIGHT else "warned" if warned else "silent"


def run_searches(names, seeds, samples):
    """Make all runs, print a line for each, and return a dictionary for each."""
    rows = []
    how = {} if samples is None else {"spp": samples}
    for name in names:
        clean = render_truth(name)
        for number, guess in enumerate(SCENES[name][5]):
            for seed in seeds:
                start, searched = make_start(name, guess)
                picture = add_noise(clean, number, seed)
                found = bk.refine(start, picture, parameters=searched, seed=seed, **how)
                off, verdict = judge_run(name, found)
                row = {"scene": name, "guess": guess, "seed": seed, "off": off, "ends": verdict}
                rows.append(row | {"width": found.values[searched[0]], "cost": found.cost})
                print(
                    f"{name:28} {guess:7g} {seed}  {found.values[searched[0]]:10.5g}  "
                    f"off {off:6.2f}  {found.seconds:5.1f} s {found.cost:7.0f}  "
                    f"loss {found.loss:.4f}  {verdict}",
                    flush=True,
                )
    return rows


def count_outcomes(rows):
    """Return the cells of a table with the outcomes of runs, for each scene and for all."""
    cells = []
    for name in (*dict.fromkeys(row["scene"] for row in rows), "all"):
        own = [row for row in rows if name in (row["scene"], "all")]
        ends = [sum(row["ends"] == end for row in own) for end in ("right", "warned", "silent")]
        far = max(row["off"] for row in own)
        cost = np.median([row["cost"] for row in own])
        cells.append((name, str(len(own)), *map(str, ends), f"{far:.1f}", f"{cost:.0f}"))
    return cells


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    parser.add_argument("--samples", type=int)
    parser.add_argument("--seeds", type=int, nargs="+", default=list(SEEDS))
    parser.add_argument("-o", "--output", type=Path, default=FILE)
    given = parser.parse_args()
    use_variant()
    rows = run_searches(given.scenes or list(SCENES), given.seeds, given.samples)
    for cells in count_outcomes(rows):
        print(" | ".join(cells))
    given.output.write_text(json.dumps(rows, indent=0), encoding="utf-8")
    sys.exit(0)
