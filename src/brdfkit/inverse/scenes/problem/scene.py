"""What is refined, as a scene of Mitsuba's whose integrator has derivatives."""

import re
from pathlib import Path
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.resolve import to_material
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.mitsuba_bridge.scene_file import SUFFIX, load_scene_file
from brdfkit.model import Model
from brdfkit.regression import Fit
from brdfkit.rendering.scenes.ball import ball

# Integrators without derivatives of their own, and the one that sees the same with them
DIFFERENTIABLE = {
    "PathIntegrator": "prb",
    "DirectIntegrator": "prb",
    "VolumetricPathIntegrator": "prbvolpath",
    "VolumetricMisPathIntegrator": "prbvolpath",
}


def load_subject(thing: Any, size: tuple[int, int]) -> Any:
    """The `mitsuba.Scene` that `thing` is or stands for: a scene's dictionary or file, or a
    material, which is put on the ball of `brdfkit.render`, seen in pictures of `size` (width,
    height).

    Raises `BrdfkitError` for what Mitsuba cannot load, and for a scene without a sensor.
    """
    import mitsuba as mi

    if isinstance(thing, mi.Scene):
        scene = thing
    elif isinstance(thing, str | Path) and Path(thing).suffix == SUFFIX:
        scene = load_scene_file(thing, optimize=False)
    elif isinstance(thing, dict) and thing.get("type") == "scene":
        scene = _load(thing, "the scene")
    else:
        found = to_material(thing)
        scene = _load(ball(_coloured(found), size), found.name)
    if not scene.sensors():
        raise BrdfkitError("the scene has no sensor to see it with; add one.")
    return scene


def integrator_of(scene):
    """The scene's integrator, or one that sees the same and has derivatives.

    Raises `BrdfkitError` for one that has none.
    """
    import mitsuba as mi

    integrator = scene.integrator()
    if integrator is None:
        raise BrdfkitError('the scene has no integrator; add {"type": "prb"}.')
    kind = integrator.class_name() if type(integrator).__module__ == "mitsuba" else ""
    if kind in DIFFERENTIABLE:
        how = {"hide_emitters": integrator.hide_emitters, **_depths(str(integrator), kind)}
        return mi.load_dict({"type": DIFFERENTIABLE[kind], **how})
    if kind:
        raise BrdfkitError(
            f"the integrator {kind} has no derivatives; choose prb, prbvolpath, or one of "
            "brdfkit's."
        )
    return integrator


def _depths(described, kind):
    """The depths of an integrator, as `described` by itself."""
    if kind == "DirectIntegrator":
        return {"max_depth": 2}
    found = dict(re.findall(r"(max_depth|rr_depth) = (-?\d+)", described))
    # Mitsuba prints an endless depth as the largest number
    return {name: int(number) if int(number) < 2**31 else -1 for name, number in found.items()}


def _load(scene, name):
    """Load a dictionary, equal BSDFs apart, lest names change."""
    import mitsuba as mi

    return load_by_mitsuba(
        lambda entries, **how: mi.load_dict(entries, optimize=False, **how), scene, name
    )


def _coloured(found):
    """The dictionary of a material whose weights have a number for each colour."""
    entries = found.scene_dict()
    model = found.model if isinstance(found, Fit) else found
    if isinstance(model, Model):
        for name in model.weights():
            if isinstance(entries.get(name), float):
                entries[name] = {"type": "rgb", "value": [entries[name]] * 3}
    return entries
