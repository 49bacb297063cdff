"""Mitsuba: `volpath` through a heterogeneous medium that only absorbs.

It has no transfer functions and no media that glow, so that the light behind the volume is all that
there is to see: pictures are compared by their opacity. σ_t is looked up at the voxels, and then
interpolated; or, by brdfkit's plugin `transfer_function`, the other way round.
"""

import mitsuba as mi
import numpy as np

from . import by_brdfkit
from .by_brdfkit import render

NAME = "Mitsuba"
SAMPLES = 1024
SETTINGS = {
    "gridvolume": "σ_t at the voxels",
    "brdfkit's volume": "σ_t by the plugin transfer_function",
}


def version():
    return mi.__version__


def picture(case, setting):
    """The opacity alone (height, width, 4)."""
    if case.renderer != "emission_absorption":
        return None
    extinction = by_brdfkit.coloured(case)
    if setting == "gridvolume":
        if "gradients" in case.transfer:
            return None
        v, _, sigma = case.sampled()
        grid = np.interp(case.voxels, v, sigma).astype(np.float32)[..., None]
        extinction = by_brdfkit.volume(case).scene_dict() | {"grid": mi.VolumeGrid(grid)}
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
    found = render(case, scene, SAMPLES)
    found[..., 3] = 1 - found[..., 0]
    found[..., :3] = np.nan
    return found
