# ruff: noqa: I001, for brdfkit comes first: it chooses the LLVM that Dr.Jit loads
"""Measures soft shadows from a single ray: their errors, evaluations and times, beside hard rays.

    python benchmarks/single_ray_shadows.py          # minutes on two cores

Each part is kept in `single_ray_shadows.json` as soon as it is measured, and the same command goes
on from there; delete the file to measure anew. It then writes docs/single_ray_shadows.md and .png.
Times are compared within a part, where methods take turns; they are of all threads.
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
from brdfkit.distance_fields.shadows.tau import lit_disc_share
from brdfkit.core.json_values import round_numbers
from brdfkit.theses.balint2019.dense import dense
from brdfkit.theses.balint2019.rivals import aaltonen, base, discrete, quilez

RESULTS = Path(__file__).with_suffix(".json")
DIGITS = 4  # of numbers in it
LANES, TRUE_RAYS, HIT = 4096, 2048, 1e-4  # random scenes of a kind, and rays of the truth
SIZE, FRAME_RAYS = 160, 512  # pixels along a side of a frame, and rays of its truth
RAYS = 1, 2, 4, 8, 16, 32, 64, 128
MARCHES = {
    "base": base,
    "linear": compute_linear_shadow,
    "discrete": discrete,
    "convex": compute_convex_shadow,
}
REPEATS = 8


def methods():
    """Label → the function of a field and a cone."""
    found = {f"{n} 1/20": partial(m, epsilon=1 / 20) for n, m in MARCHES.items()}
    found |= {"linear 1/10": partial(compute_linear_shadow, epsilon=1 / 10)}
    found |= {"linear 1/256": partial(compute_linear_shadow, epsilon=1 / 256)}
    found |= {f"split 1/{n}": partial(compute_split_shadow, epsilon=1 / n) for n in (5, 10, 20)}
    found |= {"split, 19 cones, 1/10": partial(compute_split_shadow, epsilon=1 / 10, rings=2)}
    found |= {"quilez": quilez, "aaltonen": aaltonen}
    return found | {f"monte_carlo {n}": partial(compute_monte_carlo_shadow, rays=n) for n in RAYS}


def timed(calls):
    """Label → (values, evaluations, seconds) of calls that take turns; the least of some times."""
    found = {label: [None, None, np.inf] for label in calls}
    for turn in range(1 + REPEATS):  # the first one compiles
        for label, call in calls.items():
            start = time.process_time()
            shadow = call()
            dr.eval(shadow.visible, shadow.evaluations)
            dr.sync_thread()
            seconds = time.process_time() - start
            found[label][:2] = np.array(shadow.visible), float(np.mean(shadow.evaluations))
            found[label][2] = min(found[label][2], seconds if turn else np.inf)
    return found


def errors(values, truth):
    return {
        "rmse": float(np.sqrt(np.mean((values - truth) ** 2))),
        "bias": float(np.mean(values - truth)),
    }


def compare(field, cone, truth, calls=None):
    """Errors, evaluations and times of all methods in these cones."""
    calls = {label: partial(m, field, cone) for label, m in (calls or methods()).items()}
    rows = {}
    for label, (values, evaluations, seconds) in timed(calls).items():
        rows[label] = {**errors(values, truth), "evaluations": evaluations, "seconds": seconds}
    return rows


def measure_occluder(kind):
    """A kind of occluder: all methods against the true light, and against τ(r_min)."""
    lanes = occluders.Lanes(LANES, seed=0)
    field = kind(lanes)
    if kind is occluders.half_plane:
        truth = np.array(lit_disc_share(dr.llvm.Float(lanes.edge)))  # in closed form
    else:
        truth = np.array(compute_monte_carlo_shadow(field, lanes.cone, TRUE_RAYS, HIT).visible)
    model = np.array(dense(field, lanes.cone).visible)
    rows = compare(field, lanes.cone, truth)
    for name, march in MARCHES.items():
        from_model = 20 * (np.array(march(field, lanes.cone, 1 / 20).visible) - model)
        rows[f"{name} 1/20"]["from model"] = [float(from_model.min()), float(from_model.max())]
    rows["τ(r_min)"] = errors(model, truth) | {"evaluations": None, "seconds": None}
    return rows


def measure_frame(scene, radius):
    """A frame of shadows on the ground: all methods against the true light."""
    field, cone = scene(), ground_scenes.ground(SIZE, radius)
    return compare(
        field, cone, np.array(compute_monte_carlo_shadow(field, cone, FRAME_RAYS, HIT).visible)
    )


def parts():
    """Name → what measures it."""
    found = {f"occluder {k.__name__}": partial(measure_occluder, k) for k in occluders.KINDS}
    for scene in (ground_scenes.cube, ground_scenes.simple, ground_scenes.complicated):
        for radius in (0.2, 1.0):
            found[f"frame {scene.__name__} {radius}"] = partial(measure_frame, scene, radius)
    return found | {"gradients": shadow_gradients.measure}


def main():
    """Measure what is not measured yet, and write the page."""
    results = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    for name, measure in parts().items():
        if name not in results:
            print(name, flush=True)
            results[name] = round_numbers(measure(), DIGITS)
            RESULTS.write_text(json.dumps(results, indent=1, ensure_ascii=False) + "\n")
    page.write(results)


if __name__ == "__main__":
    main()
