"""Loads the scene of a rendering, from a name, a file or a function, once for each material."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from brdfkit.core.array_types import BoolArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.locate import find_file_or_name, split_file_and_part
from brdfkit.lighting.environments.map_files import find_map
from brdfkit.mitsuba_bridge import scene_file
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.rendering.scene_input import mesh_file
from brdfkit.rendering.scene_input.environment import describe_environment, replace_light
from brdfkit.rendering.scene_input.material import find_material_mask, load_material
from brdfkit.rendering.scenes import find_scene as find_scene_by_name
from brdfkit.rendering.scenes import scene_names

SIZE = 512, 512  # default width and height of a picture [pixels]


def load_scenes(
    materials: Mapping[str, dict[str, Any]],
    scene: Any,
    size: tuple[int, int] | None = None,
    environment: str | Path | None = None,
) -> tuple[dict[str, MitsubaObject], BoolArray | None]:
    """Load a scene once for each material; return the scenes, and a mask of the pixels that matter.

    The scenes are `mitsuba.Scene`s, by the names of the materials. The mask (height, width) is True
    in pixels that show the material; it is None if `scene` is a function, which receives the BSDF
    dictionary itself.

    materials : BSDF dictionaries by name.
    scene : a scene's name, file or function, as `find_scene` takes it.
    size : (width, height) [pixels]; by default 512 × 512, or the size in a scene file.
    environment : the name or file of an environment map that replaces the scene's light.

    Raises `BrdfkitError` for anything that cannot be loaded.
    """
    import mitsuba as mi

    build, suffix = find_scene(scene), "" if callable(scene) else find_scene_suffix(scene)
    if suffix != scene_file.SUFFIX:
        size = size or SIZE
    light = None if environment is None else describe_environment(environment)
    scenes: dict[str, MitsubaObject] = {}
    mask, sky = None, None
    for name, bsdf in materials.items():
        material = None if callable(scene) else load_material(bsdf, name, both_sides=bool(suffix))
        built = build(material or bsdf, size)
        built = replace_light(light, built) if light else built
        if material and isinstance(built, dict) and "sky" in built:
            # All scenes share one emitter: with another emitter, kernels would be compiled again
            sky = sky or load_by_mitsuba(mi.load_dict, built["sky"], name)
            built["sky"] = sky
        loaded = load_by_mitsuba(mi.load_dict, built, name) if isinstance(built, dict) else built
        _require_mitsuba_scene(loaded)
        if material and not scenes:
            mask = find_material_mask(loaded, material)
        scenes[name] = loaded
    return scenes, mask


def require_scene(scene: Any, environment: str | Path | None = None) -> None:
    """Raise `BrdfkitError` if a scene or an environment map does not exist.

    So a long computation can fail before it begins.
    """
    find_scene(scene)
    if environment is not None:
        find_map(environment)


def find_scene(scene: Any) -> Callable[..., Any]:
    """Return the function that makes a scene's dictionary from a BSDF and (width, height).

    `scene` is such a function, the name of a scene, a mesh ("FILE.obj", "FILE.ply", or "FILE.obj#z"
    if its z axis points up), or a scene file ("FILE.xml", or "FILE.xml#ID" with the id of the BSDF
    to replace). Raises `BrdfkitError` for anything else.
    """
    if callable(scene):
        return scene
    file = split_file_and_part(scene)[0] if isinstance(scene, str | Path) and str(scene) else scene
    place = find_file_or_name(file, "scene", scene_names())
    if isinstance(place, str):
        return find_scene_by_name(place)
    suffix = find_scene_suffix(scene)
    if suffix == scene_file.SUFFIX:
        return scene_file.make_scene_builder(scene)
    if suffix in mesh_file.SUFFIXES:
        return mesh_file.make_mesh_scene(scene)
    raise BrdfkitError(
        f"{scene}: a scene is a mesh (.obj, .ply), a scene file (.xml), or one of "
        f"{', '.join(scene_names())}."
    )


def _require_mitsuba_scene(loaded: Any) -> None:
    """Raise `BrdfkitError` unless `loaded` is a `mitsuba.Scene` that can be rendered."""
    import mitsuba as mi

    if not isinstance(loaded, mi.Scene):
        raise BrdfkitError(
            f"The function for the scene gives {type(loaded).__name__}; it should give the "
            "dictionary of a scene: {'type': 'scene', ...}."
        )
    if not loaded.sensors() or loaded.integrator() is None:
        raise BrdfkitError("The scene has no sensor or no integrator; add them to its dictionary.")


def find_scene_suffix(scene: str | Path) -> str:
    """Return the suffix of a scene's file, such as ".obj"; "" for the name of a scene."""
    return Path(str(scene).partition("#")[0]).suffix.lower()
