"""Renders the measurement and the fits of a report in one scene, with reproducible results.

Sums of floating-point numbers depend on their order, and several threads that add samples to one
pixel do so in any order. So a box filter keeps each sample within its own pixel, and passes of 16,
8 or 4 samples keep the samples of a pixel in one thread. Thus the same seed on a CPU gives the same
report, bit by bit.
"""

from collections.abc import Callable
from dataclasses import replace
from math import ceil
from pathlib import Path
from typing import Any

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.array_types import BoolArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress
from brdfkit.materials.measured import Measured
from brdfkit.mitsuba_bridge.scene_file import SUFFIX
from brdfkit.regression import Fit
from brdfkit.rendering import render
from brdfkit.rendering.result import Rendering
from brdfkit.rendering.scene_input.loading import find_scene, require_scene
from brdfkit.rendering.scene_input.material import find_material_mask, load_material
from brdfkit.rendering.tracing import PASS
from brdfkit.reporting.pictures.defaults import LARGEST_SIZE, SCENE, SIZE, SMALLEST_SIZE, SPP

BuildScene = Callable[[Any, Any], dict[str, Any]]


def render_pictures(
    material: Measured,
    fits: list[Fit],
    spp: int | None = None,
    noise_floor: float | None = None,
    size: int = SIZE,
    seed: int = 0,
    scene: str | Path = SCENE,
    environment: str | Path | None = None,
    progress: Progress | None = None,
) -> Rendering:
    """Return the `Rendering` of a report, with the picture of the measurement and then the fits'.

    `spp`: samples per pixel, rounded up to whole passes. By default it is `SPP`; with a
    `noise_floor` [dB] it is the default of `render`. The other arguments are those of `report`.
    """
    check_picture_arguments(size, scene, environment)
    if spp is not None or noise_floor is None:
        spp = SPP if spp is None else spp
        spp = ceil(to_whole_number("spp", spp, least=1) / PASS) * PASS
    build = _build_with_box_filter(scene)
    rendering = render(
        [material, *fits],
        spp=spp,
        size=size,
        scene=build,
        environment=environment,
        noise_floor=noise_floor,
        seed=seed,
        progress=progress,
    )
    return replace(rendering, mask=_find_material_pixels(build, size))


def check_picture_arguments(size: object, scene: Any, environment: Any) -> None:
    """Raise `BrdfkitError` for a size, scene or environment that a report cannot have."""
    if to_whole_number("size", size, least=SMALLEST_SIZE) > LARGEST_SIZE:
        raise BrdfkitError(f"size = {size}: pictures of a page have at most {LARGEST_SIZE} pixels.")
    if callable(scene) or Path(str(scene).partition("#")[0]).suffix.lower() == SUFFIX:
        raise BrdfkitError(
            f"{scene}: a report shows materials in a scene of brdfkit's or on a mesh; choose one."
        )
    require_scene(scene, environment)


def _build_with_box_filter(scene: str | Path) -> BuildScene:
    """Return a function that makes a Mitsuba scene with a box filter.

    The function takes a BSDF and the size of the picture. `scene`: name of a scene of brdfkit, or
    path of a mesh.
    """
    build, is_mesh = find_scene(scene), bool(Path(scene).suffix)

    def build_box_filtered(bsdf: Any, size: Any) -> dict[str, Any]:
        """Return the dictionary of the scene with a BSDF, for a picture of the given size."""
        if is_mesh and isinstance(bsdf, dict):  # an open mesh shows its back side, too
            bsdf = load_material(bsdf, "material", both_sides=True)
        dictionary: dict[str, Any] = build(bsdf, size)
        dictionary["sensor"]["film"]["rfilter"] = {"type": "box"}
        return dictionary

    return build_box_filtered


@in_turn
def _find_material_pixels(build: BuildScene, size: int) -> BoolArray:
    """Return for each pixel (size, size) whether it shows the material, for picture errors."""
    import mitsuba as mi

    material = load_material({"type": "diffuse"}, "material")
    return find_material_mask(mi.load_dict(build(material, (size, size))), material)
