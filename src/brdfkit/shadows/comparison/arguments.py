"""Checks the arguments of `compare`, before the work begins."""

from typing import Any

from brdfkit.core.arguments import to_whole_number, wrong_value_error
from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.locate import find_file_or_name
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.light import Light
from brdfkit.mitsuba_bridge.scene_file import load_scene_file
from brdfkit.shadows.maps.scenes import SCENES, scene_in_all_views

MAX_SIDE = 16384  # texels of a map, or pixels of a picture


def to_names(what: str, names: Any) -> tuple[str, ...]:
    """Return names of techniques as a tuple; a single one may be a string."""
    if isinstance(names, str):
        return (names,)
    try:
        return tuple(names)
    except TypeError:
        raise wrong_value_error(what, names, "names of techniques") from None


def to_texels(resolution: Any) -> int:
    """Return the number of texels along a side of a map."""
    return to_whole_number("resolution", resolution, 1, MAX_SIDE)


def to_size(size: Any) -> tuple[int, int]:
    """Return the width and height of a picture [pixels]."""
    try:
        width, height = size
    except (TypeError, ValueError):
        raise wrong_value_error("size", size, "(width, height) in pixels") from None
    width = to_whole_number("the width in size", width, 1, MAX_SIDE)
    return width, to_whole_number("the height in size", height, 1, MAX_SIDE)


def to_scene(scene: Any, size: tuple[int, int]) -> MitsubaObject:
    """Return a `mi.Scene`, from a name in `SCENES`, from a file, or as it is.

    size : (width, height) of the pictures of a scene by name [pixels].

    Raises `BrdfkitError` for anything else, for a file that cannot be loaded, and for a scene
    without cameras or lights, or with kinds of them that shadows by projection do not support.
    """
    import mitsuba as mi

    if isinstance(scene, dict):
        raise BrdfkitError("scene: a dictionary is no scene yet; load it by mitsuba.load_dict.")
    if not isinstance(scene, mi.Scene):
        place = find_file_or_name(scene, "scene", SCENES)
        if isinstance(place, str):
            scene = mi.load_dict(scene_in_all_views(place, size), parallel=False)
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
