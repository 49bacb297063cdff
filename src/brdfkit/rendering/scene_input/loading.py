"""Loads the scene that `render` is given, a name, a file or a function, for each material."""

from pathlib import Path

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.locate import find_file_or_name, split_part
from brdfkit.lighting.environments.map_files import find_map
from brdfkit.mitsuba_bridge import scene_file
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.rendering.scene_input import mesh_file
from brdfkit.rendering.scene_input.environment import environment, light_by
from brdfkit.rendering.scene_input.shown_material import load_material, mask
from brdfkit.rendering.scenes import find_scene as find_scene_by_name
from brdfkit.rendering.scenes import scene_names

SIZE = 512, 512  # of a picture [pixels]


def load_scenes(materials, given, size=None, envmap=None):
    """(scenes by name, mask): a `mitsuba.Scene` for each of `materials`, the dictionaries of BSDFs
    by name, and True (height, width) where the material shows.

    `given`: see `find_scene`; `size`: (width, height) [pixels], by default 512, or a scene file's
    own; `envmap`: name or file of an environment map, for the light. The mask is None for a
    function of the user's, which gets the dictionary itself. Raises `BrdfkitError` for what cannot
    be loaded.
    """
    import mitsuba as mi

    build, suffix = find_scene(given), "" if callable(given) else suffix_of(given)
    if suffix != scene_file.SUFFIX:
        size = size or SIZE
    light = None if envmap is None else environment(envmap)
    scenes, seen, sky = {}, None, None
    for name, bsdf in materials.items():
        material = None if callable(given) else load_material(bsdf, name, both_sides=bool(suffix))
        made = build(material or bsdf, size)
        made = light_by(light, made) if light else made
        if material and isinstance(made, dict) and "sky" in made:
            # one object in all scenes, of which the kernels have the number: so they are the same
            sky = sky or load_by_mitsuba(mi.load_dict, made["sky"], name)
            made["sky"] = sky
        loaded = load_by_mitsuba(mi.load_dict, made, name) if isinstance(made, dict) else made
        _require_scene(loaded)
        if material and not scenes:
            seen = mask(loaded, material)
        scenes[name] = loaded
    return scenes, seen


def require_scene(given, envmap=None):
    """Raise `BrdfkitError` for a scene or an environment map that is not there, before anything
    long begins."""
    find_scene(given)
    if envmap is not None:
        find_map(envmap)


def find_scene(given):
    """The function that makes the scene, of (BSDF, size).

    `given`: such a function; the name of a scene; a mesh, OBJ or PLY; or a scene file, "FILE.xml"
    or "FILE.xml#ID", as "FILE.obj#z" of a mesh whose axis z points up. Raises
    `BrdfkitError` for anything else.
    """
    if callable(given):
        return given
    file = split_part(given)[0] if isinstance(given, str | Path) and str(given) else given
    place = find_file_or_name(file, "scene", scene_names())
    if isinstance(place, str):
        return find_scene_by_name(place)
    suffix = suffix_of(given)
    if suffix == scene_file.SUFFIX:
        return scene_file.make_scene_builder(given)
    if suffix in mesh_file.SUFFIXES:
        return mesh_file.mesh_scene(given)
    raise BrdfkitError(
        f"{given}: a scene is a mesh (.obj, .ply), a scene file (.xml), or one of "
        f"{', '.join(scene_names())}."
    )


def _require_scene(loaded):
    """Raise `BrdfkitError` unless what was loaded is a scene that can be rendered."""
    import mitsuba as mi

    if not isinstance(loaded, mi.Scene):
        raise BrdfkitError(
            f"The function for the scene gives {type(loaded).__name__}; it should give the "
            "dictionary of a scene: {'type': 'scene', ...}."
        )
    if not loaded.sensors() or loaded.integrator() is None:
        raise BrdfkitError("The scene has no sensor or no integrator; add them to its dictionary.")


def suffix_of(given):
    """The suffix of a scene's file, "" for the name of a scene."""
    return Path(str(given).partition("#")[0]).suffix.lower()
