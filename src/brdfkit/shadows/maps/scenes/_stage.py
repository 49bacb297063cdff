"""The common parts of the scenes: four views, two suns, the camera, and shapes to build with.

Each view has another angle to the light, as in [Ergun 2008, 4.2]. z points up. Azimuths are
horizontal directions, counted from the y axis towards x. The sunlight comes down nearly along y.
"""

from collections.abc import Callable, Iterable
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import no_such_error

# Azimuth in which the camera of each view looks [degrees]; sunlight travels in the azimuth 14 or 17
VIEWS = {
    "V1": 90,  # looks at right angles to the light
    "V2": 180,  # looks into the light, the worst case of warped maps (duelling frusta)
    "V3": 155,  # looks between V1 and V2
    "V4": 0,  # looks along the light, as if the light came from a miner's lamp
}
LIGHTS = {1: 14, 2: 17}  # azimuth in which the light of each of the two suns travels [degrees]
ELEVATION = 48  # height of the suns above the horizon [degrees]

Place: TypeAlias = Iterable[float]  # three coordinates of a point, or three side lengths of a box
Colour: TypeAlias = Iterable[float]  # reflectance in red, green and blue
Shape: TypeAlias = dict[str, Any]  # a shape's dictionary for `mitsuba.load_dict`


def make_camera_and_sun(
    view: str,
    light: int,
    size: tuple[int, int],
    eye: Callable[[float], Any],
    down: float,
    fov: float,
) -> dict[str, Any]:
    """Return the dictionary of a scene with a camera and a sun, but without shapes.

    view, light : keys of `VIEWS` and `LIGHTS`.
    size : width and height of the picture [pixels].
    eye : function from the azimuth of the view [radians] to the camera's position (3,).
    down : angle by which the camera looks down [degrees].
    fov : field of view of the camera [degrees].
    """
    import mitsuba as mi

    if view not in VIEWS:
        raise no_such_error("view", view, VIEWS)
    if light not in LIGHTS:
        raise no_such_error("light", str(light), map(str, LIGHTS))
    azimuth = np.radians(VIEWS[view])
    origin = np.asarray(eye(azimuth), float)
    target = origin + unit_vector(azimuth, -np.radians(down))
    to_world = mi.ScalarTransform4f().look_at(origin.tolist(), target.tolist(), [0, 0, 1])
    film = {"type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"}}
    sun = unit_vector(np.radians(LIGHTS[light]), -np.radians(ELEVATION))
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


def unit_vector(azimuth: float, elevation: float) -> FloatArray:
    """Return the unit vector (3,) with an azimuth, from y towards x, and an elevation [radians]."""
    level = np.cos(elevation)
    return np.array([level * np.sin(azimuth), level * np.cos(azimuth), np.sin(elevation)])


def make_matte(colour: Colour) -> dict[str, Any]:
    """Return the dictionary of a diffuse material that is visible from both sides."""
    reflectance = {"type": "rgb", "value": list(colour)}
    return {"type": "twosided", "material": {"type": "diffuse", "reflectance": reflectance}}


def make_box(centre: Place, size: Place, colour: Colour, turn: float = 0) -> Shape:
    """Return the dictionary of an upright box.

    centre : the centre of the box's bottom.
    size : the box's extents in x, y and z.
    turn : angle by which the box is turned about the vertical [degrees].
    """
    import mitsuba as mi

    (x, y, z), half = centre, [float(side) / 2 for side in size]
    place = mi.ScalarTransform4f().translate([x, y, z + half[2]]).rotate([0, 0, 1], turn)
    return {"type": "cube", "to_world": place.scale(half), "bsdf": make_matte(colour)}


def make_pole(foot: Place, height: float, radius: float, colour: Colour) -> Shape:
    """Return the dictionary of an upright cylinder that stands on `foot`."""
    x, y, z = foot
    ends = {"p0": [x, y, z], "p1": [x, y, z + height]}
    return {"type": "cylinder", **ends, "radius": radius, "bsdf": make_matte(colour)}


def make_ball(centre: Place, radius: float, colour: Colour) -> Shape:
    """Return the dictionary of a sphere."""
    return {"type": "sphere", "center": list(centre), "radius": radius, "bsdf": make_matte(colour)}


def make_ground(half: float, colour: Colour) -> Shape:
    """Return the dictionary of a square in the plane z = 0, from -half to half."""
    import mitsuba as mi

    to_world = mi.ScalarTransform4f().scale([half, half, 1])
    return {"type": "rectangle", "to_world": to_world, "bsdf": make_matte(colour)}


def name_shapes_by_number(name: str, shapes: Iterable[Shape]) -> dict[str, Shape]:
    """Return the shapes as entries NAME_0, NAME_1 ... for the dictionary of a scene."""
    return {f"{name}_{i}": shape for i, shape in enumerate(shapes)}
