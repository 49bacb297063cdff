"""Describes the scene of a volume for Mitsuba: the integrator with the volume, light and camera."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from brdfkit.core.errors import no_such_error
from brdfkit.materials.resolve import to_material
from brdfkit.rendering.scene_input.environment import describe_environment
from brdfkit.rendering.scenes._studio import make_camera
from brdfkit.rendering.volumes import defaults
from brdfkit.rendering.volumes.camera import FOV, camera_direction, place_camera
from brdfkit.volumes import TransferFunction, Volume

# For each renderer, an integrator plugin, the name of its parameter that receives the volume
RENDERERS = {
    "single_scattering": "extinction",
    "emission_absorption": "extinction",
    "maximum_intensity": "volume",
    "isosurface": "volume",
}
UNLIT = "emission_absorption", "maximum_intensity"  # renderers without light from outside
# Illuminance that the light of each renderer gives level ground. Light that a volume scatters once
# is darker than light from a surface, so it needs more light to look as bright
ILLUMINANCES = {"single_scattering": 10.0, "isosurface": 3.0}
LEAST_STEPS = 64  # smallest number of steps along a ray
TURN_AZIMUTHS = range(0, 360, 15)  # azimuths [degrees] at which all of a volume must be in a film


def describe_scene(
    volume: Volume,
    transfer: TransferFunction | None,
    renderer: str,
    size: tuple[int, int],
    view: tuple[float, float],
    light: tuple[str | Path, ArrayLike | None],
    settings: Mapping[str, Any],
    all_around: bool = False,
) -> dict[str, Any]:
    """Return the dictionary of the scene that shows a volume.

    Without a transfer function the scene shows the surface of one level. `size` is (width, height)
    [pixels], `view` (azimuth, elevation) [degrees], and `light` (environment, background radiance).
    `settings` are further parameters of the integrator; a background among them replaces that of
    `light`. With `all_around` the camera is so far away that nothing would be cut off at any
    azimuth.
    """
    towards, (width, height) = camera_direction(volume, *view), size
    environment, background = light
    entries = describe_integrator(volume, transfer, renderer, settings)
    if background is not None:
        rgb = np.broadcast_to(background, 3).tolist()
        entries.setdefault("background", {"type": "rgb", "value": rgb})
    is_visible = defaults.make_visibility_test(transfer, entries.get("level", 0))
    others = TURN_AZIMUTHS if all_around else ()
    sides = [towards, *(camera_direction(volume, azimuth, view[1]) for azimuth in others)]
    origin, target = place_camera(volume, is_visible, sides, width / height)
    # The near and far planes are multiples of the distance, as volumes have any unit of length
    distance = float(np.linalg.norm(origin - target))
    clipping = {"near_clip": 1e-3 * distance, "far_clip": 1e3 * distance}
    scene = {
        "type": "scene",
        "integrator": entries,
        "sensor": make_camera(origin, target, FOV, size) | clipping,
    }
    if renderer in UNLIT:
        return scene
    sky = describe_environment(environment)
    return scene | {"sky": sky | {"scale": sky["scale"] * ILLUMINANCES[renderer]}}


def describe_integrator(
    volume: Volume,
    transfer: TransferFunction | None,
    renderer: str,
    settings: Mapping[str, Any],
) -> dict[str, Any]:
    """Return the dictionary of the integrator, which contains the volume.

    `settings` are further parameters of the integrator. Raises `BrdfkitError` for an unknown
    renderer.
    """
    if renderer not in RENDERERS:
        raise no_such_error("renderer", renderer, RENDERERS)
    steps = max(LEAST_STEPS, *volume.size)
    entries = describe_renderer(renderer, volume.scene_dict(transfer), steps)
    if renderer == "isosurface":
        entries["level"] = defaults.choose_surface_level(volume) if transfer is None else 0.5
    return entries | {name: _to_plugin_value(name, value) for name, value in settings.items()}


def describe_renderer(renderer: str, contents: Any, steps: int) -> dict[str, Any]:
    """Return the dictionary of a renderer's integrator, with its default settings.

    `contents` is the volume for Mitsuba, and `steps` the number of parts that a ray is cut into.
    """
    entries: dict[str, Any] = {"type": renderer, RENDERERS[renderer]: contents}
    if renderer != "single_scattering":
        entries["steps"] = steps
    if renderer == "emission_absorption":
        entries["jitter"] = True
    if renderer == "isosurface":
        entries |= {"bsdf": defaults.CLAY, "shadows": True}
    return entries


def _to_plugin_value(name: str, value: Any) -> Any:
    """Convert a user's setting for Mitsuba: BSDFs and phase functions become dictionaries."""
    if name == "bsdf":
        return to_material(value).scene_dict()
    return {"type": value} if name == "phase" and isinstance(value, str) else value
