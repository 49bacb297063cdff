# ruff: noqa: I001, for brdfkit comes first: it chooses the LLVM that Dr.Jit loads
"""Makes `docs/refining.md` and its picture: fits of tables, refined on pictures.

    python docs/tools/make_refining.py    # minutes on two cores

Measured materials are rendered as they are, in a room that throws light back, and on a ball under
direct light alone. Models are fitted to the tables by the loss "picture", refined on one picture of
each scene, and held against another, from a camera that no search saw. The words are in
`refining_page.py`.
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
# Name → the scene, its depth of paths, and a camera that no search sees
SCENES = {
    "room": (cornell_box, 6, ((1.2, -8.6, 2.9), (-0.1, 0, 1.5), 28)),
    "ball": (ball, 2, ((-6.0, -5.0, 2.2), (0, 0, 0.96), 19.8)),
}
SHOWN = "blasted_gold", "ggx", "room"
SIDES, COUNTS = (32, 64, 128, 256), (128, 256, 1024)  # of pictures, and samples, that are timed
RATE, BATCHES, BATCH, PER_STEP = 0.05, 8, 25, 16  # of Adam: 8 times 25 steps of 16 samples


def load(scene, bsdf, size=SIZE):
    """The Mitsuba scene of a name, whose things share one BSDF, with two cameras."""
    function, depth, held_out = SCENES[scene]
    entries = {"type": "scene", "material": {**bsdf, "id": "material"}}
    entries |= function({"type": "ref", "id": "material"}, (size, size))
    entries["integrator"] = {"type": "path", "max_depth": depth}
    entries["held_out"] = make_camera(*held_out, (size, size))
    return entries


def pictures(entries, spp=SPP, seed=7):
    """What both cameras see."""
    scene = mi.load_dict(entries)
    return [np.array(mi.render(scene, sensor=i, spp=spp, seed=seed), float) for i in (0, 1)]


def one_camera(entries):
    """The same scene without the camera that no search sees."""
    return {name: entry for name, entry in entries.items() if name != "held_out"}


def errors(truth, found):
    """(PSNR [dB], FLIP) of what the held-out camera sees."""
    everywhere = np.ones(truth[1].shape[:2], bool)
    return psnr(truth[1], found[1]), flip(truth[1], found[1], everywhere)


def compare():
    """Rows of figures, and the pictures that are shown."""
    rows, shown = [], None
    for material, model, scene in product(MATERIALS, MODELS, SCENES):
        measured = bk.load(material)
        fit = bk.fit(measured, model, loss="picture")
        truth = pictures(load(scene, measured.scene_dict()), seed=1)
        refined = bk.refine(
            one_camera(load(scene, fit.scene_dict())), truth[0], spp=SAMPLES, starts=1
        )
        ends = [pictures(load(scene, one.scene_dict())) for one in (fit, refined.fit)]
        noise = errors(truth, pictures(load(scene, measured.scene_dict()), seed=2))
        rows.append(
            {
                "material": material,
                "model": model,
                "scene": scene,
                "fit": errors(truth, ends[0]),
                "refined": errors(truth, ends[1]),
                "noise": noise,
                "steps": refined.steps,
                "seconds": refined.seconds,
            }
        )
        print(rows[-1], file=sys.stderr, flush=True)
        if (material, model, scene) == SHOWN:
            shown = {"truth": truth, "fitted": ends[0], "refined": ends[1]}
    return rows, shown


def race():
    """Adam and `refine` on the same picture of a known ggx: (seconds, largest relative error of a
    number) as they go, both from the same start, compiled before."""
    truth, start = known(0.3, (0.5, 0.35, 0.2)), known(0.6, (0.5, 0.5, 0.5))
    picture = pictures(load("room", truth))[0]
    picture *= 1 + 0.01 * np.random.default_rng(0).standard_normal(picture.shape)
    names = ["alpha_u", "specular_reflectance"]

    def off(values):
        pairs = [(values[name], true) for name, true in (("alpha_u", 0.3), COLOUR)]
        return max(np.abs(np.ravel(v) / np.ravel(true) - 1).max() for v, true in pairs)

    results = []
    for _ in range(2):  # the first compiles
        entries = one_camera(load("room", start))
        paths = [f"{owner(entries)}.{name}" for name in names]
        result = bk.refine(entries, picture, parameters=paths, spp=SAMPLES, starts=1)
        results.append((result.seconds, off(result.fit.values)))
    return adam(start, picture, names, off), results[-1]


def timings():
    """(side, samples, seconds, relative standard error of the roughness) of `refine`, for the
    metal of the race, in pictures of several sizes."""
    truth, start = known(0.3, (0.5, 0.35, 0.2)), known(0.6, (0.5, 0.5, 0.5))
    rows = []
    for side in SIDES:
        picture = pictures(load("room", truth, side))[0]
        picture *= 1 + 0.01 * np.random.default_rng(0).standard_normal(picture.shape)
        entries = one_camera(load("room", start, side))
        alpha, colour = (f"{owner(entries)}.{name}" for name in ("alpha_u", COLOUR[0]))
        for samples in (64, *COUNTS):  # the first compiles
            found = bk.refine(entries, picture, parameters=[alpha, colour], spp=samples)
            relative = found.standard_errors[alpha] / found.values[alpha]
            rows.append((side, samples, found.seconds, relative))
            print(rows[-1], file=sys.stderr, flush=True)
    return [row for row in rows if row[1] in COUNTS]


COLOUR = "specular_reflectance", (0.5, 0.35, 0.2)


def known(roughness, colour):
    """The dictionary of a metal."""
    colours = {"specular_reflectance": colour, "diffuse_reflectance": (0.05, 0.05, 0.05)}
    return {
        "type": "ggx",
        "alpha_u": roughness,
        "f0": 0.9,
        **{name: {"type": "rgb", "value": list(value)} for name, value in colours.items()},
    }


def owner(entries):
    """The name that Mitsuba gives the material."""
    keys = mi.traverse(mi.load_dict(entries, optimize=False)).keys()
    return next(key for key in keys if key.endswith("alpha_u.value")).rsplit(".", 2)[0]


def adam(start, picture, names, off):
    """(seconds, error) of Adam after each batch of steps."""
    entries = one_camera(load("room", start)) | {"integrator": {"type": "prb", "max_depth": 6}}
    scene = mi.load_dict(entries, optimize=False)
    parameters, target = mi.traverse(scene), mi.TensorXf(picture)
    keys = {name: f"{owner(entries)}.{name}.value" for name in names}
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
        found.append((seconds, off(values)))
    return found


def main():
    """Measure, and write the page."""
    use_variant()
    mi.set_log_level(mi.LogLevel.Error)  # samplers say that they round up
    by_adam, by_refine = race()
    print(by_adam, by_refine, file=sys.stderr)
    page.write(*compare(), by_adam, by_refine, timings(), SIZE, SAMPLES)
    return 0


if __name__ == "__main__":
    sys.exit(main())
