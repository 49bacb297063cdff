"""Counts the reads of maps per pixel for shadows of convex parts and of height fields."""

from brdfkit.theses.ergun2015.convex_study import (
    NO_COACD,
    PRINTED_FORM,
    SETTING,
    can_decompose,
    make_studies,
)

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import NOT_RUN, Claim, to_verdict
from brdfkit.theses.page import Section, Table

SECONDS = 300  # mostly for the decomposition of the meshes, which later parts use again
TITLE = "Reads of maps"
CLAIM = "Convex parts take fewer reads than height fields, and less spread.", "Figure 9.10"
PRINTED = "3.68 ± 6.12 against 8.04 ± 15.05 per pixel, on one scene"
TEXT = f"""Per pixel and sample, for a shadow ray to the light and one by the material. {SETTING}
Height fields stand in a tree, RBVH [Novák & Dachsbacher 2012]. {PRINTED_FORM}"""


@in_turn
def check_claims(sources, report):
    """Check the claims on the reads of maps per pixel; return their section of the page."""
    use_variant()
    if not can_decompose():
        return Section(TITLE, TEXT, [Claim(*CLAIM, PRINTED, "", NOT_RUN, NO_COACD)])
    found = make_studies(sources)
    reads = {}
    for done, (name, study) in enumerate(found.items()):
        kinds = study.make_printed_parts(), study.fields_without_clearance
        reads[name] = [study.count_reads(by) for by in (*kinds, study.convex, study.fields)]
        report(done + 1, len(found))
    rows = [
        (name, *(f"{mean:.2f} ± {deviation:.2f}" for mean, deviation in row))
        for name, row in reads.items()
    ]
    heads = "parts, printed", "fields, no clearance", "convex parts", "height fields"
    table = Table(("mesh", *heads), rows, "Mean ± standard deviation.")
    claims = [
        claim_reads("the thesis's form", {name: row[:2] for name, row in reads.items()}),
        claim_reads("brdfkit's form", {name: row[2:] for name, row in reads.items()}),
    ]
    return Section(TITLE, TEXT, claims, [table])


def claim_reads(form, reads):
    """Claim that convex parts of a form take fewer reads, with less spread, than height fields.

    `reads` maps each mesh to two pairs of mean and deviation, for convex parts and for height
    fields.
    """
    fewer = sum(a[0] < b[0] and a[1] < b[1] for a, b in reads.values())
    ratios = [a[0] / b[0] for a, b in reads.values()]
    return Claim(
        f"{CLAIM[0][:-1]}: {form}.",
        CLAIM[1],
        PRINTED,
        f"both on {fewer} of {len(reads)} meshes; {min(ratios):.2f} to {max(ratios):.2f} times as "
        f"many reads, printed {3.68 / 8.04:.2f}",
        to_verdict(fewer == len(reads)),
        "A read is a plane of a part, or a height of a field.",
    )
