"""`render`: path-traced pictures of materials, in the same scene and with the same samples.

The first picture is the reference, usually of the measured material. Each pass renders every
picture once, so that after Ctrl-C all pictures have the same number of samples.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from types import FunctionType
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.arguments import to_positive_number, to_whole_number
from brdfkit.core.array_types import AnyArray, BoolArray
from brdfkit.core.cluster import count_cluster_slots
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.memory import require_memory
from brdfkit.distance_fields import Node, from_function
from brdfkit.rendering.result import Rendering
from brdfkit.rendering.scene_input import field
from brdfkit.rendering.scene_input.arguments import (
    Renderable,
    collect_parameters,
    load_mitsuba,
    load_named_materials,
    to_material_list,
)
from brdfkit.rendering.scene_input.loading import SIZE
from brdfkit.rendering.shown import Loaded, Shown, ShownField, ShownFile, ShownMaterials
from brdfkit.rendering.tracing import Traced, trace_scenes

MOST_SPP = 16_384  # default limit of the samples per pixel if a noise floor is requested
Scene: TypeAlias = Callable[[dict[str, Any], tuple[int, int]], dict[str, Any]]
SceneLike: TypeAlias = str | Path | Scene
Renderables: TypeAlias = Renderable | Iterable[Renderable] | Node | Callable[[Any], Any]
PictureProgress: TypeAlias = Callable[..., object]


def render(
    materials: Renderables,
    *,
    spp: int | None = None,
    size: int | tuple[int, int] | None = None,
    scene: SceneLike = "ball",
    environment: str | Path | None = None,
    noise_floor: float | None = None,
    client: Any = None,
    seed: int = 0,
    progress: PictureProgress | None = None,
) -> Rendering:
    """Path-trace one or several materials in the same scene, with the same samples.

    The current variant of Mitsuba is used or, if none is set, the best one that works. Ctrl-C keeps
    the passes that every picture has; before the first of them it raises KeyboardInterrupt.
    Renderings in several threads run one after the other.

    Parameters
    ----------
    materials : Measured, Fit, Model, str, Path, dict or (str, one of these), or several
        The materials, the reference first: objects, names or paths, dictionaries of BSDFs, which
        may contain a "name", or pairs of a name and one of these. In their place a Mitsuba scene
        file, ``.xml``, with its own size, camera and integrator; or a field of
        `brdfkit.distance_fields`, which is shown under lamps with soft shadows, and whose parts
        may have materials, as ``field.made_of("car_paint")``. A function of points is a field,
        too: see `brdfkit.distance_fields.from_function`.
    spp : int, optional
        Samples per pixel, by default 256, or those of a scene file's sampler. With `noise_floor`,
        the largest number of them, by default 16,384.
    size : int or (int, int), optional
        Side, or width and height, of a picture [pixels]; by default 512, or as the scene file says.
    scene : str, Path or callable, default "ball"
        The name of a scene, which `brdfkit render --help` lists; a mesh (.obj, .ply) in place of
        the ball, where "FILE.obj#z" says that its z axis points up, which is otherwise guessed,
        with a warning if it is not y; a scene file "FILE.xml#ID", with the id of the BSDF that the
        materials replace, by default "material"; or a function that returns a scene's dictionary
        for (BSDF's dictionary, (width, height)).
    environment : str or Path, optional
        An environment map in place of sky and softbox: "studio", "sky" or "room", which come with
        brdfkit, or a file, .exr or .hdr, by latitude and longitude. It is scaled to the same
        illuminance of the ground.
    noise_floor : float, optional
        The noise floor to reach by adding samples [dB, above 0]: the PSNR of the reference to
        itself with another seed. At 45 noise is hardly visible.
    client : distributed.Client, optional
        A cluster that renders in place of this process: its workers share the samples. Files of
        scenes, environment maps and plugins must have the same paths there.
    seed : int, default 0
        Seed of the samples; equal seeds give equal pictures, up to the order in which threads sum
        up (1e-6).
    progress : callable, optional
        Called with (done, total) after each pass of a picture; with `noise_floor`, the total is an
        estimate that improves. A function with a parameter `pictures` also gets a function:
        ``pictures()`` returns the pictures so far by name, in linear sRGB; it costs nothing unless
        it is called.

    Returns
    -------
    Rendering
        The pictures; ``write`` makes an OpenEXR file of all, or a PNG to look at.

    Raises
    ------
    BrdfkitError
        For a material, scene or environment that cannot be rendered, and for pictures
        larger than the available memory.

    Examples
    --------
    >>> pictures = render(["car_paint", ("grey", {"type": "diffuse"})], spp=16)    # doctest: +SKIP
    >>> pictures.write("paint.exr")    # doctest: +SKIP
    >>> print(render(["car_paint", "ggx"], noise_floor=45).errors())    # doctest: +SKIP
    >>> render("kitchen.xml", spp=64).write("kitchen.exr")    # doctest: +SKIP
    """
    noise_floor = None if noise_floor is None else to_positive_number("noise_floor", noise_floor)
    if isinstance(materials, FunctionType):
        materials = from_function(materials)
    file, is_field = _find_scene_file(materials), isinstance(materials, Node)
    if (file or is_field) and (scene != "ball" or environment is not None or (file and size)):
        what = f"{file} is a scene file" if file else "A distance field is shown by itself"
        own = "scene, environment and size" if file else "scene and environment"
        raise BrdfkitError(f"{what}: leave {own} out.")
    seed = to_whole_number("seed", seed, least=0)
    spp = _check_sample_count(spp, noise_floor)
    size = None if size is None else to_picture_size(size)
    if client is not None:
        count_cluster_slots(client)
    parameters: dict[str, dict[str, Any]] = {}
    shown: Shown
    if file:
        shown = ShownFile(file)
    elif isinstance(materials, Node):
        shown = ShownField(materials, size or field.SIZE)
    else:
        subjects = to_material_list(materials)
        require_memory(size or SIZE, len(subjects))
        load_mitsuba()  # it sets Mitsuba's variant, on which the dictionaries of BSDFs depend
        named = load_named_materials(subjects)
        shown = ShownMaterials(named, scene, size, environment)
        parameters = collect_parameters(named)
    trace = _trace_here if client is None else partial(_trace_on_cluster, client)
    traced, loaded = trace(shown, spp, seed, progress, noise_floor)
    return to_rendering(traced, seed, noise_floor, parameters, loaded.mask, loaded.evidence)


@in_turn
def _trace_here(
    shown: Shown,
    spp: int | None,
    seed: int,
    progress: PictureProgress | None,
    noise_floor: float | None,
) -> tuple[Traced, Loaded]:
    """Load scenes and path-trace them; return the pictures, and what was loaded with them.

    The scenes are freed when this function returns, before another thread renders.
    """
    load_mitsuba()
    loaded = shown.load()
    traced = trace_scenes(
        loaded.scenes, spp or loaded.spp, seed, progress, noise_floor, loaded.mask
    )
    return traced, loaded.without_scenes()


@in_turn
def _load_here(shown: Shown) -> Loaded:
    """Load scenes, to find what is wrong with them, and return what is loaded without them."""
    load_mitsuba()
    return shown.load().without_scenes()


def _trace_on_cluster(
    client: Any,
    shown: Shown,
    spp: int | None,
    seed: int,
    progress: PictureProgress | None,
    noise_floor: float | None,
) -> tuple[Traced, Loaded]:
    """Path-trace scenes on the cluster of a `client`; otherwise as `_trace_here`."""
    from brdfkit.rendering.on_cluster import trace_on_cluster

    loaded = _load_here(shown)
    spp = spp or loaded.spp
    return trace_on_cluster(shown, loaded, spp, seed, progress, noise_floor, client), loaded


def _find_scene_file(materials: object) -> Path | None:
    """Return the scene file among the things to render, or None if they are materials.

    Raises `BrdfkitError` for a scene file together with something else.
    """
    several = materials if isinstance(materials, list | tuple) else [materials]
    paths = [Path(one) for one in several if isinstance(one, str | Path)]
    files = [path for path in paths if path.suffix.lower() == ".xml"]
    if files and len(several) > 1:
        raise BrdfkitError(f"{files[0]} is a scene file, which is rendered alone.")
    return files[0] if files else None


def to_picture_size(size: int | tuple[int, int]) -> tuple[int, int]:
    """Return (width, height) from a side or a pair; raise `BrdfkitError` for invalid sizes."""
    sides = (size, size) if isinstance(size, int | np.integer) else size
    try:
        width, height = (to_whole_number("size", side, least=1) for side in sides)
    except (TypeError, ValueError):
        raise BrdfkitError(
            f"size = {size!r} should be a side, or (width, height), in whole pixels above 0."
        ) from None
    return width, height


def _check_sample_count(spp: int | None, noise_floor: float | None) -> int | None:
    """Check the user's `spp`; with a `noise_floor`, return the limit of the samples per pixel.

    The limit is at least 2, because the noise cannot be estimated from one sample.
    """
    if noise_floor is not None:
        return to_whole_number("spp", MOST_SPP if spp is None else spp, least=2)
    return None if spp is None else to_whole_number("spp", spp, least=1)


def to_rendering(
    traced: Traced,
    seed: int,
    noise_floor: float | None,
    parameters: dict[str, dict[str, Any]] | None = None,
    mask: BoolArray | None = None,
    evidence: dict[str, AnyArray] | None = None,
) -> Rendering:
    """Convert the result of `trace_scenes` to the `Rendering` that users receive."""
    return Rendering(
        traced.pictures,
        traced.spp,
        traced.seconds,
        seed,
        parameters or {},
        mask,
        traced.requested,
        traced.first.other_seed,
        noise_floor,
        standard_error=traced.first.standard_error,
        evidence=evidence or {},
    )
