"""Loads the scene that `refine` works on, with an integrator that can be differentiated."""

import re
from pathlib import Path
from typing import Any

from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.resolve import to_material
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.mitsuba_bridge.scene_file import SUFFIX, load_scene_file
from brdfkit.model import Model
from brdfkit.regression import Fit
from brdfkit.rendering.scenes.ball import ball

# Class of an integrator without derivatives → plugin that renders the same light with derivatives
DIFFERENTIABLE = {
    "PathIntegrator": "prb",
    "DirectIntegrator": "prb",
    "VolumetricPathIntegrator": "prbvolpath",
    "VolumetricMisPathIntegrator": "prbvolpath",
}


def load_scene(thing: Any, size: tuple[int, int]) -> MitsubaObject:
    """Return the Mitsuba scene that a user gave, loaded if it is a file or a dictionary.

    `thing` is a scene, its dictionary or .xml file, or a material, which is then put on the ball of
    `brdfkit.render`, in pictures of `size` (width, height). Raises `BrdfkitError` for what Mitsuba
    cannot load, and for a scene without a sensor.
    """
    import mitsuba as mi

    if isinstance(thing, mi.Scene):
        scene = thing
    elif isinstance(thing, str | Path) and Path(thing).suffix == SUFFIX:
        scene = load_scene_file(thing, optimize=False)
    elif isinstance(thing, dict) and thing.get("type") == "scene":
        scene = _load_dictionary(thing, "the scene")
    else:
        material = to_material(thing)
        scene = _load_dictionary(ball(_convert_weights_to_colours(material), size), material.name)
    if not scene.sensors():
        raise BrdfkitError("the scene has no sensor; add one.")
    return scene


def make_integrator(scene: MitsubaObject) -> MitsubaObject:
    """Return the scene's integrator, or one that renders the same light and has derivatives.

    Raises `BrdfkitError` for an integrator of Mitsuba without derivatives and without such a
    counterpart.
    """
    import mitsuba as mi

    integrator = scene.integrator()
    if integrator is None:
        raise BrdfkitError('the scene has no integrator; add {"type": "prb"}.')
    kind = integrator.class_name() if type(integrator).__module__ == "mitsuba" else ""
    if kind in DIFFERENTIABLE:
        options = {
            "hide_emitters": integrator.hide_emitters,
            **_read_depth_limits(integrator, kind),
        }
        return mi.load_dict({"type": DIFFERENTIABLE[kind], **options})
    if kind:
        raise BrdfkitError(
            f"the integrator {kind} has no derivatives; choose prb, prbvolpath, or one of "
            "brdfkit's."
        )
    return integrator


def _read_depth_limits(integrator: MitsubaObject, kind: str) -> dict[str, int]:
    """Return the path length limits max_depth and rr_depth of an integrator of class `kind`."""
    if kind == "DirectIntegrator":
        return {"max_depth": 2}
    depths = dict(re.findall(r"(max_depth|rr_depth) = (-?\d+)", str(integrator)))
    # An unlimited depth, -1, is printed by Mitsuba as the largest unsigned number
    return {name: int(number) if int(number) < 2**31 else -1 for name, number in depths.items()}


def _load_dictionary(scene: dict[str, Any], name: str) -> MitsubaObject:
    """Load a scene's dictionary without merging equal BSDFs, because names would be lost."""
    import mitsuba as mi

    return load_by_mitsuba(
        lambda entries, **options: mi.load_dict(entries, optimize=False, **options), scene, name
    )


def _convert_weights_to_colours(material: Any) -> dict[str, Any]:
    """Return a material's dictionary in which each lobe's weight is a colour.

    A weight that is a single number would stay grey in the search, but materials are coloured.
    """
    entries: dict[str, Any] = material.scene_dict()
    model = material.model if isinstance(material, Fit) else material
    if isinstance(model, Model):
        for name in model.weights():
            if isinstance(entries.get(name), float):
                entries[name] = {"type": "rgb", "value": [entries[name]] * 3}
    return entries
