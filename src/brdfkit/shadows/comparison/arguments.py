"""What `compare` is asked for, checked before the work."""

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.locate import find_file_or_name
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.light import Light
from brdfkit.mitsuba_bridge.scene_file import load_scene_file
from brdfkit.shadows.maps.scenes import SCENES, in_all_views


def load(given, size):
    """The `mitsuba.Scene` of a name in `SCENES`, of a path, or the `given` one itself.

    size : (width, height) of the pictures of a scene by name [pixels].

    Raises `BrdfkitError` for anything else, and for a file that cannot be loaded.
    """
    import mitsuba as mi

    if isinstance(given, mi.Scene):
        return given
    if isinstance(given, dict):
        raise BrdfkitError("scene: a dictionary is no scene yet; load it by mitsuba.load_dict.")
    place = find_file_or_name(given, "scene", SCENES)
    if isinstance(place, str):
        return mi.load_dict(in_all_views(place, size), parallel=False)
    return load_scene_file(place)


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
    return to_whole_number("resolution", resolution, 1, MOST)


def to_size(size):
    """The width and height of a picture."""
    try:
        width, height = size
    except (TypeError, ValueError):
        raise BrdfkitError(f"size = {size!r} should be (width, height) in pixels.") from None
    width = to_whole_number("the width in size", width, 1, MOST)
    return width, to_whole_number("the height in size", height, 1, MOST)


def to_scene(scene, size):
    """The `mi.Scene` of a name, seen in pictures of `size`, of a file, or the one that is given.

    Raises `BrdfkitError` for what is no scene, for one without a camera or a light, and for one
    with others than shadows by projection take.
    """
    scene = load(scene, size)
    if not scene.sensors():
        raise BrdfkitError("the scene has no camera; add a perspective one.")
    if not scene.emitters():
        raise BrdfkitError("the scene has no light; add a point, spot or directional one.")
    for sensor in scene.sensors():
        Camera.from_sensor(sensor)
    for emitter in scene.emitters():
        Light.from_emitter(emitter)
    return scene
