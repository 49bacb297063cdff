# ruff: noqa: I001, for brdfkit comes first: it chooses the LLVM that Dr.Jit loads
"""Makes `docs/refining.md` and its picture: fits of tables, refined on pictures.

    python docs/tools/make_refining.py    # minutes on two cores

Measured materials are rendered in a room with indirect light, and on a ball under direct light
alone. Models are fitted to the measured tables by the loss "picture", refined on one picture of
each scene, and compared in another picture, from a camera that no search used. The text of the page
is in `refining_page.py`.
"""

import sys
import time
from itertools import product

import brdfkit as bk
import drjit as dr
import mitsuba as mi
import numpy as np
import refining_page as page

from brdfkit.core.jit.llvm import use_variant
from brdfkit.images.errors.flip import flip
from brdfkit.images.errors.psnr import psnr
from brdfkit.rendering.scenes._studio import make_camera
from brdfkit.rendering.scenes.ball import ball
from brdfkit.rendering.scenes.cornell_box import cornell_box

MATERIALS = "plaster", "red_plastic", "blasted_gold"
MODELS = "ggx", "cook_torrance"
SIZE, SPP, SAMPLES = 48, 1024, 256
# By name: the function of the scene, the depth of its paths, and a camera that no search uses
SCENES = {
    "room": (cornell_box, 6, ((1.2, -8.6, 2.9), (-0.1, 0, 1.5), 28)),
    "ball": (ball, 2, ((-6.0, -5.0, 2.2), (0, 0, 0.96), 19.8)),
}
SHOWN = "blasted_gold", "ggx", "room"
# Sides of pictures [pixels], and samples per pixel, whose times are measured
SIDES, COUNTS = (32, 64, 128, 256), (128, 256, 1024)
# Settings of Adam: learning rate, number of batches, steps in a batch, samples per pixel in a step
RATE, BATCHES, BATCH, PER_STEP = 0.05, 8, 25, 16


def make_scene(scene, bsdf, size=SIZE):
    """Return the Mitsuba dictionary of a scene whose objects share one BSDF, with two cameras."""
    function, depth, held_out = SCENES[scene]
    entries = {"type": "scene", "material": {**bsdf, "id": "material"}}
    entries |= function({"type": "ref", "id": "material"}, (size, size))
    entries["integrator"] = {"type": "path", "max_depth": depth}
    entries["held_out"] = make_camera(*held_out, (size, size))
    return entries


def render_both_cameras(entries, spp=SPP, seed=7):
    """Return the pictures of both cameras, the one for searches first."""
    scene = mi.load_dict(entries)
    return [np.array(mi.render(scene, sensor=i, spp=spp, seed=seed), float) for i in (0, 1)]


def remove_held_out_camera(entries):
    """Return a scene without the camera that no search uses."""
    return {name: entry for name, entry in entries.items() if name != "held_out"}


def compute_errors(truth, found):
    """Return the errors (PSNR [dB], FLIP) in the picture of the camera that no search uses."""
    everywhere = np.ones(truth[1].shape[:2], bool)
    return psnr(truth[1], found[1]), flip(truth[1], found[1], everywhere)


def compare_with_fits():
    """Return a row of errors for each material, model and scene, and the pictures for the page."""
    rows, shown = [], None
    for material, model, scene in product(MATERIALS, MODELS, SCENES):
        measured = bk.load(material)
        fit = bk.fit(measured, model, loss="picture")
        truth = render_both_cameras(make_scene(scene, measured.scene_dict()), seed=1)
        refined = bk.refine(
            remove_held_out_camera(make_scene(scene, fit.scene_dict())),
            truth[0],
            spp=SAMPLES,
            starts=1,
        )
        ends = [
            render_both_cameras(make_scene(scene, one.scene_dict())) for one in (fit, refined.fit)
        ]
        noise = compute_errors(
            truth, render_both_cameras(make_scene(scene, measured.scene_dict()), seed=2)
        )
        rows.append(
            {
                "material": material,
                "model": model,
                "scene": scene,
                "fit": compute_errors(truth, ends[0]),
                "refined": compute_errors(truth, ends[1]),
                "noise": noise,
                "steps": refined.steps,
                "seconds": refined.seconds,
            }
        )
        print(rows[-1], file=sys.stderr, flush=True)
        if (material, model, scene) == SHOWN:
            shown = {"truth": truth, "fitted": ends[0], "refined": ends[1]}
    return rows, shown


def race_with_adam():
    """Compare Adam and `refine` on the same picture of a metal, from the same start.

    Return pairs (seconds, largest relative error of a parameter): a list of them for Adam, and one
    for `refine`. Times are without compilation.
    """
    truth, start = make_metal(0.3, (0.5, 0.35, 0.2)), make_metal(0.6, (0.5, 0.5, 0.5))
    picture = render_both_cameras(make_scene("room", truth))[0]
    picture *= 1 + 0.01 * np.random.default_rng(0).standard_normal(picture.shape)
    names = ["alpha_u", "specular_reflectance"]

    def compute_largest_error(values):
        """Return the largest relative error of the parameters' values."""
        pairs = [(values[name], true) for name, true in (("alpha_u", 0.3), COLOUR)]
        return max(np.abs(np.ravel(v) / np.ravel(true) - 1).max() for v, true in pairs)

    results = []
    for _ in range(2):  # the first run compiles the kernels
        entries = remove_held_out_camera(make_scene("room", start))
        paths = [f"{find_material_name(entries)}.{name}" for name in names]
        result = bk.refine(entries, picture, parameters=paths, spp=SAMPLES, starts=1)
        results.append((result.seconds, compute_largest_error(result.fit.values)))
    return run_adam(start, picture, names, compute_largest_error), results[-1]


def measure_times():
    """Measure the times of `refine` for pictures of several sizes.

    Return rows (side of the picture, samples per pixel, seconds, relative standard error of the
    roughness) for the metal of `race_with_adam`.
    """
    truth, start = make_metal(0.3, (0.5, 0.35, 0.2)), make_metal(0.6, (0.5, 0.5, 0.5))
    rows = []
    for side in SIDES:
        picture = render_both_cameras(make_scene("room", truth, side))[0]
        picture *= 1 + 0.01 * np.random.default_rng(0).standard_normal(picture.shape)
        entries = remove_held_out_camera(make_scene("room", start, side))
        alpha, colour = (f"{find_material_name(entries)}.{name}" for name in ("alpha_u", COLOUR[0]))
        for samples in (64, *COUNTS):  # the first run compiles the kernels
            found = bk.refine(entries, picture, parameters=[alpha, colour], spp=samples)
            relative = found.standard_errors[alpha] / found.values[alpha]
            rows.append((side, samples, found.seconds, relative))
            print(rows[-1], file=sys.stderr, flush=True)
    return [row for row in rows if row[1] in COUNTS]


COLOUR = "specular_reflectance", (0.5, 0.35, 0.2)


def make_metal(roughness, colour):
    """Return the Mitsuba dictionary of a metal with a roughness and a colour."""
    colours = {"specular_reflectance": colour, "diffuse_reflectance": (0.05, 0.05, 0.05)}
    return {
        "type": "ggx",
        "alpha_u": roughness,
        "f0": 0.9,
        **{name: {"type": "rgb", "value": list(value)} for name, value in colours.items()},
    }


def find_material_name(entries):
    """Return the name of the material in `mitsuba.traverse` of a scene."""
    keys = mi.traverse(mi.load_dict(entries, optimize=False)).keys()
    return next(key for key in keys if key.endswith("alpha_u.value")).rsplit(".", 2)[0]


def run_adam(start, picture, names, compute_error):
    """Return pairs (seconds, error) of Adam after each batch of steps.

    `start`: the material to begin with; `picture`: the picture to match; `names`: names of the
    searched parameters; `compute_error`: a function from their values to the error.
    """
    entries = remove_held_out_camera(make_scene("room", start)) | {
        "integrator": {"type": "prb", "max_depth": 6}
    }
    scene = mi.load_dict(entries, optimize=False)
    parameters, target = mi.traverse(scene), mi.TensorXf(picture)
    keys = {name: f"{find_material_name(entries)}.{name}.value" for name in names}
    optimiser = mi.ad.Adam(lr=RATE, params={key: parameters[key] for key in keys.values()})
    parameters.update(optimiser)
    seconds, found = 0.0, []
    for batch in range(BATCHES):
        began = time.perf_counter()
        optimiser.set_learning_rate(RATE * (1 - batch / BATCHES))
        for step in range(BATCH):
            seed = BATCH * batch + step
            rendered = mi.render(scene, parameters, spp=PER_STEP, seed=seed)
            dr.backward(dr.mean(dr.square((rendered - target) / (target + 0.05)), axis=None))
            optimiser.step()
            for key in keys.values():
                optimiser[key] = dr.maximum(optimiser[key], 0.02)
            parameters.update(optimiser)
        values = {name: np.ravel(parameters[key]) for name, key in keys.items()}
        seconds += time.perf_counter() - began
        found.append((seconds, compute_error(values)))
    return found


def main():
    """Make all measurements, and write the page."""
    use_variant()
    mi.set_log_level(mi.LogLevel.Error)  # samplers warn that they round up
    by_adam, by_refine = race_with_adam()
    print(by_adam, by_refine, file=sys.stderr)
    page.write_page(*compare_with_fits(), by_adam, by_refine, measure_times(), SIZE, SAMPLES)
    return 0


if __name__ == "__main__":
    sys.exit(main())
