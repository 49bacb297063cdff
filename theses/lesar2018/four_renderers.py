"""Reproduces Figure 7.1, pictures by the thesis's four renderers, of scans and a phantom."""

import numpy as np
from brdfkit.theses.lesar2018.renderers import RENDERERS, make_scan_scene
from brdfkit.theses.lesar2018.scans import find_scans

from brdfkit.core.colours import to_srgb
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import NOT_RUN, UNSTATED, Claim
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section

SECONDS = 15
SIZE, FEWER = 256, 1
SPP = {"single_scattering": 96, "isosurface": 32}  # samples per pixel; other renderers take 8
WHITE = 99.5  # the percentile of a picture's radiance that is shown white
TEXT = """MRI: the average of 152 heads (MNI ICBM152), without the skull. Frog: the tissues of the
Whole Frog project, labels that are never interpolated; in its first two pictures they are densities
of ours, the skeleton's the largest. Phantom: Shepp and Logan's, without its skull, cut open. One
camera and one lamp for all four renderers; emission and absorption needs no lamp."""


@in_turn
def check_claims(sources, report):
    """Check the claims on pictures by four renderers; return their section of the page."""
    use_variant()
    found = find_scans(sources, FEWER)
    drawn, done = make_figure(9, 2.35 * len(found)), 0
    grid = drawn.subplots(len(found), len(RENDERERS), squeeze=False)
    for row, scan in zip(grid, found, strict=True):
        for axes, name in zip(row, RENDERERS, strict=True):
            axes.imshow(render_picture(scan, name))
            axes.set_title(f"{scan.name}: {name.replace('_', ' ')}", size=8)
            axes.set_axis_off()
            done += 1
            report(done, grid.size)
    names = [scan.name for scan in found]
    missing = [name for name in ("MRI", "frog") if name not in names]
    claim = Claim(
        "One volume is shown by four renderers.",
        "Figure 7.1",
        "pictures of a volume without a name",
        "pictures of " + ", ".join(names),
        NOT_RUN if missing else UNSTATED,
        f"Not at hand: {', '.join(missing)}." if missing else "",
    )
    caption = "From the left: largest values, a surface, emission and absorption, scattered light."
    return Section("Four renderers", TEXT, [claim], pictures=[Picture("renderers", drawn, caption)])


def render_picture(scan, name):
    """Render a scan in sRGB."""
    import mitsuba as mi

    light = np.array(mi.render(make_scan_scene(scan, name, SIZE), spp=SPP.get(name, 8)), float)
    seen = light[light > 0]
    return to_srgb(light / (np.percentile(seen, WHITE) if seen.size else 1))
