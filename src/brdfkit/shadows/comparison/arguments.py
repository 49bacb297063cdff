"""Checks the arguments of `compare`, before the work begins."""

from typing import Any

from brdfkit.core.arguments import to_whole_number, wrong_value_error
from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.locate import find_file_or_name
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.light import Light
from brdfkit.mitsuba_bridge.scene_file import load_scene_file
from brdfkit.shadows.maps.scenes import SCENES, make_scene_in_all_views

MAX_SIDE = 16384  # largest side of a shadow map [texels], and of a picture [pixels]


def check_names(what: str, names: Any) -> tuple[str, ...]:
    """Check the names of techniques, one or several, and return them as a tuple.

    what : the name of the checked argument of `compare`, for the error message.
    """
    if isinstance(names, str):
        return (names,)
    try:
        return tuple(names)
    except TypeError:
        raise wrong_value_error(what, names, "names of techniques") from None


def check_picture_size(size: Any) -> tuple[int, int]:
    """Return the width and height of a picture [pixels]; raise `BrdfkitError` for a wrong size."""
    try:
        width, height = size
    except (TypeError, ValueError):
        raise wrong_value_error("size", size, "(width, height) in pixels") from None
    width = to_whole_number("the width in size", width, 1, MAX_SIDE)
    return width, to_whole_number("the height in size", height, 1, MAX_SIDE)


def load_scene(scene: Any, size: tuple[int, int]) -> MitsubaObject:
    """Return the `mi.Scene` to compare techniques on, which must suit shadow maps.

    scene : a loaded scene, a scene file, or the name of a scene in `SCENES`.
    size : (width, height) of the pictures of a named scene [pixels].

    Raises `BrdfkitError` for anything else, for a file that cannot be loaded, and for a scene
    without cameras or lights, or with cameras or lights that shadow maps do not support.
    """
    import mitsuba as mi

    if isinstance(scene, dict):
        raise BrdfkitError("scene: a dictionary is not a scene; load it by mitsuba.load_dict.")
    if not isinstance(scene, mi.Scene):
        place = find_file_or_name(scene, "scene", SCENES)
        if isinstance(place, str):
            scene = mi.load_dict(make_scene_in_all_views(place, size), parallel=False)
        else:
            scene = load_scene_file(place)
    if not scene.sensors():
        raise BrdfkitError("the scene has no camera; add a perspective one.")
    if not scene.emitters():
        raise BrdfkitError("the scene has no light; add a point, spot or directional one.")
    for sensor in scene.sensors():
        Camera.from_sensor(sensor)
    for emitter in scene.emitters():
        Light.from_emitter(emitter)
    return scene
