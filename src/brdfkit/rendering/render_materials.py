"""`render`: path-traced pictures of materials, in the same scene and with the same samples.

The first picture is the reference, usually of the measured material. Each pass renders every
picture once, so that after Ctrl-C all pictures have the same number of samples.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from types import FunctionType
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.arguments import to_positive_number, to_whole_number
from brdfkit.core.array_types import AnyArray, BoolArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.memory import require_memory
from brdfkit.distance_fields import Node, from_function
from brdfkit.materials.resolve import Material
from brdfkit.mitsuba_bridge.scene_file import load_scene_file
from brdfkit.rendering.evidence import find_picture_evidence
from brdfkit.rendering.result import Rendering
from brdfkit.rendering.scene_input import field
from brdfkit.rendering.scene_input.arguments import (
    Renderable,
    collect_parameters,
    load_mitsuba,
    load_named_materials,
    to_material_list,
)
from brdfkit.rendering.scene_input.loading import SIZE, load_scenes
from brdfkit.rendering.tracing import Traced, trace_scenes

SPP = 256  # default number of samples per pixel
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
        shown = f"{file} is a scene file" if file else "A distance field is shown by itself"
        own = "scene, environment and size" if file else "scene and environment"
        raise BrdfkitError(f"{shown}: leave {own} out.")
    seed = to_whole_number("seed", seed, least=0)
    if file:
        return _render_scene_file(file, spp, seed, progress, noise_floor)
    spp = _to_sample_count(spp, field.SPP if is_field else SPP, noise_floor)
    size = None if size is None else to_picture_size(size)
    if isinstance(materials, Node):
        return _render_field(materials, spp, size or field.SIZE, seed, progress, noise_floor)
    subjects = to_material_list(materials)
    require_memory(size or SIZE, len(subjects))
    load_mitsuba()  # it sets Mitsuba's variant, on which the dictionaries of BSDFs below depend
    named = load_named_materials(subjects)
    where = scene, size, environment
    traced, mask, evidence = _load_and_trace_scenes(named, where, spp, seed, progress, noise_floor)
    parameters = collect_parameters(named)
    return to_rendering(traced, seed, noise_floor, parameters, mask, evidence)


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


@in_turn
def _render_scene_file(
    path: Path,
    spp: int | None,
    seed: int,
    progress: PictureProgress | None,
    noise_floor: float | None,
) -> Rendering:
    """Render a Mitsuba scene file with its own camera and integrator."""
    load_mitsuba()
    scene = load_scene_file(path)
    require_memory(scene.sensors()[0].film().size(), 1, path)
    spp = _to_sample_count(spp, scene.sensors()[0].sampler().sample_count(), noise_floor)
    traced = trace_scenes({path.stem: scene}, spp, seed, progress, noise_floor)
    return to_rendering(traced, seed, noise_floor)


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


def _to_sample_count(spp: int | None, default: int, noise_floor: float | None) -> int:
    """Check the user's `spp`; return the samples per pixel, or their limit with a `noise_floor`.

    Without a `noise_floor`, a `spp` of None gives the `default`. The limit is at least 2, because
    the noise cannot be estimated from one sample.
    """
    if noise_floor is None:
        return to_whole_number("spp", default if spp is None else spp, least=1)
    return to_whole_number("spp", MOST_SPP if spp is None else spp, least=2)


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


@in_turn
def _render_field(
    node: Node,
    spp: int,
    size: tuple[int, int],
    seed: int,
    progress: PictureProgress | None,
    noise_floor: float | None,
) -> Rendering:
    """Render a distance field, the graph of its `node`; return the `Rendering`.

    The scene is freed when this function returns, before another thread renders.
    """
    require_memory(size, 1)
    load_mitsuba()
    traced = trace_scenes(
        {"field": field.load_field_scene(node, size)}, spp, seed, progress, noise_floor
    )
    return to_rendering(traced, seed, noise_floor)


@in_turn
def _load_and_trace_scenes(
    materials: dict[str, Material],
    where: tuple[SceneLike, tuple[int, int] | None, str | Path | None],
    spp: int,
    seed: int,
    progress: PictureProgress | None,
    noise_floor: float | None,
) -> tuple[Traced, BoolArray | None, dict[str, AnyArray]]:
    """Path-trace `materials` by name; return the pictures, the mask and the evidence.

    The mask is True in the pixels that show the material, and the evidence is what
    `find_picture_evidence` tells of them. `where` is (scene, size, environment).
    The scenes must be freed when this function returns, before another thread renders: kernels of
    Mitsuba call the BSDFs of all scenes in the process, and would call one that is being freed.
    """
    described = {name: material.scene_dict() for name, material in materials.items()}
    loaded, mask = load_scenes(described, *where)
    first = next(iter(loaded.values()))
    require_memory(first.sensors()[0].film().size(), len(loaded))
    evidence = find_picture_evidence(materials, first, mask)
    return trace_scenes(loaded, spp, seed, progress, noise_floor, mask), mask, evidence
