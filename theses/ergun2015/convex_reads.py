"""C8: reads of maps per pixel, by convex parts and by height fields."""

from brdfkit.theses.ergun2015.convex_study import NO_COACD, SETTING, has_coacd, studies

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import NOT_RUN, Claim, verdict
from brdfkit.theses.page import Section, Table

SECONDS = 300  # of which most to cut the meshes, once
TITLE = "Reads of maps"
CLAIM = "Convex parts take fewer reads than height fields, and less spread.", "Figure 9.10"
PRINTED = "3.68 ± 6.12 against 8.04 ± 15.05 per pixel, on one scene"
TEXT = f"""Per pixel and sample, for a shadow ray to the light and one by the material. {SETTING}
Height fields stand in a tree, RBVH [Novák & Dachsbacher 2012]."""


@in_turn
def run(sources, report):
    """The reads on all meshes, and the claim on them."""
    use_variant()
    if not has_coacd():
        return Section(TITLE, TEXT, [Claim(*CLAIM, PRINTED, "", NOT_RUN, NO_COACD)])
    found = studies(sources)
    reads = {}
    for done, (name, study) in enumerate(found.items()):
        reads[name] = study.reads(study.convex), study.reads(study.fields)
        report(done + 1, len(found))
    rows = [
        (name, *(f"{mean:.2f} ± {deviation:.2f}" for mean, deviation in pair))
        for name, pair in reads.items()
    ]
    table = Table(("mesh", "convex parts", "height fields"), rows, "Mean ± standard deviation.")
    return Section(TITLE, TEXT, [claim_on(reads)], [table])


def claim_on(reads):
    """C8; `reads`: name → ((mean, deviation) of convex parts, the same of height fields)."""
    fewer = sum(a[0] < b[0] and a[1] < b[1] for a, b in reads.values())
    ratios = [a[0] / b[0] for a, b in reads.values()]
    return Claim(
        *CLAIM,
        PRINTED,
        f"both on {fewer} of {len(reads)} meshes; {min(ratios):.2f} to {max(ratios):.2f} times as "
        f"many reads, printed {3.68 / 8.04:.2f}",
        verdict(fewer == len(reads)),
        "A read is a plane of a part, or a height of a field.",
    )
