"""Draws the conformance set in Mitsuba, by `volpath` through a medium that only absorbs.

Mitsuba has no transfer functions and no media that glow, so only opacities are compared: how much
the volume dims the light behind it. The extinction σ_t is looked up at the voxels and then
interpolated, or with brdfkit's plugin `transfer_function` interpolated first.
"""

import mitsuba as mi
import numpy as np

from . import by_brdfkit
from .by_brdfkit import render_scene

NAME = "Mitsuba"
SAMPLES = 1024
SETTINGS = {
    "gridvolume": "σ_t at the voxels",
    "brdfkit's volume": "σ_t by the plugin transfer_function",
}


def find_version():
    return mi.__version__


def draw_case(case, setting):
    """Return a picture (height, width, 4) with only the opacity; RGB is NaN."""
    if case.renderer != "emission_absorption":
        return None
    extinction = by_brdfkit.make_coloured_volume(case)
    if setting == "gridvolume":
        if "gradients" in case.transfer:
            return None
        v, _, sigma = case.sample_transfer()
        grid = np.interp(case.voxels, v, sigma).astype(np.float32)[..., None]
        extinction = by_brdfkit.make_volume(case).scene_dict() | {"grid": mi.VolumeGrid(grid)}
    cube = {
        "type": "cube",
        "bsdf": {"type": "null"},
        "interior": {"type": "heterogeneous", "albedo": 0.0, "sigma_t": extinction},
    }
    scene = {
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": 200, "rr_depth": 1000},
        "cube": cube,
        "light": {"type": "constant", "radiance": 1.0},
    }
    found = render_scene(case, scene, SAMPLES)
    found[..., 3] = 1 - found[..., 0]
    found[..., :3] = np.nan
    return found
