"""`preview`: pictures of materials under an environment map, without noise.

The integrator `filtered_environment` uses the same directions in every pixel. Whatever takes long
to prepare is kept between calls: the filtered light, the materials, the shape and its shadow
casters. So the first picture takes seconds, and later ones about a tenth of a second.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from functools import lru_cache
from math import isqrt
from pathlib import Path

import numpy as np

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.memory import require_memory
from brdfkit.lighting.environments.map_files import find_map
from brdfkit.materials.resolve import Material
from brdfkit.mitsuba_bridge.properties.picture_file import load_by_mitsuba
from brdfkit.rendering.evidence import find_picture_evidence
from brdfkit.rendering.previewing.cache import load_bsdf, load_material_through_cache
from brdfkit.rendering.previewing.scene import PreviewShape, describe_preview
from brdfkit.rendering.progressive import to_rgb
from brdfkit.rendering.render_materials import to_picture_size
from brdfkit.rendering.result import Rendering
from brdfkit.rendering.scene_input import mesh_file
from brdfkit.rendering.scene_input.arguments import (
    Renderable,
    collect_parameters,
    load_mitsuba,
    load_named_materials,
    to_material_list,
)
from brdfkit.rendering.scene_input.environment import describe_environment, replace_lower_half
from brdfkit.rendering.scene_input.loading import find_scene_suffix
from brdfkit.rendering.scene_input.material import find_material_mask
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
    """Show one or several materials under an environment map, without noise.

    A preview contains the light that a material reflects directly from the environment, but no
    light that surfaces reflect to each other. Equal calls give equal pictures. The first call in a
    process takes seconds, because it filters the light, compiles, and evaluates a measured material
    at many directions; later ones take about a tenth of a second at 256 pixels, without shadows.

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
        The name of a scene without lamps of its own, or a mesh (.obj, .ply; "FILE.obj#z" if its
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
        For a material or scene that cannot be shown, for an unknown environment or method, and for
        a number of rays that is not a square.

    Examples
    --------
    >>> preview(["car_paint", "ggx"]).write("paint.png")    # doctest: +SKIP
    >>> preview("ward", environment="probe.exr", scene="teapot.obj", size=512)    # doctest: +SKIP
    """
    size, subjects = (
        to_picture_size(size),
        [load_material_through_cache(subject) for subject in to_material_list(materials)],
    )
    spp = to_whole_number("spp", spp, least=1)
    require_memory(size, len(subjects))
    load_mitsuba()  # it sets Mitsuba's variant, on which the dictionaries of BSDFs below depend
    _require_valid_ray_count(spp)
    if not isinstance(scene, str | Path):
        raise BrdfkitError(f"scene = {scene!r:.60} should be a scene's name or a mesh's file.")
    return _render_preview(
        load_named_materials(subjects), environment, size, scene, method, spp, bool(shadows)
    )


def _require_valid_ray_count(spp: int) -> None:
    """Raise `BrdfkitError` if `spp` rays per pixel make no square grid, or give wrong colours.

    Colours are wrong in spectral variants if all rays of a pixel have the same wavelengths: each
    ray has four, a quarter of the range apart, and an even number of rays repeats them.
    """
    import mitsuba as mi

    if isqrt(spp) ** 2 != spp:
        raise BrdfkitError(f"spp = {spp} should be a square number, such as 4 or 9.")
    if mi.is_spectral and (spp < 9 or spp % 2 == 0):
        raise BrdfkitError(
            f"spp = {spp} makes wrong colours in {mi.variant()}; take 9 or 25, or set llvm_ad_rgb."
        )


@in_turn
def _render_preview(
    materials: dict[str, Material],
    environment: str | Path,
    size: tuple[int, int],
    scene: str | Path,
    method: str,
    spp: int,
    shadows: bool,
) -> Rendering:
    """Render the preview of `materials`, which are given by name, with `spp` rays per pixel."""
    import mitsuba as mi

    start, variant = time.perf_counter(), str(mi.variant())
    shape = _load_shape(variant, scene, _find_time_of_change(str(scene).partition("#")[0]))
    changed = _find_time_of_change(find_map(environment))
    light = _load_light(variant, environment, changed, shadows)
    integrator = _load_integrator(variant, method, shadows)
    both_sides = find_scene_suffix(scene) in mesh_file.SUFFIXES
    pictures: dict[str, FloatArray] = {}
    mask, evidence = None, {}
    for name, subject in materials.items():
        material = load_bsdf(subject, name, variant, both_sides)
        built = shape.build(material, size)
        described = describe_preview(built, light, integrator, spp, ground=shadows)
        loaded = load_by_mitsuba(mi.load_dict, described, name)
        if shadows:
            integrator.casters.set_casters(loaded, None, shape.casters)
        if mask is None:
            mask = find_material_mask(loaded, material)
            evidence = find_picture_evidence(materials, loaded, mask)
        with raise_first_cause():
            pictures[name] = to_rgb(integrator.render(loaded, seed=0, spp=spp)).astype(np.float32)
    first, seconds = next(iter(pictures.values())), time.perf_counter() - start
    parameters = collect_parameters(materials)
    return Rendering(
        pictures,
        spp,
        seconds,
        0,
        parameters,
        mask,
        spp,
        first,
        shadows=SHADOWS[shadows],
        evidence=evidence,
    )


def _find_time_of_change(path: str | Path) -> int | None:
    """Return the time at which a file was changed [ns], or None if the path is not a file."""
    return Path(path).stat().st_mtime_ns if Path(path).is_file() else None


@lru_cache(maxsize=4)
def _load_light(
    variant: str, environment: str | Path, changed: int | None, ground: bool
) -> MitsubaObject:
    """Load the emitter of an environment map; with `ground` its lower half shows lit ground.

    The emitter is kept in memory. `variant` and `changed`, the time of change of the map's file,
    are keys of the cache only.
    """
    import mitsuba as mi

    light = describe_environment(environment)
    light = replace_lower_half(light, GROUND) if ground else light
    return load_by_mitsuba(mi.load_dict, light, environment)


@lru_cache(maxsize=4)
def _load_integrator(variant: str, method: str, shadows: bool) -> MitsubaObject:
    """Load the integrator of previews, and keep it in memory with the light that it has filtered.

    The `variant` of Mitsuba is a key of the cache only.
    """
    import mitsuba as mi

    entries = {"type": "filtered_environment", "method": method}
    entries["shadows"] = "shapes" if shadows else "none"
    return load_by_mitsuba(mi.load_dict, entries, entries["type"])


@lru_cache(maxsize=4)
def _load_shape(variant: str, scene: str | Path, changed: int | None) -> PreviewShape:
    """Load the shape of a scene or a mesh, and keep it in memory.

    `variant` and `changed`, the time of change of the mesh's file, are keys of the cache only.
    """
    return PreviewShape(scene)
