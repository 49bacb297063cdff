# ruff: noqa: I001, for brdfkit comes first: it chooses the LLVM that Dr.Jit loads
"""Measures errors, evaluations and times of soft shadows from a single ray.

    python benchmarks/single_ray_shadows.py          # minutes on two cores

Each part is stored in `single_ray_shadows.json` as soon as it is measured, so that the same command
continues an interrupted run; delete the file to measure again. Then it writes
docs/single_ray_shadows.md and .png. Times are compared within a part, where methods take turns in
one thread; they are processor times.
"""

import json
import time
from functools import partial
from pathlib import Path

import brdfkit  # noqa: F401
import drjit as dr
import ground_scenes
import numpy as np
import occluders
import shadow_gradients
import single_ray_shadows_page as page

from brdfkit.distance_fields.shadows.marches import compute_convex_shadow, compute_linear_shadow
from brdfkit.distance_fields.shadows.monte_carlo import compute_monte_carlo_shadow
from brdfkit.distance_fields.shadows.split import compute_split_shadow
from brdfkit.core.jit.threads import use_one_thread
from brdfkit.core.json_values import round_numbers
from brdfkit.theses.balint2019.dense import compute_dense_shadow
from brdfkit.theses.balint2019.rivals import aaltonen, base, discrete, quilez

RESULTS = Path(__file__).with_suffix(".json")
DIGITS = 4  # significant digits of the numbers in the JSON
# Random scenes of a kind, rays of the true shadow, and distance at which such a ray hits
LANES, TRUE_RAYS, HIT = 4096, 2048, 1e-4
# Pixels along a side of a frame, and rays of its true shadows
SIZE, FRAME_RAYS = 160, 512
RAYS = 1, 2, 4, 8, 16, 32, 64, 128
MARCHES = {
    "base": base,
    "linear": compute_linear_shadow,
    "discrete": discrete,
    "convex": compute_convex_shadow,
}
REPEATS = 5


def list_methods():
    """Return the methods by label; each is a function of a field and a cone of light."""
    found = {f"{n} 1/20": partial(m, epsilon=1 / 20) for n, m in MARCHES.items()}
    found |= {"linear 1/10": partial(compute_linear_shadow, epsilon=1 / 10)}
    found |= {"linear 1/256": partial(compute_linear_shadow, epsilon=1 / 256)}
    found |= {f"split 1/{n}": partial(compute_split_shadow, epsilon=1 / n) for n in (5, 10, 20)}
    found |= {"split, 19 cones, 1/10": partial(compute_split_shadow, epsilon=1 / 10, rings=2)}
    found |= {"quilez": quilez, "aaltonen": aaltonen}
    return found | {f"monte_carlo {n}": partial(compute_monte_carlo_shadow, rays=n) for n in RAYS}


def time_calls(calls):
    """Return (values, evaluations, least seconds) of calls that take turns, by label."""
    found = {label: [None, None, np.inf] for label in calls}
    for turn in range(1 + REPEATS):  # the first turn compiles the kernels
        for label, call in calls.items():
            start = time.process_time()
            shadow = call()
            dr.eval(shadow.visible, shadow.evaluations)
            dr.sync_thread()
            seconds = time.process_time() - start
            found[label][:2] = np.array(shadow.visible), float(np.mean(shadow.evaluations))
            found[label][2] = min(found[label][2], seconds if turn else np.inf)
    return found


def compute_errors(values, truth):
    return {
        "rmse": float(np.sqrt(np.mean((values - truth) ** 2))),
        "bias": float(np.mean(values - truth)),
    }


def compare_methods(field, cone, truth, calls=None):
    """Return errors, evaluations and times of all methods for cones with known true values."""
    calls = {label: partial(m, field, cone) for label, m in (calls or list_methods()).items()}
    rows = {}
    for label, (values, evaluations, seconds) in time_calls(calls).items():
        rows[label] = {
            **compute_errors(values, truth),
            "evaluations": evaluations,
            "seconds": seconds,
        }
    return rows


def compute_true_shares(field, cone, rays):
    """Return the shares of the light by other rays than those of the methods that are compared."""
    return np.array(compute_monte_carlo_shadow(field, cone, rays, HIT, max(RAYS)).visible)


@use_one_thread()
def measure_occluder(kind):
    """Measure all methods for one kind of occluder, compared with the true share of the light.

    They are also compared with τ(r_min), the model of one straight edge that they approach.
    """
    lanes = occluders.Lanes(LANES, seed=0)
    field = kind(lanes)
    truth = compute_true_shares(field, lanes.cone, TRUE_RAYS)
    model = np.array(compute_dense_shadow(field, lanes.cone).visible)
    rows = compare_methods(field, lanes.cone, truth)
    for name, march in MARCHES.items():
        from_model = 20 * (np.array(march(field, lanes.cone, 1 / 20).visible) - model)
        rows[f"{name} 1/20"]["from model"] = [float(from_model.min()), float(from_model.max())]
    rows["τ(r_min)"] = compute_errors(model, truth) | {"evaluations": None, "seconds": None}
    return rows


@use_one_thread()
def measure_frame(scene, radius):
    """Measure all methods on a frame of shadows on the ground, compared with true shadows."""
    field, cone = scene(), ground_scenes.make_light_cones(SIZE, radius)
    return compare_methods(field, cone, compute_true_shares(field, cone, FRAME_RAYS))


def list_parts():
    """Return the functions that measure the parts of the benchmark, by name of the part."""
    found = {f"occluder {k.__name__}": partial(measure_occluder, k) for k in occluders.KINDS}
    for scene in (ground_scenes.cube, ground_scenes.simple, ground_scenes.complicated):
        for radius in (0.2, 1.0):
            found[f"frame {scene.__name__} {radius}"] = partial(measure_frame, scene, radius)
    return found | {"gradients": shadow_gradients.measure_gradients}


def main():
    """Measure all parts without results, and write the page."""
    results = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    for name, measure in list_parts().items():
        if name not in results:
            print(name, flush=True)
            results[name] = round_numbers(measure(), DIGITS)
            RESULTS.write_text(json.dumps(results, indent=1, ensure_ascii=False) + "\n")
    page.write_page(results)


if __name__ == "__main__":
    main()
