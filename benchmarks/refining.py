"""`refine` held against known truths: `python benchmarks/refining.py [TABLE ...]` prints the tables
`gradients`, `steps`, `bounces` and `starts`, the last in some twenty minutes.

`starts`: five materials in a corner that throws light back, from random starts within the bounds of
all that is searched; pictures of 24 × 24 pixels have noise of 1 % in proportion. A start comes back
if every number is within 3 of its own standard errors of the truth. `bounces`: measured materials,
which no model is quite, beside fits by the loss "picture".
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
from brdfkit.inverse.scenes.search.forward_derivatives import compute_derivatives, group_tangents
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


def bsdf(model, values):
    """The dictionary of a `model` with values, numbers or colours."""
    colours = {k: {"type": "rgb", "value": v} for k, v in values.items() if isinstance(v, tuple)}
    return {"type": model, **values, **colours}


def corner(material, size=SIZE, depth=4, view=FRONT):
    """A ball of a `material` before a red wall, under a lamp; `view`: where camera and lamp are."""
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


def picture(scene, spp=4096):
    """A scene's picture (height, width, 3)."""
    import mitsuba as mi

    return np.array(mi.render(mi.load_dict(scene), spp=spp, seed=99), float)


def views_of(model, truth, reached, size=SIZE):
    """`Views` of the corner at the truth, beside the picture that is `reached`."""
    import mitsuba as mi

    scene = load_scene(corner(bsdf(model, truth), size), (size, size))
    names = mi.traverse(scene)
    unknowns = choose_unknowns(names, [f"ball.bsdf.{name}" for name in truth])
    return Views(scene, make_integrator(scene), read_targets(reached), names, unknowns)


def gradients():
    """Derivatives beside differences of the same samples, along the pictures of differences."""
    print("derivatives over differences of the same samples, by tangent")
    spp, step = 8192, 0.01
    for model, truth in TRUTHS.items():
        views = views_of(model, truth, picture(corner(bsdf(model, truth)), 256))
        x, shares = views.start, {}
        found = compute_derivatives(views, x, spp, 3)
        for group in group_tangents(views):
            moved = np.zeros(len(x))
            moved[group] = step
            ends = [views.render_residuals(x + sign * moved, spp, 3) for sign in (1, -1)]
            expected = (ends[0] - ends[1]) / (2 * step)
            share = (found[group].sum(axis=0) * expected).sum() / (expected**2).sum()
            shares[views.names[group[0]].split(".")[-1]] = f"{share:.4f}"
        print(f"{model:18} {shares}", flush=True)


def steps():
    """The time of a step, derivatives and the trial, in pictures of as many samples."""
    print("the time of a step, over that of a picture of as many samples")
    size, spp = 128, 128
    for model, truth in TRUTHS.items():
        views = views_of(model, truth, picture(corner(bsdf(model, truth), size), 64), size)
        seconds = []
        for _ in range(3):  # the first compiles
            times = [time.perf_counter()]
            views.render_residuals(views.start, spp, 7)
            times.append(time.perf_counter())
            here = Residuals.at(views, views.start, spp, 8)
            times.append(time.perf_counter())
            Equations.at(views, here, 8)
            times.append(time.perf_counter())
            seconds.append(np.diff(times))
        one, trial, slopes = np.min(seconds[1:], axis=0)
        searched = len(list(group_tangents(views)))
        print(
            f"{model:18} {(trial + slopes) / one:.2f}  ({searched} derivatives "
            f"{slopes / one:.2f}, trial {trial / one:.2f}; a picture {one:.2f} s)",
            flush=True,
        )


def shown(pixels, white):
    """Pixels as a screen shows them, by sRGB's curve."""
    x = np.clip(pixels / white, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def bounces():
    """PSNR [dB] of a ggx, found three ways: on the picture that `refine` saw, and from the side."""
    print("PSNR [dB] as a screen shows it, of the picture that refine saw / under another light")
    for name in ("satin_plastic", "car_paint", "blasted_gold"):
        measured = bk.load(name)
        by_picture = bk.fit(measured, "ggx", loss="picture")
        for said, depth in (("direct light", 2), ("light bounces", 6)):
            truth = [picture(corner(measured.scene_dict(), 48, depth, v)) for v in (FRONT, SIDE)]
            found = {'fit, "picture"': by_picture}
            for how, assumed in (("refine, direct light", 2), ("refine", depth)):
                begin = corner(bsdf("ggx", by_picture.values), 48, assumed)
                found[how] = bk.refine(begin, truth[0], starts=1, spp=512).fit
            row = []
            for how, fit in found.items():
                pair = []
                for view, known in zip((FRONT, SIDE), truth, strict=True):
                    own = picture(corner(bsdf("ggx", fit.values), 48, depth, view), 1024)
                    white = np.quantile(known, 0.99)
                    error = np.mean((shown(own, white) - shown(known, white)) ** 2)
                    pair.append(-10 * np.log10(error))
                row.append(f"{how}: {pair[0]:.1f} / {pair[1]:.1f}")
            print(f"{name:15} {said:14} {'   '.join(row)}", flush=True)


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


def starts():
    """How many random starts come back to the truth; z: errors over standard errors."""
    print("random starts that come back within 3 standard errors")
    for model, truth in TRUTHS.items():
        clean, names = picture(corner(bsdf(model, truth))), [f"ball.bsdf.{name}" for name in truth]
        away, results = [], []
        for number in range(STARTS):
            rng = np.random.default_rng([number, len(model)])
            noisy = clean * (1 + NOISE * rng.standard_normal(clean.shape))
            scene = corner(bsdf(model, random_start(model, truth, rng)))
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
        {"gradients": gradients, "steps": steps, "bounces": bounces, "starts": starts}[table]()
