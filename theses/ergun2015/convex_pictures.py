"""Compares pictures with shadows of convex parts to those of triangles and of height fields."""

from dataclasses import replace

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
from brdfkit.lighting.visibility.occluders import CLEARANCE, RESOLUTION, Occluders
from brdfkit.theses.claims import NOT_RUN, Claim, to_verdict
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 90
BAR = 39  # dB: the lowest PSNR that the thesis has on any mesh
CLEARANCES = 0.01, 0.02, CLEARANCE, 0.04  # brdfkit's, and others beside it
DRAWN = "spot", "stanford-bunny", "suzanne"
DIFFERENCE = 5  # the factor by which the figure enlarges differences
TITLE = "Shadows of convex parts"
FIELD = f"By height fields, too, no PSNR is below {BAR} dB."
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
thicker than it. brdfkit's clearance was chosen on these very meshes. Height fields have it, too."""
FIELDS = """Of height fields the thesis says the same as of parts."""


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
        f"{', '.join(drawn)} downwards, by brdfkit's form. From the left: the parts, the shadows "
        f"of triangles, those of the parts, and their difference, {DIFFERENCE} times as large."
    )
    picture = Picture("convex_pictures", draw_rows(drawn), caption)
    clear = measure_clearances(found)
    report(len(found) + 1, len(found) + 1)
    thesis = {name: (row[0], row[2]) for name, row in quality.items()}
    ours = {name: row[3:] for name, row in quality.items()}
    true = np.array([row[1][0] for row in quality.values()])
    limit = (
        f"By true planes in place of texels {(true >= BAR).sum()} of {len(true)} meshes, "
        f"{true.min():.1f} to {true.max():.1f} dB. {SELF_SHADOWS}"
    )
    claims = [
        claim_good(FORMS[0], thesis, limit),
        claim_clear(ours, clear),
        claim_good(FORMS[0], {name: pair[::-1] for name, pair in thesis.items()}, FIELDS, FIELD),
        claim_good(FORMS[1], {name: pair[::-1] for name, pair in ours.items()}, FIELDS, FIELD),
        claim_order(FORMS[0], thesis),
        claim_order(FORMS[1], ours),
    ]
    settings = [(name, *(f"{by[c]:.1f}" for c in CLEARANCES)) for name, by in clear.items()]
    tables = [
        Table(heads, rows, "PSNR [dB]."),
        Table(
            ("mesh", *(f"clearance {c:g}" for c in CLEARANCES)),
            settings,
            "PSNR [dB] of convex parts by brdfkit's form.",
        ),
    ]
    return Section(TITLE, TEXT, claims, tables, [picture])


def measure_clearances(studies):
    """Return the PSNR [dB] of brdfkit's parts by mesh and clearance."""
    return {
        name: {
            c: study.compute_quality(Occluders({"mesh": study.convex.hulls}, clearance=c))[0]
            for c in CLEARANCES
        }
        for name, study in studies.items()
    }


def claim_good(form, quality, why, says=GOOD[0]):
    """Claim that no mesh has a PSNR below the thesis's lowest one, by parts of a `form`.

    `quality` maps each mesh to pairs of PSNRs, linear and as shown, of which the first is judged.
    """
    linear, as_shown = np.array([pair[0] for pair in quality.values()]).T
    ours = (
        f"{(linear >= BAR).sum()} of {len(quality)} meshes, {linear.min():.1f} to "
        f"{linear.max():.1f} dB; as shown {(as_shown >= BAR).sum()}, {as_shown.min():.1f} to "
        f"{as_shown.max():.1f} dB"
    )
    named = f"{says[:-1]}: {form}.", *GOOD[1:]
    if not set(quality) <= set(MESHES):
        missing = f"{find_mesh_path(MESHES[0])} and the others are missing."
        return Claim(*named, ours, NOT_RUN, missing)
    return Claim(*named, ours, to_verdict(linear.min() >= BAR), why)


def claim_clear(quality, clear):
    """Claim like `claim_good` for brdfkit's form, over the clearance that it adds.

    `clear` maps each mesh to its PSNRs by clearance.
    """
    claim = claim_good(FORMS[1], quality, WHY)
    if claim.verdict == NOT_RUN:
        return claim
    least = {c: min((by[c], name) for name, by in clear.items()) for c in CLEARANCES}
    _, verdict = judge_over_grid(
        ("clearance",), {(f"{c:g}",): low >= BAR for c, (low, _) in least.items()}
    )
    others = ", ".join(f"{name} {low:.1f} dB at {c:g}" for c, (low, name) in least.items())
    return replace(
        claim, ours=f"{claim.ours}, at {CLEARANCE:g}; the least: {others}", verdict=verdict
    )


def claim_order(form, quality):
    """Claim that pictures by height fields are nearer to triangles than those by convex parts."""
    better = {(name,): bool(row[1][0] > row[0][0]) for name, row in quality.items()}
    _, verdict = judge_over_grid(("mesh",), better)
    gains = [row[1][0] - row[0][0] for row in quality.values()]
    named = f"{ORDER[0][:-1]}: {form}.", *ORDER[1:]
    ours = f"on {sum(better.values())} of {len(better)} meshes, by {min(gains):+.1f} to"
    return Claim(*named, f"{ours} {max(gains):+.1f} dB", verdict)


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
