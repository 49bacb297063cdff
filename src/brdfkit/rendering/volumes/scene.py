"""The scene of a volume: its voxels, transfer function, renderer, light and camera for Mitsuba."""

import numpy as np

from brdfkit.core.errors import no_such
from brdfkit.materials.resolve import to_material
from brdfkit.rendering.scenes._studio import make_camera
from brdfkit.rendering.volumes import looks
from brdfkit.rendering.volumes.framing import FOV, direction, origin_and_target
from brdfkit.rendering.volumes.light import background_light, environment_light

# The renderers, plugins of their names, and the parameter that is the volume
RENDERERS = {
    "single_scattering": "extinction",
    "emission_absorption": "extinction",
    "maximum_intensity": "volume",
    "isosurface": "volume",
}
UNLIT = "emission_absorption", "maximum_intensity"  # by themselves alone
# Illuminance of level ground. Single scattering by a dense volume reflects much less of it than a
# surface, and should look as bright
LIGHT = {"single_scattering": 10.0, "isosurface": 3.0}
LEAST_STEPS = 64  # of a ray
AROUND = range(0, 360, 15)  # azimuths from which a camera that turns should see all


def scene(volume, transfer, renderer, size, view, light, settings, all_around=False):
    """The dictionary of the scene.

    transfer : a `TransferFunction`, or None for the surface of a level
    view : (azimuth, elevation) [degrees]; all_around : see `render_volume`
    light : (envmap, background)
    settings : further parameters of the integrator
    """
    towards, (width, height) = direction(volume, *view), size
    envmap, background = light
    entries = integrator(volume, transfer, renderer, settings)
    shows = looks.shows(transfer, entries.get("level", 0))
    others = AROUND if all_around else ()
    sides = [towards, *(direction(volume, azimuth, view[1]) for azimuth in others)]
    origin, target = origin_and_target(volume, shows, sides, width / height)
    if renderer in UNLIT:
        emitter = background_light(0.0 if background is None else background)
    else:
        aspect = width / height
        emitter = environment_light(envmap, LIGHT[renderer], background, towards, aspect)
    return {
        "type": "scene",
        "integrator": entries,
        "sensor": make_camera(origin, target, FOV, size) | _clips(origin, target),
        "sky": emitter,
    }


def _clips(origin, target):
    """From where to where the camera sees: volumes are of any unit of length."""
    distance = float(np.linalg.norm(origin - target))
    return {"near_clip": 1e-3 * distance, "far_clip": 1e3 * distance}


def integrator(volume, transfer, renderer, settings):
    """The dictionary of the integrator, which has the volume in it."""
    if renderer not in RENDERERS:
        raise no_such("renderer", renderer, RENDERERS)
    entries = {"type": renderer, RENDERERS[renderer]: volume.scene_dict(transfer)}
    if renderer != "single_scattering":
        entries["steps"] = max(LEAST_STEPS, *volume.size)
    if renderer == "emission_absorption":
        entries["jitter"] = True
    if renderer == "isosurface":
        entries |= {"bsdf": looks.CLAY, "shadows": True}
        entries["level"] = looks.level(volume) if transfer is None else 0.5
    return entries | {name: _plugin(name, value) for name, value in settings.items()}


def _plugin(name, value):
    """The value of an integrator's parameter, in which a name may stand for a plugin."""
    if name == "bsdf":
        return to_material(value).scene_dict()
    return {"type": value} if name == "phase" and isinstance(value, str) else value
