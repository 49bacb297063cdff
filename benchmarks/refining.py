"""Compares results of `refine` with known truths.

    python benchmarks/refining.py [TABLE ...]

It prints the tables `gradients`, `steps`, `bounces` and `starts`; the last one takes some twenty
minutes. `starts`: five materials in a corner with indirect light, from random starts within the
bounds of all parameters; pictures of 24 × 24 pixels have relative noise of 1 %. A start succeeds if
every number is within 3 of its own standard errors of the truth. `bounces`: measured materials,
which no model meets exactly, compared with fits by the loss "picture".
"""

import sys
import time

import numpy as np

import brdfkit as bk
from brdfkit.core.jit.llvm import use_variant
from brdfkit.inverse.scenes.problem.parameters import choose_unknowns
from brdfkit.inverse.scenes.problem.scene import load_scene, make_integrator
from brdfkit.inverse.scenes.problem.targets import read_targets
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.search.forward_derivatives import (
    compute_derivatives,
    group_numbers_by_picture,
)
from brdfkit.inverse.scenes.search.normal_equations import Equations, Residuals
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
FRONT, SIDE = ([0, -4, 1.8], [0.8, -1.2, 2.5]), ([-2.4, -3.2, 1.2], [-0.6, -1.6, 2.6])


def make_bsdf(model, values):
    """Return the Mitsuba dictionary of a `model`; `values`: numbers or colours by parameter."""
    colours = {k: {"type": "rgb", "value": v} for k, v in values.items() if isinstance(v, tuple)}
    return {"type": model, **values, **colours}


def make_corner(material, size=SIZE, depth=4, view=FRONT):
    """Return a scene of a ball before a red wall; `view`: positions of camera and lamp."""
    import mitsuba as mi

    at, (camera, lamp) = mi.ScalarTransform4f().look_at, view
    film = {"type": "hdrfilm", "width": size, "height": size, "pixel_format": "rgb"}
    red = {"type": "rgb", "value": [0.7, 0.3, 0.2]}
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": depth},
        "sensor": {
            "type": "perspective",
            "fov": 26,
            "to_world": at(camera, [0, 0, 0.7], [0, 0, 1]),
            "film": {**film, "rfilter": {"type": "box"}},
        },
        "floor": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().scale(3),
            "bsdf": {"type": "diffuse", "reflectance": 0.6},
        },
        "wall": {
            "type": "rectangle",
            "to_world": at([0, 0.8, 1], [0, 0, 1], [0, 0, 1]).scale(3),
            "bsdf": {"type": "diffuse", "reflectance": red},
        },
        "ball": {"type": "sphere", "center": [0, 0, 0.7], "radius": 0.7, "bsdf": material},
        "lamp": {
            "type": "rectangle",
            "to_world": at(lamp, [0, 0, 0], [0, 1, 0]).scale(0.5),
            "emitter": {"type": "area", "radiance": 12.0},
        },
    }


def render_picture(scene, spp=4096):
    """Return the picture (height, width, 3) of a scene."""
    import mitsuba as mi

    return np.array(mi.render(mi.load_dict(scene), spp=spp, seed=99), float)


def make_views(model, truth, reached, size=SIZE):
    """Return the `Views` of the scene at the truth, to compare with the picture `reached`."""
    import mitsuba as mi

    scene = load_scene(make_corner(make_bsdf(model, truth), size), (size, size))
    names = mi.traverse(scene)
    unknowns = choose_unknowns(names, [f"ball.bsdf.{name}" for name in truth])
    return Views(scene, make_integrator(scene), read_targets(reached), names, unknowns)


def compare_gradients():
    """Print the ratios of derivatives to finite differences of the same samples."""
    print("derivatives over differences of the same samples, by tangent")
    spp, step = 8192, 0.01
    for model, truth in TRUTHS.items():
        views = make_views(model, truth, render_picture(make_corner(make_bsdf(model, truth)), 256))
        x, shares = views.start, {}
        found = compute_derivatives(views, x, spp, 3)
        for group in group_numbers_by_picture(views):
            moved = np.zeros(len(x))
            moved[group] = step
            ends = [views.render_residuals(x + sign * moved, spp, 3) for sign in (1, -1)]
            expected = (ends[0] - ends[1]) / (2 * step)
            share = (found[group].sum(axis=0) * expected).sum() / (expected**2).sum()
            shares[views.names[group[0]].split(".")[-1]] = f"{share:.4f}"
        print(f"{model:18} {shares}", flush=True)


def time_steps():
    """Print the time of a search step over the time of a picture with as many samples."""
    print("the time of a step, over that of a picture of as many samples")
    size, spp = 128, 128
    for model, truth in TRUTHS.items():
        views = make_views(
            model, truth, render_picture(make_corner(make_bsdf(model, truth), size), 64), size
        )
        seconds = []
        for _ in range(3):  # the first run compiles the kernels
            times = [time.perf_counter()]
            views.render_residuals(views.start, spp, 7)
            times.append(time.perf_counter())
            here = Residuals.render(views, views.start, spp, 8)
            times.append(time.perf_counter())
            Equations.render(views, here, 8)
            times.append(time.perf_counter())
            seconds.append(np.diff(times))
        one, trial, slopes = np.min(seconds[1:], axis=0)
        searched = len(list(group_numbers_by_picture(views)))
        print(
            f"{model:18} {(trial + slopes) / one:.2f}  ({searched} derivatives "
            f"{slopes / one:.2f}, trial {trial / one:.2f}; a picture {one:.2f} s)",
            flush=True,
        )


def to_screen(pixels, white):
    """Return linear pixels on the tone curve of sRGB; `white`: the value that becomes 1."""
    x = np.clip(pixels / white, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def compare_bounces():
    """Print the PSNR [dB] of a ggx that was found in three ways.

    It is evaluated on the picture that `refine` used, and on one with another camera and lamp.
    """
    print("PSNR [dB] as a screen shows it, of the picture that refine saw / under another light")
    for name in ("satin_plastic", "car_paint", "blasted_gold"):
        measured = bk.load(name)
        by_picture = bk.fit(measured, "ggx", loss="picture")
        for said, depth in (("direct light", 2), ("light bounces", 6)):
            truth = [
                render_picture(make_corner(measured.scene_dict(), 48, depth, v))
                for v in (FRONT, SIDE)
            ]
            found = {'fit, "picture"': by_picture}
            for how, assumed in (("refine, direct light", 2), ("refine", depth)):
                begin = make_corner(make_bsdf("ggx", by_picture.values), 48, assumed)
                found[how] = bk.refine(begin, truth[0], starts=1, spp=512).fit
            row = []
            for how, fit in found.items():
                pair = []
                for view, known in zip((FRONT, SIDE), truth, strict=True):
                    own = render_picture(
                        make_corner(make_bsdf("ggx", fit.values), 48, depth, view), 1024
                    )
                    white = np.quantile(known, 0.99)
                    error = np.mean((to_screen(own, white) - to_screen(known, white)) ** 2)
                    pair.append(-10 * np.log10(error))
                row.append(f"{how}: {pair[0]:.1f} / {pair[1]:.1f}")
            print(f"{name:15} {said:14} {'   '.join(row)}", flush=True)


def draw_start(model, truth, rng):
    """Return random values of the parameters in `truth` within their bounds, weights up to 1."""
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


def count_recoveries():
    """Print how many random starts reach the truth; z: errors over standard errors."""
    print("random starts that come back within 3 standard errors")
    for model, truth in TRUTHS.items():
        clean, names = (
            render_picture(make_corner(make_bsdf(model, truth))),
            [f"ball.bsdf.{name}" for name in truth],
        )
        away, results = [], []
        for number in range(STARTS):
            rng = np.random.default_rng([number, len(model)])
            noisy = clean * (1 + NOISE * rng.standard_normal(clean.shape))
            scene = make_corner(make_bsdf(model, draw_start(model, truth, rng)))
            result = bk.refine(scene, noisy, parameters=names, seed=10_000 * number)
            results.append(result)
            away.append(
                np.hstack(
                    [
                        (np.asarray(result.values[name]) - truth[name.split(".")[-1]])
                        / np.asarray(result.standard_errors[name])
                        for name in names
                    ]
                )
            )
            if not (np.abs(away[-1]) < 3).all():
                print(f"  {number}: {result.values}, {np.round(away[-1], 1)}, {result.message}")
        back = (np.abs(away) < 3).all(axis=1).sum()
        counts = [result.steps for result in results]
        print(
            f"{model:18} {back} of {STARTS}   z {np.sqrt(np.nanmean(np.square(away))):.2f} (RMS)   "
            f"{np.mean(counts):.1f} steps, at most {max(counts)}   "
            f"{np.mean([result.seconds for result in results]):.1f} s",
            flush=True,
        )


if __name__ == "__main__":
    use_variant()
    for table in sys.argv[1:] or ("gradients", "steps", "bounces", "starts"):
        {
            "gradients": compare_gradients,
            "steps": time_steps,
            "bounces": compare_bounces,
            "starts": count_recoveries,
        }[table]()
