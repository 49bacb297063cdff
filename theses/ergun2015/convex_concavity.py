"""Compares pictures with shadows of parts over the allowed concavity, on several meshes."""

import numpy as np
from brdfkit.theses.ergun2015.convex_settings import CONCAVITIES
from brdfkit.theses.ergun2015.convex_study import (
    EPSILON,
    NO_COACD,
    PRINTED_FORM,
    SETTING,
    Study,
    can_decompose,
)
from brdfkit.theses.ergun2015.printed_ray import PrintedOccluders
from brdfkit.theses.ergun2015.shapes import find_meshes

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.lighting.visibility.occluders import Occluders
from brdfkit.theses.claims import NOT_RUN, Claim
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 300  # mostly for the first decomposition of the meshes, which is kept
MESHES = "spot", "suzanne", "homer", "cow", "teapot"  # closed, and of few triangles
PEAKED = 1  # dB above both ends of a curve, from which its middle counts as a maximum
TITLE = "The concavity"
PEAK = "The PSNR is highest at a middle concavity", "Figure 9.8", "at about 40 %, on Armadillo"
FALL = "The parts fall as a logarithm of the concavity.", "Figure 9.8", "a drawing, on Armadillo"
FORMS = "the thesis's form", "brdfkit's form"
TEXT = f"""{SETTING} The concavity is the largest distance between a part and its hull. The meshes
are those with few triangles, which are cut soonest. {PRINTED_FORM}"""
WHY = f"""The thesis's 40 % are of HACD's own measure, ours a length, so that only the form of the
curve is compared; it holds on a mesh where the curve rises {PEAKED} dB above both ends. From 0.4 on
spot is a single part, so that a best concavity there is an end."""
SELF_SHADOWS = "Many parts shade themselves where they overlap, as the thesis says."
CLEAR = "The clearance takes their own shadows away: then more parts are better."


@in_turn
def check_claims(sources, report):
    """Check the claim that a middle concavity is best, on several meshes; return its section."""
    use_variant()
    if not can_decompose():
        missing = [Claim(f"{PEAK[0]}: {f}.", *PEAK[1:], "", NOT_RUN, NO_COACD) for f in FORMS]
        return Section(TITLE, TEXT, [Claim(*FALL, "", NOT_RUN, NO_COACD), *missing])
    shapes, decibels = find_meshes(sources, MESHES), {form: {} for form in FORMS}
    counts = {name: [] for name in shapes}
    rows = []
    for name, shape in shapes.items():
        study = Study(shape)
        for form in FORMS:
            decibels[form][name] = []
        for concavity in CONCAVITIES:
            parts = {"mesh": study.decompose_mesh(concavity=concavity)}
            kinds = PrintedOccluders(parts, EPSILON), Occluders(parts)
            found = [study.compute_quality(by)[0] for by in kinds]
            for form, value in zip(FORMS, found, strict=True):
                decibels[form][name].append(value)
            counts[name].append(len(parts["mesh"]))
            count = str(counts[name][-1])
            rows.append((name, f"{concavity:g}", count, *(f"{value:.1f}" for value in found)))
            report(len(rows), len(shapes) * len(CONCAVITIES))
    claims = [
        claim_fall(counts),
        *(
            claim_peak(form, decibels[form], why)
            for form, why in zip(FORMS, (SELF_SHADOWS, CLEAR), strict=True)
        ),
    ]
    table = Table(("mesh", "concavity", "parts", *(f"{form} [dB]" for form in FORMS)), rows)
    picture = Picture("convex_concavity", draw_curves(decibels))
    return Section(TITLE, TEXT, claims, [table], [picture])


def claim_fall(counts):
    """Claim that the number of parts falls as a logarithm of the concavity, not as a power.

    `counts` maps each mesh to its numbers of parts by concavity.
    """
    logs = np.log(CONCAVITIES)
    fits = {
        name: [np.corrcoef(logs, by)[0, 1] ** 2 for by in (parts, np.log(parts))]
        for name, parts in counts.items()
    }
    ours, verdict = judge_over_grid(
        ("mesh",), {(name,): bool(line > power) for name, (line, power) in fits.items()}
    )
    lines, powers = zip(*fits.values(), strict=True)
    return Claim(
        *FALL,
        f"{ours}; r² {min(lines):.2f} to {max(lines):.2f}, of a power "
        f"{min(powers):.2f} to {max(powers):.2f}",
        verdict,
        "It holds on a mesh where the number of parts is nearer to a straight line over the "
        "concavity's logarithm than its own logarithm is. The parts are coacd's, and the thesis's "
        "concavity is HACD's own measure.",
    )


def claim_peak(form, decibels, why):
    """Claim that the PSNR of a form is highest at a middle concavity.

    `decibels` maps each mesh to its PSNRs by concavity.
    """
    above = {name: max(curve) - max(curve[0], curve[-1]) for name, curve in decibels.items()}
    ours, verdict = judge_over_grid(("mesh",), {(n,): by >= PEAKED for n, by in above.items()})
    best = (
        f"{name} at {CONCAVITIES[curve.index(max(curve))]:g} by {above[name]:.1f} dB"
        for name, curve in decibels.items()
    )
    return Claim(
        f"{PEAK[0]}: {form}.", *PEAK[1:], f"{ours}; {', '.join(best)}", verdict, f"{WHY} {why}"
    )


def draw_curves(decibels):
    """Draw the PSNR over the concavity for each mesh, by form."""
    drawn = make_figure(7.6, 3)
    for axes, (form, by) in zip(
        drawn.subplots(1, len(FORMS), sharey=True), decibels.items(), strict=True
    ):
        for (name, curve), colour in zip(by.items(), COLOURS, strict=False):
            axes.semilogx(CONCAVITIES, curve, "o-", color=colour, label=name)
        axes.set_xlabel("concavity")
        axes.set_xticks(CONCAVITIES, [f"{c:g}" for c in CONCAVITIES])
        axes.minorticks_off()
        style_axes(axes, form, "PSNR [dB]" if form == FORMS[0] else "")
    drawn.axes[0].legend(frameon=False, fontsize=7)
    return drawn
