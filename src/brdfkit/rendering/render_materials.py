"""`render`: path-traced pictures of materials, in the same scene and with the same samples.

The first picture is the reference, usually of the measured material. Each pass renders every
picture once, so that after Ctrl-C all pictures have equally many samples.
"""

from collections.abc import Callable, Iterable
from pathlib import Path
from types import FunctionType
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.arguments import to_positive, to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.memory import require_memory
from brdfkit.distance_fields import Node, from_function
from brdfkit.mitsuba_bridge.scene_file import load_scene_file
from brdfkit.rendering.result import Rendering
from brdfkit.rendering.scene_input import field
from brdfkit.rendering.scene_input.arguments import Renderable, as_list, describe_all, mitsuba
from brdfkit.rendering.scene_input.loading import SIZE, load_scenes
from brdfkit.rendering.tracing import trace

SPP = 256  # samples per pixel
MOST = 16_384  # of them, where a noise floor is asked for
SceneLike: TypeAlias = str | Path | Callable[[dict[str, Any], tuple[int, int]], dict[str, Any]]


def render(
    things: Renderable | Iterable[Renderable] | Node | Callable[[Any], Any],
    spp: int | None = None,
    size: int | tuple[int, int] | None = None,
    seed: int = 0,
    scene: SceneLike = "ball",
    progress: Callable[..., object] | None = None,
    until: float | None = None,
    envmap: str | Path | None = None,
) -> Rendering:
    """Path-trace one or several materials in the same scene, with the same samples.

    It runs in the current variant of Mitsuba; where none is set, in the best that works. Ctrl-C
    keeps the passes that every picture has; before the first of them it is raised. Renders of
    several threads run one after the other.

    Parameters
    ----------
    things : Measured, Fit, Model, str, Path, dict or (str, one of these), or several
        The materials, the reference first: objects, names or paths, BSDFs' dictionaries, which may
        hold a "name", or pairs of a name and one of these. Or a field of
        `brdfkit.distance_fields`, which is shown alone, under lamps with soft shadows; its parts
        may have materials' names, `field.made_of("car_paint")`. A function of points is
        such a field, too: see `brdfkit.distance_fields.from_function`.
    spp : int, optional
        Samples per pixel, by default 256; with `until`, the most of them, by default 16,384.
    size : int or (int, int), optional
        Side, or width and height, of a picture [pixels]; by default 512, or what a scene file has.
    seed : int, default 0
        Seed of the samples; equal seeds give equal pictures, up to the order in which threads sum
        up (1e-6).
    scene : str, Path or callable, default "ball"
        A scene's name, which `brdfkit render --help` lists; a mesh (.obj, .ply) in the ball's
        place, "FILE.obj#z" where its axis z points up, which is else guessed, with a warning
        where it is not y; a scene file "FILE.xml#ID", with the id of the BSDF that the materials
        replace, by default "material"; or a function that gives a scene's dictionary for (BSDF's
        dictionary, (width, height)).
    progress : callable, optional
        Called with (done, total) after each pass of a picture; with `until`, the total is a guess
        that improves. One with a parameter `pictures` also gets a function: ``pictures()`` is those
        so far, by name, linear sRGB, and costs nothing where it is not called.
    until : float, optional
        Adds samples until the noise floor, the PSNR of the reference to itself with another seed,
        is so high [dB, above 0]; 45 leaves noise that is hardly seen.
    envmap : str or Path, optional
        An environment map in the place of sky and softbox: "studio", "sky" or "room", which come
        with brdfkit, or a file, .exr or .hdr, by latitude and longitude; it is scaled to their
        illuminance of the ground.

    Returns
    -------
    Rendering
        The pictures; ``write`` makes an OpenEXR file of all, or a PNG to look at.

    Raises
    ------
    BrdfkitError
        For what cannot be rendered, and for pictures larger than the memory that is available.

    Examples
    --------
    >>> pictures = render(["car_paint", ("grey", {"type": "diffuse"})], spp=16)    # doctest: +SKIP
    >>> pictures.write("paint.exr")    # doctest: +SKIP
    >>> print(render(["car_paint", "ggx"], until=45).errors())    # doctest: +SKIP
    """
    until = _to_decibels(until)
    if isinstance(things, FunctionType):
        things = from_function(things)
    default = field.SPP if isinstance(things, Node) else SPP
    spp, seed = _to_samples(spp, default, until), to_whole_number("seed", seed, least=0)
    size = None if size is None else to_size(size)
    if isinstance(things, Node):
        if scene != "ball" or envmap is not None:
            raise BrdfkitError("A distance field is shown by itself: leave scene and envmap out.")
        return _render_field(things, spp, size or field.SIZE, seed, progress, until)
    subjects = as_list(things)
    require_memory(size or SIZE, len(subjects))
    mitsuba()  # sets a variant, on which the dictionaries depend
    materials, parameters = describe_all(subjects)
    where = scene, size, envmap
    traced, mask = _load_and_trace(materials, where, spp, seed, progress, until)
    return rendering_of(traced, seed, until, parameters, mask)


@in_turn
def render_scene(
    path: str | Path,
    spp: int | None = None,
    seed: int = 0,
    progress: Callable[..., object] | None = None,
    until: float | None = None,
) -> Rendering:
    """Path-trace a scene file of Mitsuba's, in which brdfkit's plugins may appear.

    Size, camera and integrator are the scene's. For Ctrl-C, threads and variants see `render`.

    Parameters
    ----------
    path : str or Path
        The file, `.xml`.
    spp : int, optional
        Samples per pixel, by default those of the scene's sampler; with `until`, the most of them,
        by default 16,384.
    seed : int, default 0
        Seed of the samples.
    progress : callable, optional
        Called with (done, total) after each pass, and with `pictures`, as in `render`.
    until : float, optional
        The noise floor [dB] to which samples are added, as in `render`.

    Returns
    -------
    Rendering
        One picture.

    Raises
    ------
    BrdfkitError
        For a file that is missing or that Mitsuba cannot load, for a scene without a sensor or an
        integrator, and for a picture larger than the memory that is available.

    Examples
    --------
    >>> render_scene("kitchen.xml", spp=64).write("kitchen.exr")    # doctest: +SKIP
    """
    until = _to_decibels(until)
    seed, path = to_whole_number("seed", seed, least=0), Path(path)
    mitsuba()
    scene = load_scene_file(path)
    require_memory(scene.sensors()[0].film().size(), 1, path)
    spp = _to_samples(spp, scene.sensors()[0].sampler().sample_count(), until)
    traced = trace({path.stem: scene}, spp, seed, progress, until)
    return rendering_of(traced, seed, until)


def to_size(size: int | tuple[int, int]) -> tuple[int, int]:
    """(width, height) of a picture; `BrdfkitError` for anything but whole numbers above 0."""
    sides = (size, size) if isinstance(size, int | np.integer) else size
    try:
        width, height = (to_whole_number("size", side, least=1) for side in sides)
    except (TypeError, ValueError):
        raise BrdfkitError(
            f"size = {size!r} should be a side, or (width, height), in whole pixels above 0."
        ) from None
    return width, height


def _to_decibels(until):
    """The noise floor `until` [dB], or None; `BrdfkitError` where it is no number above 0."""
    return None if until is None else to_positive("until", until)


def _to_samples(spp, default, until):
    """Samples per pixel: with a noise floor `until` the most of them, and two for the noise."""
    if until is None:
        return to_whole_number("spp", default if spp is None else spp, least=1)
    return to_whole_number("spp", MOST if spp is None else spp, least=2)


def rendering_of(traced, seed, until, parameters=None, mask=None):
    """The `Rendering` of `Traced` pictures."""
    return Rendering(
        traced.pictures,
        traced.spp,
        traced.seconds,
        seed,
        parameters or {},
        mask,
        traced.asked,
        traced.first.other_seed,
        until,
        standard_error=traced.first.standard_error,
    )


@in_turn
def _render_field(node, spp, size, seed, progress, until):
    """The `Rendering` of a distance field, freed in its turn as in `_load_and_trace`."""
    require_memory(size, 1)
    mitsuba()
    traced = trace({"field": field.field_scene(node, size)}, spp, seed, progress, until)
    return rendering_of(traced, seed, until)


@in_turn
def _load_and_trace(materials, where, spp, seed, progress, until):
    """The result of `trace` for BSDFs' dictionaries by name, and the mask of the material.

    The scenes are freed as this function returns, still in its turn: a kernel of Mitsuba's calls
    the BSDFs of all scenes that exist in the process, also of one that another thread would free.
    """
    loaded, mask = load_scenes(materials, *where)
    require_memory(next(iter(loaded.values())).sensors()[0].film().size(), len(loaded))
    return trace(loaded, spp, seed, progress, until, mask), mask
