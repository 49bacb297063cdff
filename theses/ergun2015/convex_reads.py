"""Counts the reads of maps per pixel for shadows of convex parts and of height fields."""

import numpy as np
from brdfkit.theses.ergun2015.convex_rays import ExactPlaneMap, find_hits, make_random_rays
from brdfkit.theses.ergun2015.convex_study import (
    EPSILON,
    NO_COACD,
    PRINTED_FORM,
    SETTING,
    can_decompose,
    make_studies,
)
from brdfkit.theses.ergun2015.printed_ray import enclose_in_sphere, make_printed_search

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.lighting.visibility.convex_ray import find_ray_entry
from brdfkit.theses.claims import NOT_RUN, Claim, to_verdict
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table

SECONDS = 300  # mostly for the decomposition of the meshes, which later parts use again
TITLE = "Reads of maps"
CLAIM = "Convex parts take fewer reads than height fields, and less spread.", "Figure 9.10"
PRINTED = "3.68 ± 6.12 against 8.04 ± 15.05 per pixel, on one scene"
RAYS = 1000  # to each part, for its look-ups
LOOKUPS = "A convex part and a ray take 2.1 look-ups on average.", "7.1", "2.1"
PUBLISHED, NEAR = 2.1, 0.1  # look-ups, and by which share of them ours may differ
FORMS = "the thesis's form", "brdfkit's form"
TEXT = f"""Per pixel and sample, for a shadow ray to the light and one by the material. {SETTING}
Height fields stand in a tree, RBVH [Novák & Dachsbacher 2012]. *Look-ups* are those of one part and
a ray that enters its sphere, by true planes: {RAYS:,} rays to each part of a mesh, from twice the
radius of its sphere to points inside it. {PRINTED_FORM}"""


@in_turn
def check_claims(sources, report):
    """Check the claims on the reads of maps per pixel; return their section of the page."""
    use_variant()
    if not can_decompose():
        missing = (*CLAIM, PRINTED), LOOKUPS
        return Section(TITLE, TEXT, [Claim(*c, "", NOT_RUN, NO_COACD) for c in missing])
    found = make_studies(sources)
    reads, lookups = {}, {}
    for done, (name, study) in enumerate(found.items()):
        kinds = study.make_printed_parts(), study.fields_without_clearance
        reads[name] = [study.count_reads(by) for by in (*kinds, study.convex, study.fields)]
        lookups[name] = count_lookups(study.convex.hulls)
        report(done + 1, len(found))
    rows = [
        (
            name,
            *(f"{mean:.2f} ± {deviation:.2f}" for mean, deviation in row),
            *(f"{mean:.2f}" for mean in lookups[name]),
        )
        for name, row in reads.items()
    ]
    heads = "parts, printed", "fields, no clearance", "convex parts", "height fields"
    heads += "look-ups, printed", "look-ups"
    table = Table(("mesh", *heads), rows, "Reads: mean ± standard deviation. Look-ups: mean.")
    claims = [
        *(claim_lookups(form, lookups, column) for column, form in enumerate(FORMS)),
        claim_reads(FORMS[0], {name: row[:2] for name, row in reads.items()}),
        claim_reads(FORMS[1], {name: row[2:] for name, row in reads.items()}),
    ]
    return Section(TITLE, TEXT, claims, [table])


def count_lookups(hulls):
    """Return the mean look-ups of rays that enter a part's sphere, as printed and by brdfkit."""
    o, d = (v[:RAYS] for v in make_random_rays())
    forms = (
        ([enclose_in_sphere(hull) for hull in hulls], make_printed_search(EPSILON)),
        (hulls, find_ray_entry),
    )
    means = []
    for parts, search in forms:
        counts = [find_hits(ExactPlaneMap([part]), o, d, search)[1] for part in parts]
        entered = np.concatenate(counts)
        means.append(entered[entered > 0].mean())
    return means


def claim_lookups(form, lookups, column):
    """Claim that a ray takes as many look-ups as in the thesis, on each mesh, by a form."""
    means = {name: row[column] for name, row in lookups.items()}
    cells = {(name,): abs(mean - PUBLISHED) <= NEAR * PUBLISHED for name, mean in means.items()}
    ours, verdict = judge_over_grid(("mesh",), cells)
    return Claim(
        f"{LOOKUPS[0][:-1]}: {form}.",
        *LOOKUPS[1:],
        f"within {NEAR:.0%} {ours}; {min(means.values()):.2f} to {max(means.values()):.2f}".replace(
            "%", " %"
        ),
        verdict,
        "The thesis's parts, of HACD, are not known; they have more faces, and so take more "
        "look-ups, if more corners are allowed.",
    )


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
