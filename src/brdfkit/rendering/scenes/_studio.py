"""The studio that most scenes share: a camera, a clear sky with one softbox, and grey ground.

z points up, and the unit is the metre. The subject stands on the plane z = 0 at the origin and is
about as large as a ball of radius 1. The camera looks at it from the south (-y).
"""

from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, MitsubaObject

CAMERA = (0.0, -8.0, 3.2)
TARGET = (0.0, 0.0, 0.96)
FOV = 19.8  # angle of view along the picture's shorter side [degrees]; the ball fills 70 % of it
SOFTBOX = (-4.4, -3.2, 5.4)
BALL = (0.0, 0.0, 1.0)
SUN = (0.75, 0.5, 0.45)
GREY_SKY = 0.18
GROUND = 0.32  # reflectance of the ground


def make_studio(size: tuple[int, int] = (512, 512), spp: int = 64) -> dict[str, Any]:
    """Return a scene's dictionary without a subject: a camera, light and ground.

    `size` is (width, height) [pixels], `spp` the number of samples per pixel. The exposure is
    fixed: a white wall paint (diffuse, reflectance 0.8) has about 200 in sRGB where it is
    brightest. The scene works in every variant of Mitsuba.

    >>> sorted(make_studio())
    ['ground', 'integrator', 'sensor', 'sky', 'softbox', 'type']
    """
    import mitsuba as mi

    at = mi.ScalarTransform4f()
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 6},
        "sensor": make_camera(CAMERA, TARGET, FOV, size, spp),
        "sky": _make_grey_sky(at) if mi.is_monochromatic else _make_sky(),
        "softbox": _make_softbox(at),
        "ground": {
            "type": "disk",
            "to_world": at.scale(1000),
            "bsdf": {"type": "diffuse", "reflectance": GROUND},
        },
    }


def make_camera(
    origin: tuple[float, float, float] | FloatArray,
    target: tuple[float, float, float] | FloatArray,
    fov: float,
    size: tuple[int, int] = (512, 512),
    spp: int = 64,
) -> dict[str, Any]:
    """Return the dictionary of a camera; `fov` [degrees] is along the picture's shorter side."""
    import mitsuba as mi

    return {
        "type": "perspective",
        "fov": fov,
        "fov_axis": "smaller",
        "to_world": mi.ScalarTransform4f().look_at(list(origin), list(target), [0, 0, 1]),
        "film": {
            "type": "hdrfilm",
            "width": int(size[0]),
            "height": int(size[1]),
            "pixel_format": "luminance" if mi.is_monochromatic else "rgb",
            "component_format": "float32",
        },
        "sampler": {"type": "multijitter", "sample_count": int(spp)},
    }


def _make_sky() -> dict[str, Any]:
    """Return a Hosek-Wilkie sky, brightest behind the ball on the right, so that it lights the rim.

    The sun's disc is left out, because it is only half a degree wide: every path that is sampled
    imperfectly would become a firefly. The softbox is the main light instead.
    """
    return {
        "type": "sunsky",
        "turbidity": 7.0,
        "albedo": GROUND,
        "sun_direction": list(SUN),
        "sun_scale": 0.0,
        "sky_scale": 1.65,
    }


def _make_grey_sky(at: MitsubaObject) -> dict[str, Any]:
    """Return a grey sky for monochromatic variants, in which Mitsuba's own sky does not work.

    It is the CIE standard sky 13, clear over polluted air (ISO 15469:2004), scaled so that the
    ground receives the same illuminance as from `_make_sky`. `at` is an identity transform.
    """
    import mitsuba as mi

    # Directions of the pixels: the polar angle theta by row, the azimuth phi by column
    height, width = 129, 256
    theta = np.linspace(0, np.pi / 2, height // 2 + 1)[:, None]  # the first row is the zenith
    phi = (np.arange(width) + 0.5) / width * 2 * np.pi
    up, side = np.cos(theta), np.sin(theta)
    towards = np.stack(np.broadcast_arrays(side * np.sin(phi), side * np.cos(phi), up), axis=-1)

    # Two factors of the CIE sky: gradation from zenith to horizon, and scattering about the sun
    from_sun = np.arccos(np.clip(towards @ SUN / np.linalg.norm(SUN), -1, 1))
    gradation = 1 - np.exp(-0.32 / np.maximum(up, 1e-6))
    glow = 16 * (np.exp(-3 * from_sun) - np.exp(-3 * np.pi / 2)) + 0.3 * np.cos(from_sun) ** 2

    luminance = np.zeros((height, width, 1), np.float32)  # black below the horizon
    luminance[: len(theta), :, 0] = GREY_SKY * gradation * (1 + glow)
    return {
        "type": "envmap",
        "bitmap": mi.Bitmap(luminance),
        "to_world": at.rotate([1, 0, 0], 90),  # y points up in environment maps, here z
    }


def _make_softbox(at: MitsubaObject) -> dict[str, Any]:
    """Return a square light at the upper left in front, which makes a highlight and a terminator.

    `at` is an identity transform.
    """
    return {
        "type": "rectangle",
        "to_world": at.look_at(list(SOFTBOX), list(BALL), [0, 0, 1]) @ at.scale(2.6),
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [3.4, 3.25, 3.0]}},
    }
