"""The pictures of a report: the measurement and the fits in one scene, equal to the last bit.

Threads that add samples to one pixel do so in the order of their arrival, on which sums of floats
depend. A box filter keeps a sample in its own pixel, and passes of 16, 8 or 4 keep the samples of a
pixel in one block of one thread: on a CPU the same seed gives the same bits, and a report the same
file.
"""

from dataclasses import replace
from math import ceil
from pathlib import Path

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.mitsuba_bridge.scene_file import SUFFIX
from brdfkit.rendering import render
from brdfkit.rendering.scene_input.loading import find_scene, require_scene
from brdfkit.rendering.scene_input.shown_material import load_material, mask
from brdfkit.rendering.tracing import PASS
from brdfkit.reporting.pictures.defaults import LARGEST, SCENE, SIZE, SMALLEST, SPP


def render_pictures(
    material,
    fits,
    spp=None,
    noise_floor=None,
    size=SIZE,
    seed=0,
    scene=SCENE,
    environment=None,
    progress=None,
):
    """The `Rendering` of a `Measured`, first, and its fits, as `render` makes it.

    `spp` is rounded up to whole passes; None is the default, or with
    `noise_floor` the one of `render`.
    """
    require_pictures(size, scene, environment)
    if spp is not None or noise_floor is None:
        spp = SPP if spp is None else spp
        spp = ceil(to_whole_number("spp", spp, least=1) / PASS) * PASS
    build = _sharp(scene)
    how = {
        "scene": build,
        "progress": progress,
        "noise_floor": noise_floor,
        "environment": environment,
    }
    found = render([material, *fits], spp=spp, size=size, seed=seed, **how)
    return replace(found, mask=_mask(build, size))


def require_pictures(size, scene, environment):
    """Raise `BrdfkitError` for pictures that a page cannot have, before anything is fitted."""
    if to_whole_number("size", size, least=SMALLEST) > LARGEST:
        raise BrdfkitError(f"size = {size}: pictures of a page have at most {LARGEST} pixels.")
    if callable(scene) or Path(str(scene).partition("#")[0]).suffix.lower() == SUFFIX:
        raise BrdfkitError(
            f"{scene}: a report shows materials in a scene of brdfkit's or on a mesh; choose one."
        )
    require_scene(scene, environment)


def _sharp(scene):
    """The function that makes the scene of a name or a mesh, in which a sample counts for the pixel
    that it is in and for no other."""
    build, is_mesh = find_scene(scene), bool(Path(scene).suffix)

    def sharp(bsdf, size):
        if is_mesh and isinstance(bsdf, dict):  # its back may be seen
            bsdf = load_material(bsdf, "material", both_sides=True)
        made = build(bsdf, size)
        made["sensor"]["film"]["rfilter"] = {"type": "box"}
        return made

    return sharp


@in_turn
def _mask(build, size):
    """True (size, size) where a pixel sees the material."""
    import mitsuba as mi

    material = load_material({"type": "diffuse"}, "material")
    return mask(mi.load_dict(build(material, (size, size))), material)
