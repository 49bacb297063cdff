"""How often `refine` is right with its own defaults, and whether it says so where it is not: 100
runs against known truths, some 20 minutes.

    python benchmarks/refining_runs.py [SCENE ...] [--samples N] [--seeds 0 1 ...] [-o runs.json]

Five scenes, four guesses of the width of a lobe, five seeds; pictures of 24 × 24 pixels have noise
of 1 %. A run is right if every number is within 3 of its own standard errors of the truth, and
warned if it did not converge, ended on a bound, or a note says that something is wrong. Each run is
a line; the last lines are the table that `docs/tools/make_refining.py` puts on its page.
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
RIGHT = 3  # standard errors
SEEDS = range(5)
WARNINGS = "are not noise", "not determined", "twice the samples"
RED, GREY, GREEN = (0.5, 0.15, 0.1), (0.3, 0.3, 0.3), (0.15, 0.4, 0.2)
WIDTHS = 0.5, 0.9, 0.05, 0.01  # guesses of a roughness

# Name → shape, light, model, the truth of what is searched, what else is known, the guesses
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


def scene(shape, light, model, values, size=SIZE):
    """The dictionary of a shape under a light, of a `model` with values, numbers or colours."""
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
        "small lamp": sphere_lamp(place, 0.05, 3000.0),
        "point light": {"type": "point", "position": place, "intensity": 30.0},
        "wide lamp": {"type": "rectangle", "to_world": wide, "emitter": lamp(20.0)},
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


def sphere_lamp(place, radius, radiance):
    """A lamp that is a ball."""
    return {"type": "sphere", "center": place, "radius": radius, "emitter": lamp(radiance)}


def lamp(radiance):
    """What makes a shape a lamp."""
    return {"type": "area", "radiance": radiance}


def photograph(name, size=SIZE, spp=2**16):
    """The picture of a scene at the truth."""
    import mitsuba as mi

    shape, light, model, truth, known, _ = SCENES[name]
    loaded = mi.load_dict(scene(shape, light, model, truth | known, size))
    return np.array(mi.render(loaded, spp=spp, seed=99), float)


def with_noise(picture, *seed):
    """A picture with noise in proportion."""
    rng = np.random.default_rng(seed)
    return picture * (1 + NOISE * rng.standard_normal(picture.shape))


def begin(name, guess, size=SIZE):
    """(the scene where a search begins, the names of what is searched)."""
    shape, light, model, truth, known, _ = SCENES[name]
    values = {k: (0.4, 0.4, 0.4) if np.ndim(v) else guess for k, v in truth.items()}
    return scene(shape, light, model, values | known, size), [f"ball.bsdf.{k}" for k in truth]


def judge(name, found):
    """(by how many of its standard errors the worst number is off; right, warned or silent)."""
    away = []
    for key, true in SCENES[name][3].items():
        error = np.asarray(found.standard_errors[f"ball.bsdf.{key}"])
        off = np.abs(np.asarray(found.values[f"ball.bsdf.{key}"]) - true)
        away.append(np.where(np.isfinite(error), off / np.where(error > 0, error, 1e-30), np.inf))
    off, said = float(np.max(np.hstack(away))), " ".join(found.notes)
    warned = not found.converged or found.at_bounds or any(words in said for words in WARNINGS)
    return off, "right" if off < RIGHT else "warned" if warned else "silent"


def run(names, seeds, samples):
    """A line, and a dictionary, for each run."""
    rows = []
    how = {} if samples is None else {"spp": samples}
    for name in names:
        clean = photograph(name)
        for number, guess in enumerate(SCENES[name][5]):
            for seed in seeds:
                start, searched = begin(name, guess)
                picture = with_noise(clean, number, seed)
                found = bk.refine(start, picture, parameters=searched, seed=seed, **how)
                off, verdict = judge(name, found)
                row = {"scene": name, "guess": guess, "seed": seed, "off": off, "ends": verdict}
                rows.append(row | {"width": found.values[searched[0]], "cost": found.cost})
                print(
                    f"{name:28} {guess:7g} {seed}  {found.values[searched[0]]:10.5g}  "
                    f"off {off:6.2f}  {found.seconds:5.1f} s {found.cost:7.0f}  "
                    f"loss {found.loss:.4f}  {verdict}",
                    flush=True,
                )
    return rows


def count(rows):
    """Cells of a table: for each scene, and for all, how many runs end how."""
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
    rows = run(given.scenes or list(SCENES), given.seeds, given.samples)
    for cells in count(rows):
        print(" | ".join(cells))
    given.output.write_text(json.dumps(rows, indent=0), encoding="utf-8")
    sys.exit(0)
