"""The pictures of a report: balls of the measurement and of the fits, equal to the last bit.

Threads that add samples to one pixel do so in the order of their arrival, on which sums of floats
depend. A box filter keeps a sample in its own pixel, and passes of 16, 8 or 4 keep the samples of a
pixel in one block of one thread: on a CPU the same seed gives the same bits, and a report the same
file.
"""

from dataclasses import replace
from math import ceil

from brdfkit.arguments import to_whole_number
from brdfkit.jit.threads import in_turn
from brdfkit.rendering import render
from brdfkit.rendering.scenes.ball import ball
from brdfkit.rendering.shown_material import load_material, mask
from brdfkit.rendering.tracing import PASS
from brdfkit.reporting.defaults import SPP


def render_balls(material, fits, spp, until, size, seed, progress=None):
    """The `Rendering` of a `Measured`, first, and its fits, as `render` makes it.

    `spp` is rounded up to whole passes; None is the default, or with `until` that of `render`.
    """
    if spp is not None or until is None:
        spp = ceil(to_whole_number("spp", spp or SPP, least=1) / PASS) * PASS
    options = {"scene": _sharp_ball, "progress": progress, "until": until}
    found = render([material, *fits], spp, size, seed, **options)
    return replace(found, mask=_mask(size))


def _sharp_ball(bsdf, size):
    """The scene, in which a sample counts for the pixel that it is in and for no other."""
    scene = ball(bsdf, size)
    scene["sensor"]["film"]["rfilter"] = {"type": "box"}
    return scene


@in_turn
def _mask(size):
    """True (size, size) where a pixel sees the ball."""
    import mitsuba as mi

    material = load_material({"type": "diffuse"}, "ball")
    return mask(mi.load_dict(ball(material, (size, size))), material)
