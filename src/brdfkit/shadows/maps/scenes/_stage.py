"""What the scenes share: their views, their two suns, the camera, and things to build with.

The views are named by where they look and where the light goes [Ergun 2008, 4.2]. Light comes down
along y, turned a little, and the azimuth of a view is reckoned from there.
"""

import numpy as np

from brdfkit.core.errors import no_such

VIEWS = {
    "V1": 90,  # at right angles to the light
    "V2": 180,  # into the light: duelling frusta
    "V3": 155,  # between the two
    "V4": 0,  # with the light: the miner's lamp
}
LIGHTS = {1: 14, 2: 17}  # their azimuths [degrees]: the second one shows what changes at a step
ELEVATION = 48  # of the suns [degrees]


def stage(view, light, size, eye, down, fov):
    """The camera and the sun of a scene, as a dictionary.

    eye : azimuth in radians → where the camera is (3,).
    down : how far it looks down [degrees].
    fov : its field of view [degrees].
    """
    import mitsuba as mi

    if view not in VIEWS:
        raise no_such("view", view, VIEWS)
    if light not in LIGHTS:
        raise no_such("light", str(light), map(str, LIGHTS))
    azimuth = np.radians(VIEWS[view])
    origin = np.asarray(eye(azimuth), float)
    target = origin + heading(azimuth, -np.radians(down))
    to_world = mi.ScalarTransform4f().look_at(origin.tolist(), target.tolist(), [0, 0, 1])
    film = {"type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"}}
    sun = heading(np.radians(LIGHTS[light]), -np.radians(ELEVATION))
    return {
        "type": "scene",
        "integrator": {"type": "direct"},
        "camera": {"type": "perspective", "fov": fov, "to_world": to_world, "film": film},
        "sun": {
            "type": "directional",
            "direction": sun.tolist(),
            "irradiance": {"type": "rgb", "value": [3.4, 3.1, 2.6]},
        },
    }


def heading(azimuth, elevation):
    """The unit vector (3,) of an azimuth, from y towards x, and an elevation [radians]."""
    level = np.cos(elevation)
    return np.array([level * np.sin(azimuth), level * np.cos(azimuth), np.sin(elevation)])


def matte(colour):
    """A diffuse material that is seen from both sides."""
    reflectance = {"type": "rgb", "value": list(colour)}
    return {"type": "twosided", "material": {"type": "diffuse", "reflectance": reflectance}}


def box(centre, size, colour, turn=0):
    """A cuboid that stands on the height of its `centre`, turned by `turn` [degrees]."""
    import mitsuba as mi

    x, y, z = centre
    place = mi.ScalarTransform4f().translate([x, y, z + size[2] / 2]).rotate([0, 0, 1], turn)
    half = [float(side) / 2 for side in size]
    return {"type": "cube", "to_world": place.scale(half), "bsdf": matte(colour)}


def pole(foot, height, radius, colour):
    """An upright cylinder."""
    x, y, z = foot
    ends = {"p0": [x, y, z], "p1": [x, y, z + height]}
    return {"type": "cylinder", **ends, "radius": radius, "bsdf": matte(colour)}


def ball(centre, radius, colour):
    return {"type": "sphere", "center": list(centre), "radius": radius, "bsdf": matte(colour)}


def ground(half, colour):
    """A square in z = 0, from -half to half."""
    import mitsuba as mi

    to_world = mi.ScalarTransform4f().scale([half, half, 1])
    return {"type": "rectangle", "to_world": to_world, "bsdf": matte(colour)}


def numbered(name, things):
    """The `things` with names of their own, for the dictionary of a scene."""
    return {f"{name}_{i}": thing for i, thing in enumerate(things)}
