"""An environment map, by its name or file, in the place of the sky and the softbox of a scene."""

import numpy as np

from brdfkit.core.colours import luminance
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.latitude_rows import projected_solid_angles
from brdfkit.lighting.environments.map_files import load_radiance

ILLUMINANCE = 1.0  # of the ground, as from sky and softbox


def environment(given):
    """The dictionary of the light of a map by latitude and longitude: a name, or an HDR file.

    It is scaled to the illuminance of the ground that the scenes have, so that pictures are exposed
    alike. Raises `BrdfkitError` for a file that is missing, that Mitsuba cannot read, that is not
    twice as wide as high, or whose upper half, which lights the ground, is black; and for radiance
    that is negative or not finite.
    """
    import mitsuba as mi

    name, rgb = load_radiance(given)
    received = luminance(_received(rgb))
    if not received > 0:
        raise BrdfkitError(f"{name}: the map gives no light from above; choose another.")
    return {
        "type": "envmap",
        "bitmap": mi.Bitmap(rgb),
        "scale": ILLUMINANCE / received,
        "to_world": mi.ScalarTransform4f().rotate([1, 0, 0], 90),  # the map has y up
    }


def on_ground(light, reflectance):
    """The dictionary of a `light`, see `environment`, whose lower half is matte ground in it."""
    import mitsuba as mi

    rgb = np.array(light["bitmap"])
    rgb[len(rgb) // 2 :] = reflectance / np.pi * _received(rgb)
    return light | {"bitmap": mi.Bitmap(rgb)}


def _received(rgb):
    """The irradiance (3,) of the ground by a map (height, width, 3)."""
    return projected_solid_angles(*rgb.shape[:2]) @ rgb.astype(float).sum(axis=1)


def light_by(light, scene):
    """The dictionary of a scene with another `light` for its sky and its softbox.

    Raises `BrdfkitError` for a scene with lamps of its own.
    """
    if not isinstance(scene, dict) or "sky" not in scene:
        raise BrdfkitError("The scene has lamps of its own: leave envmap out, or choose another.")
    return {key: value for key, value in scene.items() if key != "softbox"} | {"sky": light}
