"""What lights a volume, and what is seen behind it."""

import numpy as np

from brdfkit.lighting.environments.light_distribution import pixel_directions
from brdfkit.rendering.scene_input.environment import environment
from brdfkit.rendering.volumes.framing import FOV

EDGE = 2.0  # about what the camera sees of an environment [degrees]: its pixels are interpolated


def background_light(background):
    """The dictionary of an emitter of one radiance all around: a number or R, G, B."""
    return {"type": "constant", "radiance": _colour(background)}


def environment_light(envmap, illuminance, background, towards, aspect):
    """The dictionary of an environment map, whose part behind the volume is the `background`.

    So the camera sees a plain background, and all other light is that of the environment. None
    leaves the map as it is. `illuminance`: of level ground, by the whole map; `towards`: the unit
    vector to the camera; `aspect`: width over height of the picture.
    """
    import mitsuba as mi

    light = environment(envmap)
    light["scale"] *= illuminance
    if background is None:
        return light
    half = np.tan(np.radians(FOV / 2))
    corner = np.degrees(np.arctan(half * np.hypot(max(aspect, 1), max(1 / aspect, 1))))
    rgb = np.array(light["bitmap"])
    x, y, z = -towards
    cosine = pixel_directions(*rgb.shape[:2]) @ [x, z, -y]  # the map has y up
    behind = cosine > np.cos(np.radians(corner + EDGE))
    rgb[behind] = np.broadcast_to(background, 3) / light["scale"]
    return light | {"bitmap": mi.Bitmap(rgb)}


def _colour(background):
    return {"type": "rgb", "value": np.broadcast_to(background, 3).tolist()}
