"""Renders scenes again and again, recorded so that only the rendering takes time."""

import gc
from contextlib import contextmanager
from functools import cache, partial

import drjit as dr
import numpy as np

from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.volumes import TransferFunction
from brdfkit.volumes.made import make_volume

FOV = 30  # degrees
DISTANCE = 3.95
LAMP, SKY = 3.2, 0.35  # irradiances of the lamp and of the fill light


def make_stage(integrator, size, eye=(0, -1, 0), up=(0, 0, 1), lit=True):
    """Return a scene of a volume in the cube from -1 to 1, seen from the direction `eye`.

    integrator : the dictionary of the integrator, which contains the volume.
    size : pixels along both edges of the picture.
    lit : whether there are a lamp, to the left above the camera, and a fill light.
    """
    import mitsuba as mi

    eye, up = (np.array(v, float) / np.linalg.norm(v) for v in (eye, up))
    camera = mi.ScalarTransform4f().look_at((DISTANCE * eye).tolist(), [0, 0, 0], up.tolist())
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}}
    scene = {
        "type": "scene",
        "integrator": integrator,
        "sensor": {"type": "perspective", "fov": FOV, "to_world": camera, "film": film},
    }
    if lit:
        left = np.cross(up, eye)
        direction = (-eye - 0.9 * up + 0.8 * left).tolist()
        scene["lamp"] = {"type": "directional", "direction": direction, "irradiance": LAMP}
        scene["fill"] = {"type": "directional", "direction": (-eye - left).tolist(),
                         "irradiance": SKY}  # fmt: skip
    return mi.load_dict(scene, parallel=False)


EXTINCTION = 8.0  # where smoke is densest, per unit of length; the cube's edge is 2
LEVEL = 0.35  # of the smoke's isosurface


@cache
def make_smoke(voxels):
    """Return a cube of smoke with `voxels` along each edge."""
    return make_volume("smoke", (voxels,) * 3)


def make_cloud(renderer, voxels):
    """Return the dictionary of a renderer of smoke with `voxels` along each edge."""
    rgba = [[0.95, 0.8, 0.6, 0], [0.85, 0.9, 0.95, 1]]
    coloured = make_smoke(voxels).scene_dict(TransferFunction([0, 1], rgba, EXTINCTION))
    volume = {
        "maximum_intensity": {"volume": coloured},
        "isosurface": {"volume": make_smoke(voxels).scene_dict(), "level": LEVEL},
        "emission_absorption": {"extinction": coloured},
        "single_scattering": {"extinction": coloured, "phase": {"type": "hg", "g": 0.3}},
    }
    return {"type": renderer, **volume[renderer]}


def make_renderer(spp=1):
    """Return a function that renders a scene with a seed and so many samples per pixel.

    The rendering is recorded at the first call, and replayed: Mitsuba prepares each render for as
    long as a small picture takes. Dr.Jit records nothing while BSDFs of other scenes are alive, as
    in a notebook; then each render is prepared.
    """
    import mitsuba as mi

    def render(scene, seed):
        return mi.render(scene, spp=spp, seed=seed)

    recorded = dr.freeze(render)

    def call(state, scene, seed):
        if state["recorded"]:
            try:
                # Dr.Jit wraps Ctrl-C in a RuntimeError, which must not render once more
                with raise_first_cause(), suspend_garbage_collection():
                    return recorded(scene, mi.UInt32(seed))
            except RuntimeError:
                state["recorded"] = False
        return render(scene, seed)

    return partial(call, {"recorded": True})


@contextmanager
def suspend_garbage_collection():
    """Collect no garbage within the block: Dr.Jit crashes if a scene is freed while it records."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()
