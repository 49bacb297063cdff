"""An environment map of the user's, in the place of the sky and the softbox of a scene."""

from pathlib import Path

import numpy as np

from brdfkit.colours import luminance
from brdfkit.errors import BrdfkitError
from brdfkit.host.load_by_mitsuba import load_by_mitsuba

ILLUMINANCE = 1.0  # of the ground, as from sky and softbox


def environment(path):
    """The dictionary of the light of a map by latitude and longitude, in a file of any HDR format.

    It is scaled to the illuminance of the ground that the scenes have, so that pictures are exposed
    alike. Raises `BrdfkitError` for a file that is missing, that Mitsuba cannot read, or whose
    upper half, which lights the ground, is black; and for radiance that is negative or not finite.
    """
    import mitsuba as mi

    path = require_map(path)
    read = load_by_mitsuba(lambda file, parallel: mi.Bitmap(file), str(path), path)
    rgb = np.array(read.convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
    height, width = rgb.shape[:2]
    if not (np.isfinite(rgb).all() and rgb.min() >= 0):
        raise BrdfkitError(f"{path}: the map has a negative value, or one not finite; mend it.")
    # the integral of cos theta over a pixel, as far as it lies above the horizon
    edges = np.minimum(np.arange(height + 1) / height * np.pi, np.pi / 2)
    projected = np.pi / width * np.diff(np.sin(edges) ** 2)
    received = luminance(rgb.astype(float)).sum(axis=1) @ projected
    if not received > 0:
        raise BrdfkitError(f"{path}: the map gives no light from above; choose another.")
    return {
        "type": "envmap",
        "bitmap": mi.Bitmap(rgb),
        "scale": ILLUMINANCE / received,
        "to_world": mi.ScalarTransform4f().rotate([1, 0, 0], 90),  # the map has y up
    }


def require_map(path):
    """The `Path` of an environment map; `BrdfkitError` where there is no such file."""
    if not isinstance(path, str | Path) or not str(path):
        raise BrdfkitError(f"envmap = {path!r:.60} should be the path of an environment map.")
    if not Path(path).is_file():
        raise BrdfkitError(f"{path}: there is no such environment map; check the path.")
    return Path(path)


def light_by(light, scene):
    """The dictionary of a scene with another `light` for its sky and its softbox.

    Raises `BrdfkitError` for a scene with lamps of its own.
    """
    if not isinstance(scene, dict) or "sky" not in scene:
        raise BrdfkitError("The scene has lamps of its own: leave envmap out, or choose another.")
    return {key: value for key, value in scene.items() if key != "softbox"} | {"sky": light}
