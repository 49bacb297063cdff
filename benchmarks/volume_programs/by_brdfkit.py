"""Draws the conformance set in brdfkit, by its integrators and transfer functions."""

import mitsuba as mi
import numpy as np

import brdfkit

from .case import BEHIND, PIXELS

NAME = "brdfkit"
SETTINGS = {
    "defaults": "128 steps along a ray, 256 for largest values and isosurfaces",
    "careful": "2048 steps",
}


def find_version():
    return brdfkit.__version__


def draw_case(case, setting="defaults"):
    """Return RGB (height, width, 4) of rays through the centres of pixels; opacity is NaN."""
    integrator = {"type": case.renderer, **INTEGRATORS[case.renderer](case)}
    if setting == "careful":
        integrator["steps"] = 2048
    light = {"type": "constant", "radiance": BEHIND}
    towards = case.view_axes[0].tolist()
    if case.renderer == "isosurface":
        light = {"type": "directional", "direction": towards, "irradiance": float(np.pi)}
    return render_scene(case, {"type": "scene", "integrator": integrator, "light": light})


def render_scene(case, scene, samples=1):
    """Return RGB (height, width, 4) of a Mitsuba scene, the mean of some samples per pixel."""
    loaded = mi.load_dict(scene)
    together = min(samples, 256)
    o, d = (np.tile(x.T, together).astype(np.float32) for x in case.rays)
    total = np.zeros((PIXELS, PIXELS, 3))
    for turn in range(samples // together):
        sampler = mi.load_dict({"type": "independent"})
        sampler.seed(turn, o.shape[1])
        ray = mi.RayDifferential3f(mi.Ray3f(mi.Point3f(o), mi.Vector3f(d)))
        found = np.array(loaded.integrator().sample(loaded, sampler, ray)[0]).T
        total += found.reshape(together, PIXELS, PIXELS, 3).sum(axis=0, dtype=float)
    return np.concatenate([total / samples, np.full((PIXELS, PIXELS, 1), np.nan)], axis=-1)


def emission_absorption(case):
    return {"extinction": make_coloured_volume(case)}


def maximum_intensity(case):
    return {"volume": make_coloured_volume(case), "jitter": False}


def isosurface(case):
    matte = {"type": "diffuse", "reflectance": {"type": "rgb", "value": case.entry["albedo"]}}
    return {"volume": make_volume(case).scene_dict(), "level": case.entry["level"], "bsdf": matte}


INTEGRATORS = {f.__name__: f for f in (emission_absorption, maximum_intensity, isosurface)}


def make_coloured_volume(case):
    """Return the Mitsuba dictionary of a case's volume with its transfer function."""
    return make_volume(case).scene_dict(make_transfer_function(case))


def make_transfer_function(case):
    given = case.transfer
    if "opacity_unit_distance" in given:
        return brdfkit.volumes.TransferFunction.from_opacity(
            given["values"], given["rgba"], unit_distance=given["opacity_unit_distance"]
        )
    gradients = given.get("gradients")
    return brdfkit.volumes.TransferFunction(
        given["values"], given["rgba"], given["extinction"], "emission", gradients
    )


def make_volume(case):
    """Return a case's `Volume` in the cube from -1 to 1."""
    spacing = case.spacing
    to_world = np.diag([*spacing, 1.0])
    to_world[:3, 3] = spacing / 2 - 1
    return brdfkit.volumes.Volume(case.voxels, to_world, labels=case.entry["labels"])
