"""What `compare` is asked for, checked before the work."""

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.light import Light
from brdfkit.shadows.comparison import given_scene

MOST = 16384  # texels or pixels along a side


def to_names(what, names):
    """Names of techniques as a tuple; one alone may be a text."""
    if isinstance(names, str):
        return (names,)
    try:
        return tuple(names)
    except TypeError:
        raise BrdfkitError(f"{what} = {names!r} should be names of techniques.") from None


def to_texels(resolution):
    """The texels along a side of a map."""
    return _to_side("resolution", resolution)


def to_size(size):
    """The width and height of a picture."""
    try:
        width, height = size
    except (TypeError, ValueError):
        raise BrdfkitError(f"size = {size!r} should be (width, height) in pixels.") from None
    return _to_side("the width in size", width), _to_side("the height in size", height)


def to_scene(scene, size):
    """The `mi.Scene` of a name, seen in pictures of `size`, of a file, or the one that is given.

    Raises `BrdfkitError` for what is no scene, for one without a camera or a light, and for one
    with others than shadows by projection take.
    """
    scene = given_scene.load(scene, size)
    if not scene.sensors():
        raise BrdfkitError("the scene has no camera; add a perspective one.")
    if not scene.emitters():
        raise BrdfkitError("the scene has no light; add a point, spot or directional one.")
    for sensor in scene.sensors():
        Camera.of_sensor(sensor)
    for emitter in scene.emitters():
        Light.of_emitter(emitter)
    return scene


def _to_side(what, value):
    if to_whole_number(what, value, 1) > MOST:
        raise BrdfkitError(f"{what} = {value!r} should be a whole number, {MOST} at most.")
    return int(value)
