"""`preview`: pictures of materials under an environment, without noise and without shadows.

The integrator `filtered_environment` sees every pixel with the same directions. It and the light
are kept between calls: the light is then filtered once, and a picture takes milliseconds.
"""

import time
from collections.abc import Iterable
from functools import lru_cache
from math import isqrt
from pathlib import Path

import numpy as np

from brdfkit.arguments import to_whole_number
from brdfkit.environments.map_files import find
from brdfkit.errors import BrdfkitError
from brdfkit.host.load_by_mitsuba import load_by_mitsuba
from brdfkit.jit.threads import in_turn
from brdfkit.rendering import users_mesh
from brdfkit.rendering.environment import environment as light_of
from brdfkit.rendering.environment import light_by
from brdfkit.rendering.inputs import Renderable, as_list, describe_all, mitsuba
from brdfkit.rendering.memory import require_memory
from brdfkit.rendering.rendering import to_size
from brdfkit.rendering.result import Rendering
from brdfkit.rendering.scene_loading import find_scene
from brdfkit.rendering.shown_material import load_material, mask
from brdfkit.rendering.tracing import rgb

STUDIO, SIZE, SPP = "studio", 256, 4


def preview(
    things: Renderable | Iterable[Renderable],
    envmap: str | Path = STUDIO,
    size: int | tuple[int, int] = SIZE,
    scene: str | Path = "ball",
    method: str = "filtered_sampling",
    spp: int = SPP,
) -> Rendering:
    """Show one or several materials under an environment, without noise, in milliseconds.

    The light that a material reflects straight from the environment; shadows, and light between
    surfaces, are missing. Equal calls give equal pictures. The first call takes seconds: it filters
    the light and compiles.

    Parameters
    ----------
    things : Measured, Fit, Model, str, Path, dict or (str, one of these), or several
        The materials, as `render` takes them; the first is the reference.
    envmap : str or Path, default "studio"
        An environment map by latitude and longitude: the name of one that brdfkit knows, or a file.
        It is scaled to the illuminance that the scenes of `render` have.
    size : int or (int, int), default 256
        Side, or width and height, of a picture [pixels].
    scene : str or Path, default "ball"
        What is seen: a scene of `render`, without its ground and its own light, or a mesh (.obj,
        .ply).
    method : str, default "filtered_sampling"
        How light and material meet, a method of the integrator `filtered_environment`: "gmm" is
        more exact, and fits lobes to a material first, which takes seconds.
    spp : int, default 4
        Rays per pixel, a square number, which make edges smooth. A spectral variant needs 9, or a
        larger odd one: with fewer, all rays have the same four wavelengths.

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
    >>> preview("ward", envmap="probe.exr", scene="teapot.obj", size=512)    # doctest: +SKIP
    """
    size, subjects = to_size(size), as_list(things)
    spp = to_whole_number("spp", spp, least=1)
    require_memory(size, len(subjects))
    mitsuba()  # sets a variant, on which the dictionaries depend
    _require_rays(spp)
    materials, parameters = describe_all(subjects)
    return _show(materials, parameters, envmap, size, scene, method, spp)


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
def _show(materials, parameters, envmap, size, scene, method, spp):
    """The `Rendering` of BSDFs' dictionaries by name, and of their parameters' values."""
    import mitsuba as mi

    start, build = time.perf_counter(), find_scene(scene)
    light = _light(mi.variant(), envmap, find(envmap).stat().st_mtime_ns)
    integrator = _integrator(mi.variant(), method)
    both_sides = Path(scene).suffix.lower() in users_mesh.SUFFIXES
    pictures, seen = {}, None
    for name, bsdf in materials.items():
        material = load_material(bsdf, name, both_sides)
        staged = stage(build(material, size), light, integrator, spp)
        loaded = load_by_mitsuba(mi.load_dict, staged, name)
        seen = mask(loaded, material) if seen is None else seen
        pictures[name] = rgb(integrator.render(loaded, seed=0, spp=spp)).astype(np.float32)
    first, seconds = next(iter(pictures.values())), time.perf_counter() - start
    return Rendering(pictures, spp, seconds, 0, parameters, seen, spp, first, shadows=False)


@lru_cache(maxsize=4)
def _light(variant, envmap, changed):
    """The emitter of an environment map, whose file was `changed` at a time."""
    import mitsuba as mi

    return load_by_mitsuba(mi.load_dict, light_of(envmap), envmap)


@lru_cache(maxsize=4)
def _integrator(variant, method):
    """The integrator, which keeps the light that it has filtered."""
    import mitsuba as mi

    entries = {"type": "filtered_environment", "method": method}
    return load_by_mitsuba(mi.load_dict, entries, "preview")


def stage(scene, light, integrator, spp):
    """The dictionary of a scene without its ground, under another light.

    Its rays go through the middles of pixels, or of equal parts of them: nothing is random. Raises
    `BrdfkitError` for a scene that has no sky in whose place the light could be.
    """
    if not isinstance(scene, dict) or "sky" not in scene:
        raise BrdfkitError(
            "A preview shows a shape: name a scene under the sky, such as ball or knot, or a mesh."
        )
    sensor = dict(scene["sensor"])
    sensor["film"] = sensor["film"] | {"rfilter": {"type": "box"}}
    sensor["sampler"] = {"type": "stratified", "jitter": False, "sample_count": spp}
    kept = {key: part for key, part in light_by(light, scene).items() if key != "ground"}
    return kept | {"sensor": sensor, "integrator": integrator}
