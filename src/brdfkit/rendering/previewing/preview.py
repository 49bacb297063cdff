"""`preview`: pictures of materials under an environment, without noise.

The integrator `filtered_environment` sees every pixel with the same directions. What takes long is
kept between calls: the filtered light, materials, the shape and what casts its shadows. So the
first picture takes seconds, and the next ones about a tenth of a second.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from functools import lru_cache
from math import isqrt
from pathlib import Path

import numpy as np

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.memory import require_memory
from brdfkit.lighting.environments.map_files import find_map
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.rendering.previewing.cache import bsdf_of, keep
from brdfkit.rendering.previewing.staging import Shape, stage
from brdfkit.rendering.progressive import rgb
from brdfkit.rendering.render_materials import to_size
from brdfkit.rendering.result import Rendering
from brdfkit.rendering.scene_input import mesh_file
from brdfkit.rendering.scene_input.arguments import (
    Renderable,
    as_list,
    mitsuba,
    name_all,
    parameters_of,
)
from brdfkit.rendering.scene_input.environment import environment as light_of
from brdfkit.rendering.scene_input.environment import on_ground
from brdfkit.rendering.scene_input.loading import suffix_of
from brdfkit.rendering.scene_input.shown_material import mask
from brdfkit.rendering.scenes._studio import GROUND

STUDIO, SIZE, SPP = "studio", 256, 4
SHADOWS = {False: "no shadows", True: "approximate shadows"}


def preview(
    materials: Renderable | Iterable[Renderable],
    *,
    spp: int = SPP,
    size: int | tuple[int, int] = SIZE,
    scene: str | Path = "ball",
    environment: str | Path = STUDIO,
    method: str = "filtered_sampling",
    shadows: bool = False,
) -> Rendering:
    """Show one or several materials under an environment, without noise.

    A preview contains the light that a material reflects directly from the environment, but no
    light between surfaces. Equal calls give equal pictures. The first call in a process takes
    seconds, because it filters the light, compiles, and evaluates a measured material at many
    directions; later ones take about a tenth of a second at 256 pixels, without shadows.

    Parameters
    ----------
    materials : Measured, Fit, Model, str, Path, dict or (str, one of these), or several
        The materials, as `render` takes them; the first is the reference.
    spp : int, default 4
        Rays per pixel, a square number; more make edges smoother. A spectral variant needs 9, or a
        larger odd square: with fewer, all rays have the same four wavelengths.
    size : int or (int, int), default 256
        Side, or width and height, of a picture [pixels].
    scene : str or Path, default "ball"
        A scene of `render` without lamps of its own, or a mesh (.obj, .ply; "FILE.obj#z" if its
        z axis points up).
    environment : str or Path, default "studio"
        An environment map by latitude and longitude: its name or its file. It is scaled to the
        illuminance of the scenes of `render`.
    method : str, default "filtered_sampling"
        A method of the integrator `filtered_environment`. "gmm" is more exact, but first fits lobes
        to a material, which takes seconds.
    shadows : bool, default False
        Whether to show the ground as well, with the shadows on it and on the shape, and the light
        that it reflects. A picture takes 10 to 20 times as long: half to once the time of 64
        path-traced samples, which are noisy but contain all light.

    Returns
    -------
    Rendering
        The pictures; ``write`` makes an OpenEXR file of all, or a PNG to look at.

    Raises
    ------
    BrdfkitError
        For what cannot be shown, for an environment or a method that is unknown, and for another
        number of rays.

    Examples
    --------
    >>> preview(["car_paint", "ggx"]).write("paint.png")    # doctest: +SKIP
    >>> preview("ward", environment="probe.exr", scene="teapot.obj", size=512)    # doctest: +SKIP
    """
    size, subjects = to_size(size), [keep(thing) for thing in as_list(materials)]
    spp = to_whole_number("spp", spp, least=1)
    require_memory(size, len(subjects))
    mitsuba()  # sets a variant, on which the dictionaries depend
    _require_rays(spp)
    if not isinstance(scene, str | Path):
        raise BrdfkitError(f"scene = {scene!r:.60} should be a scene's name or a mesh's file.")
    return _show(name_all(subjects), environment, size, scene, method, spp, bool(shadows))


def _require_rays(spp):
    """Raise `BrdfkitError` for rays per pixel that make no even grid, or too few wavelengths.

    A ray has four wavelengths, a quarter of the range apart. An even grid of an even number of rays
    repeats them.
    """
    import mitsuba as mi

    if isqrt(spp) ** 2 != spp:
        raise BrdfkitError(f"spp = {spp} should be a square number, such as 4 or 9.")
    if mi.is_spectral and (spp < 9 or spp % 2 == 0):
        raise BrdfkitError(
            f"spp = {spp} makes wrong colours in {mi.variant()}; take 9 or 25, or set llvm_ad_rgb."
        )


@in_turn
def _show(materials, environment, size, scene, method, spp, shadows):
    """The `Rendering` of materials by name."""
    import mitsuba as mi

    start, variant = time.perf_counter(), mi.variant()
    shape = _shape(variant, scene, _changed(str(scene).partition("#")[0]))
    light = _light(variant, environment, _changed(find_map(environment)), shadows)
    integrator = _integrator(variant, method, shadows)
    both_sides = suffix_of(scene) in mesh_file.SUFFIXES
    pictures, seen = {}, None
    for name, found in materials.items():
        material = bsdf_of(found, name, variant, both_sides)
        staged = stage(shape.build(material, size), light, integrator, spp, ground=shadows)
        loaded = load_by_mitsuba(mi.load_dict, staged, name)
        if shadows:
            integrator.casters.set(loaded, None, shape.casters)
        seen = mask(loaded, material) if seen is None else seen
        with raise_first_cause():
            pictures[name] = rgb(integrator.render(loaded, seed=0, spp=spp)).astype(np.float32)
    first, seconds = next(iter(pictures.values())), time.perf_counter() - start
    parameters = parameters_of(materials)
    return Rendering(
        pictures, spp, seconds, 0, parameters, seen, spp, first, shadows=SHADOWS[shadows]
    )


def _changed(path):
    """When a file was changed; None for a name."""
    return Path(path).stat().st_mtime_ns if Path(path).is_file() else None


@lru_cache(maxsize=4)
def _light(variant, environment, changed, ground):
    """The emitter of an environment map, whose file was `changed` at a time; its lower half is the
    `ground` in its light, or its own."""
    import mitsuba as mi

    light = light_of(environment)
    light = on_ground(light, GROUND) if ground else light
    return load_by_mitsuba(mi.load_dict, light, environment)


@lru_cache(maxsize=4)
def _integrator(variant, method, shadows):
    """The integrator, which keeps the light that it has filtered."""
    import mitsuba as mi

    entries = {"type": "filtered_environment", "method": method}
    entries["shadows"] = "shapes" if shadows else "none"
    return load_by_mitsuba(mi.load_dict, entries, entries["type"])


@lru_cache(maxsize=4)
def _shape(variant, scene, changed):
    """The `Shape` of a scene, whose file was `changed` at a time."""
    return Shape(scene)
