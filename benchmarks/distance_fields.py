"""Compares the time of rays in distance fields with Mitsuba's `sdfgrid` on the same values.

python benchmarks/distance_fields.py

The rays of a camera, and the same in random order, meet a grid of 64³ values. Ratios are of the
least of several times in one run. The methods take turns, so that other work on the machine affects
all of them alike.
"""

from functools import partial
from time import perf_counter

import brdfkit  # noqa: F401  (chooses LLVM before Dr.Jit is loaded)
from brdfkit import distance_fields as df

SIDE = 1024  # pixels
TURNS = 7
BAR = 1.5  # the ratio that is to be reached


def make_camera_rays(mi):
    """Return the rays of a camera that looks at the unit cube from outside."""
    film = {"type": "hdrfilm", "width": SIDE, "height": SIDE}
    view = mi.ScalarTransform4f().look_at([1.6, 1.9, 1.5], [0.5, 0.5, 0.5], [0, 0, 1])
    camera = mi.load_dict({"type": "perspective", "fov": 30, "to_world": view, "film": film})
    return camera.sample_ray(0, 0.5, make_pixel_centres(mi), mi.Point2f(0.5))[0]


def make_pixel_centres(mi):
    import drjit as dr

    index = dr.arange(mi.UInt32, SIDE * SIDE)
    return (mi.Point2f(mi.Float(index % SIDE), mi.Float(index // SIDE)) + 0.5) / SIDE


def shuffle_rays(mi, ray):
    """Return the same rays in random order."""
    import drjit as dr
    import numpy as np

    order = mi.UInt32(np.random.default_rng(0).permutation(SIDE * SIDE).astype(np.uint32))
    return mi.Ray3f(dr.gather(mi.Point3f, ray.o, order), dr.gather(mi.Vector3f, ray.d, order))


def measure_least_times(calls):
    """Return the least time [s] of each of `calls`, which take turns; the first call compiles."""
    import drjit as dr

    best = {}
    for turn in range(TURNS + 1):
        for name, call in calls.items():
            begin = perf_counter()
            dr.eval(call().t)
            dr.sync_thread()
            took = perf_counter() - begin
            if turn:
                best[name] = min(took, best.get(name, took))
    return best


def main():
    import drjit as dr
    import mitsuba as mi
    import numpy as np

    mi.set_variant("llvm_ad_rgb")
    ring = df.torus(0.3, 0.12).at(0.5, 0.5, 0.5) | df.sphere(0.15).at(0.5, 0.5, 0.5).k(0.1)
    grid = ring.to_grid(63, ((0, 0, 0), (1, 1, 1)))
    values = mi.TensorXf(grid.values[..., None].astype(np.float32))
    scene = mi.load_dict({"type": "scene", "sdf": {"type": "sdfgrid", "grid": values}})
    print(f"{grid}, L = {grid.lipschitz:.2f}; {SIDE}² rays; times faster than sdfgrid")
    rays = make_camera_rays(mi)
    for name, ray in {"camera": rays, "shuffled": shuffle_rays(mi, rays)}.items():
        dr.eval(ray)
        ours = {
            f"precision {precision:g}": partial(
                df.intersect, grid, ray.o, ray.d, 10.0, precision=precision
            )
            for precision in (1e-3, 1e-4, 1e-5)
        }
        theirs = {"sdfgrid": partial(scene.ray_intersect_preliminary, ray)}
        times = measure_least_times(theirs | ours)
        expected = np.array(theirs["sdfgrid"]().t)
        for what, call in ours.items():
            hit, ratio = call(), times["sdfgrid"] / times[what]
            both = np.isfinite(expected) & np.array(hit.found)
            print(
                f"{name:9} {what:15} {ratio:5.2f} × (bar {BAR}), "
                f"{SIDE**2 / times[what] / 1e6:5.1f} Mrays/s; "
                f"mean difference {np.abs(np.array(hit.t) - expected)[both].mean():.1e}"
            )


if __name__ == "__main__":
    main()
