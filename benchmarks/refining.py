"""`refine` on five materials in a corner that throws light back, from random starts, and beside the
picture loss of `fit`: `python benchmarks/refining.py` prints the tables, in some ten minutes.

The truth is known, a picture of 24 × 24 pixels with noise of 1 % in proportion. A start is random
within the bounds of all parameters; it comes back if every number is within 3 of its own standard
errors of the truth.
"""

import sys
import time

import numpy as np

import brdfkit as bk
from brdfkit.jit.llvm import use_variant
from brdfkit.model import labels

STARTS, SIZE, NOISE = 20, 24, 0.01
GOLD, GREY = (0.5, 0.35, 0.15), (0.3, 0.3, 0.3)
TRUTHS = {
    "ggx": {"alpha_u": 0.25, "diffuse_reflectance": GREY, "specular_reflectance": GOLD},
    "ward": {"alpha_u": 0.15, "diffuse_reflectance": GOLD, "specular_reflectance": GREY},
    "ashikhmin_shirley": {
        "exponent_u": 60.0,
        "diffuse_reflectance": GREY,
        "specular_reflectance": GOLD,
    },
    "cook_torrance": {"alpha": 0.3, "diffuse_reflectance": GOLD, "specular_reflectance": GOLD},
    "oren_nayar": {"sigma": 0.5, "diffuse_reflectance": GOLD},
}


def corner(values, model, size=SIZE):
    """A ball of a `model` before a red wall, under a lamp."""
    import mitsuba as mi

    at = mi.ScalarTransform4f().look_at
    colours = {k: {"type": "rgb", "value": v} for k, v in values.items() if isinstance(v, tuple)}
    red = {"type": "rgb", "value": [0.7, 0.3, 0.2]}
    box = {"type": "box"}
    film = {"type": "hdrfilm", "width": size, "height": size, "pixel_format": "rgb"} | {
        "rfilter": box
    }
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 4},
        "sensor": {
            "type": "perspective",
            "fov": 26,
            "to_world": at([0, -4, 1.8], [0, 0, 0.7], [0, 0, 1]),
            "film": film,
        },
        "floor": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().scale(3),
            "bsdf": {"type": "diffuse", "reflectance": 0.6},
        },
        "wall": {
            "type": "rectangle",
            "to_world": at([0, 1.3, 1], [0, 0, 1], [0, 0, 1]).scale(3),
            "bsdf": {"type": "diffuse", "reflectance": red},
        },
        "ball": {
            "type": "sphere",
            "center": [0, 0, 0.7],
            "radius": 0.7,
            "bsdf": {"type": model, **values, **colours},
        },
        "lamp": {
            "type": "rectangle",
            "to_world": at([0.8, -1.2, 2.5], [0, 0, 0], [0, 1, 0]).scale(0.5),
            "emitter": {"type": "area", "radiance": 12.0},
        },
    }


def random_start(model, truth, rng):
    """Values of the parameters in `truth`, anywhere within their bounds; weights from 0 to 1."""
    found = {}
    for name in truth:
        declared = labels.model(model).parameters[name]
        low, high = declared.bounds
        if declared.linear:
            found[name] = tuple(map(float, rng.random(3)))
        elif declared.log:
            found[name] = float(low * (high / low) ** rng.random())
        else:
            found[name] = float(low + rng.random() * (high - low))
    return found


def come_back(model, starts):
    """A row of figures on refinements of a `model` from as many random `starts`."""
    import mitsuba as mi

    truth = TRUTHS[model]
    clean = np.array(mi.render(mi.load_dict(corner(truth, model)), spp=4096, seed=99))
    names = [f"ball.bsdf.{name}" for name in truth]
    back, z, steps, seconds, spps = 0, [], [], [], []
    for number in range(starts):
        rng = np.random.default_rng([number, len(model)])
        picture = clean * (1 + NOISE * rng.standard_normal(clean.shape))
        scene = corner(random_start(model, truth, rng), model)
        began = time.perf_counter()
        result = bk.refine(scene, picture, names, seed=10_000 * number)
        seconds.append(time.perf_counter() - began)
        away = [
            (np.asarray(result.values[name]) - truth[name.split(".")[-1]])
            / np.asarray(result.standard_errors[name])
            for name in names
        ]
        away = np.abs(np.hstack(away))
        back += bool((away < 3).all())
        z.append(away)
        steps.append(result.steps)
        spps.append(result.samples)
        if not (away < 3).all():
            print(f"  {model} {number}: {result.values}, {np.round(away, 1)}, {result.message}")
    z = np.array(z)
    rms = np.sqrt(np.nanmean(z**2))
    print(
        f"{model:18} {back:3} of {starts}   rms z {rms:.2f}   steps {np.mean(steps):.1f} "
        f"({max(steps)})   samples {np.median(spps):.0f}   {np.mean(seconds):.1f} s",
        flush=True,
    )


if __name__ == "__main__":
    use_variant()
    for name in sys.argv[2:] or TRUTHS:
        come_back(name, int(sys.argv[1]) if sys.argv[1:] else STARTS)
