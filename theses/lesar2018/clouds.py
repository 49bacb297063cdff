"""Smoke, of any number of voxels, as the volume of each of the renderers."""

from functools import cache

from brdfkit.volumes import TransferFunction
from brdfkit.volumes.made import make

EXTINCTION = 8.0  # where smoke is densest, of a cube of edge 2
LEVEL = 0.35


@cache
def smoke(voxels):
    """The smoke."""
    return make("smoke", (voxels,) * 3)


def cloud(renderer, voxels):
    """The dictionary of a renderer with smoke of `voxels`³."""
    rgba = [[0.95, 0.8, 0.6, 0], [0.85, 0.9, 0.95, 1]]
    coloured = smoke(voxels).scene_dict(TransferFunction([0, 1], rgba, EXTINCTION))
    volume = {
        "maximum_intensity": {"volume": coloured},
        "isosurface": {"volume": smoke(voxels).scene_dict(), "level": LEVEL},
        "emission_absorption": {"extinction": coloured},
        "single_scattering": {"extinction": coloured, "phase": {"type": "hg", "g": 0.3}},
    }
    return {"type": renderer, **volume[renderer]}
