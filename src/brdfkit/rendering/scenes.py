"""The scene of every picture: a ball on grey ground under a clear sky and one softbox.

World: z up, metres; the ball has radius 1, stands on the plane z = 0 at the origin and is seen
from the south (-y). Its parametrisation has z as its axis, so that an anisotropic material is
brushed along the ball's parallels.
"""

import numpy as np

CAMERA = (0.0, -8.0, 3.2)
TARGET = (0.0, 0.0, 0.96)
FOV = 19.8  # [degrees] along the shorter side of the picture: the ball fills 70 % of it
SOFTBOX = (-4.4, -3.2, 5.4)
BALL = (0.0, 0.0, 1.0)
SUN = (0.75, 0.5, 0.45)
GREY_SKY = 0.18


def ball(bsdf, size=(512, 512), spp=64):
    """The scene dictionary for `mitsuba.load_dict`: a ball of the material `bsdf`.

    `bsdf`: a BSDF's dictionary (or object); `size`: (width, height) [pixels]; `spp`: samples per
    pixel. The exposure is fixed: a white wall paint (diffuse, reflectance 0.8) comes out near
    sRGB 200 where it is brightest, so that pictures of different materials can be compared.
    Works in every variant of Mitsuba.

    >>> ball({"type": "diffuse"})["type"]
    'scene'
    """
    import mitsuba as mi

    at = mi.ScalarTransform4f()
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 6},
        "sensor": _camera(at, size, spp),
        "sky": _grey_sky(at) if mi.is_monochromatic else _sky(),
        "softbox": _softbox(at),
        "ground": {
            "type": "disk",
            "to_world": at.scale(1000),
            "bsdf": {"type": "diffuse", "reflectance": 0.32},
        },
        "ball": {"type": "sphere", "center": list(BALL), "radius": 1.0, "bsdf": bsdf},
    }


def ball_mask(size=(512, 512)):
    """True (height, width) where the centre of a pixel sees the ball.

    >>> ball_mask((32, 32)).shape
    (32, 32)
    """
    width, height = size
    x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    scale = 2 * np.tan(np.radians(FOV) / 2) / min(width, height)
    forward, right, up = _axes()
    ray = (
        forward
        + ((x - width / 2) * scale)[..., None] * right
        + ((height / 2 - y) * scale)[..., None] * up
    )
    ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
    to_ball = np.subtract(BALL, CAMERA)
    # a ray meets the ball, of radius 1, where it passes its centre at less than 1
    return to_ball @ to_ball - (ray @ to_ball) ** 2 < 1


def _axes():
    """The camera's unit vectors (forward, right, up)."""
    forward = np.subtract(TARGET, CAMERA)
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, (0, 0, 1))
    right /= np.linalg.norm(right)
    return forward, right, np.cross(right, forward)


def _camera(at, size, spp):
    """The sensor's dictionary; `at`: a `mitsuba.ScalarTransform4f`."""
    import mitsuba as mi

    return {
        "type": "perspective",
        "fov": FOV,
        "fov_axis": "smaller",
        "to_world": at.look_at(list(CAMERA), list(TARGET), [0, 0, 1]),
        "film": {
            "type": "hdrfilm",
            "width": int(size[0]),
            "height": int(size[1]),
            "pixel_format": "luminance" if mi.is_monochromatic else "rgb",
            "component_format": "float32",
        },
        "sampler": {"type": "multijitter", "sample_count": int(spp)},
    }


def _sky():
    """Hosek-Wilkie sky, brightest behind the ball to the right: it lights the ball's grazing rim.

    The sun's disc is left out: half a degree wide, it makes a firefly of every path that a material
    samples imperfectly, and the softbox is the better key light.
    """
    return {
        "type": "sunsky",
        "turbidity": 7.0,
        "albedo": 0.32,
        "sun_direction": list(SUN),
        "sun_scale": 0.0,
        "sky_scale": 1.65,
    }


def _grey_sky(at):
    """A sky of the same brightness for mono variants, in which Mitsuba's own does not work.

    CIE standard sky 13, clear over polluted air (ISO 15469:2004), scaled so that the ground
    receives the same illuminance as from `_sky`.
    """
    import mitsuba as mi

    # direction of each pixel: rows over the polar angle, columns over the azimuth
    height, width = 129, 256
    theta = np.linspace(0, np.pi / 2, height // 2 + 1)[:, None]  # the first and last row are poles
    phi = (np.arange(width) + 0.5) / width * 2 * np.pi
    up, side = np.cos(theta), np.sin(theta)
    towards = np.stack(np.broadcast_arrays(side * np.sin(phi), side * np.cos(phi), up), axis=-1)

    # the standard's gradation towards the horizon and its indicatrix about the sun
    from_sun = np.arccos(np.clip(towards @ SUN / np.linalg.norm(SUN), -1, 1))
    gradation = 1 - np.exp(-0.32 / np.maximum(up, 1e-6))
    glow = 16 * (np.exp(-3 * from_sun) - np.exp(-3 * np.pi / 2)) + 0.3 * np.cos(from_sun) ** 2

    luminance = np.zeros((height, width, 1), np.float32)  # black below the horizon
    luminance[: len(theta), :, 0] = GREY_SKY * gradation * (1 + glow)
    return {
        "type": "envmap",
        "bitmap": mi.Bitmap(luminance),
        "to_world": at.rotate([1, 0, 0], 90),  # an environment map has y up
    }


def _softbox(at):
    """A square light at the upper left in front: it makes the highlight and the terminator."""
    return {
        "type": "rectangle",
        "to_world": at.look_at(list(SOFTBOX), list(BALL), [0, 0, 1]) @ at.scale(2.6),
        "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [3.4, 3.25, 3.0]}},
    }
