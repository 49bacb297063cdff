"""Shows the parts of all meshes, and a mesh of several materials with the shadows of its parts."""

import numpy as np
from brdfkit.theses.ergun2015.convex_study import (
    NO_COACD,
    SIZE,
    SWEPT,
    Study,
    can_decompose,
    make_studies,
    to_screen_values,
)
from brdfkit.theses.ergun2015.lit_balls import find_probes
from brdfkit.theses.ergun2015.part_colours import render_coloured_parts
from brdfkit.theses.ergun2015.shapes import find_meshes

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.images.errors.psnr import psnr
from brdfkit.lighting.visibility.decomposition import CONCAVITY, HULL_VERTICES
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section

SECONDS = 30
SPP, DIFFERENCE, COLUMNS = 256, 5, 5
TITLE = "Parts, and materials"
PLASTIC = {"type": "roughplastic", "diffuse_reflectance": {"type": "rgb", "value": [0.1, 0.2, 0.4]}}
MATERIALS = {
    "matte": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.4, 0.3, 0.2]}},
    "semi-gloss": PLASTIC | {"alpha": 0.3},
    "gloss": PLASTIC | {"alpha": 0.08},
    "isotropic": {"type": "roughconductor", "material": "Cu", "alpha": 0.2},
    "anisotropic": {"type": "roughconductor", "material": "Al", "alpha_u": 0.05, "alpha_v": 0.4},
}
TEXT = f"""Figure 9.4 lists eight parameters of HACD, whose values are lost, and which is no longer
maintained. coacd stands in, which has two of them: the concavity, {CONCAVITY:g} of half the longest
side, and the most vertices of a hull, {HULL_VERTICES}. Figure 9.5 shows parts, and Figure 9.7 the
thesis's application with materials of five kinds, at about 15 frames per second on a laptop that
has no name: that rate is not compared. Here a mesh in {{light}} has such materials, in pictures of
{SIZE} × {SIZE} pixels with {SPP} samples of light and material, and shadows of its parts."""


@in_turn
def check_claims(sources, report):
    """Draw the parts of all meshes and a mesh of several materials; return their section."""
    use_variant()
    text = TEXT.format(light=next(iter(find_probes(sources))))
    if not can_decompose():
        return Section(TITLE, f"{text} Not run: {NO_COACD}")
    parts = Picture("convex_parts", draw_parts(make_studies(sources)), "The number of parts.")
    report(1, 2)
    drawn, errors = draw_materials(sources)
    caption = (
        "From above: the shadows of triangles, those of parts, and their difference, "
        f"{DIFFERENCE} times as large. PSNR {', '.join(f'{e:.1f}' for e in errors)} dB."
    )
    materials = Picture("convex_materials", drawn, caption)
    return Section(TITLE, text, pictures=[parts, materials])


def draw_parts(studies):
    """Draw the coloured parts of each `Study`, by name."""
    rows = -(-len(studies) // COLUMNS)
    drawn = make_figure(9, 2 * rows)
    grid = drawn.subplots(rows, COLUMNS, squeeze=False)
    for axes in grid.flat:
        axes.axis("off")
    for axes, (name, study) in zip(grid.flat, studies.items(), strict=False):
        axes.imshow(render_coloured_parts(study))
        axes.set_title(f"{name}, {len(study.convex.hulls)}", size=9)
    return drawn


def draw_materials(sources):
    """Draw a mesh of each material; return the figure, and the PSNR [dB] of each by parts."""
    ((_, shape),) = find_meshes(sources, [SWEPT]).items()
    light = next(iter(find_probes(sources).values()))
    drawn, errors, convex = make_figure(9, 5.6), [], Study(shape).convex
    grid = drawn.subplots(3, len(MATERIALS), squeeze=False)
    for column, (label, bsdf) in zip(grid.T, MATERIALS.items(), strict=True):
        study = Study(shape, {"type": "twosided", "bsdf": bsdf}, light)
        exact, ours = study.render(None, study.scene, SPP), study.render(convex, spp=SPP)
        errors.append(psnr(exact, ours))
        pictures = exact, ours, DIFFERENCE * np.abs(ours - exact)
        for axes, picture in zip(column, pictures, strict=True):
            axes.imshow(to_screen_values(picture, exact))
            axes.axis("off")
        column[0].set_title(label, size=9)
    return drawn, errors
