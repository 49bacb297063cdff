"""Measures the combination of methods that the thesis recommends in section 5: errors and times."""

from brdfkit.theses.ergun2008.views import RESOLUTION, View, measure_all

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import UNSTATED, Claim, measure_least_seconds, to_verdict
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 60
SCENES = ()  # names of the scenes to measure; by default all
LISPSM, PSSM = "light_space_perspective", "parallel_split"
TECHNIQUES = {
    "uniform + depth": {"projection": "uniform", "filter": "depth"},
    "focused + depth": {"projection": "focused", "filter": "depth"},
    "LiSPSM + depth": {"projection": LISPSM, "filter": "depth"},
    "LiSPSM + VSM": {"projection": LISPSM, "filter": "variance"},
    "LiSPSM + VSM + PSSM": {"projection": LISPSM, "filter": "variance", "partition": PSSM},
    "LiSPSM + depth + PSSM": {"projection": LISPSM, "filter": "depth", "partition": PSSM},
    "LiSPSM + VSM, as large": {
        "projection": LISPSM,
        "filter": "variance",
        "resolution": 2 * RESOLUTION,
    },
}
BASE, RECOMMENDED, SPLIT, LARGE = (
    list(TECHNIQUES).index(name)
    for name in (
        "uniform + depth",
        "LiSPSM + VSM",
        "LiSPSM + VSM + PSSM",
        "LiSPSM + VSM, as large",
    )
)
TEXT = """Wrong light where surfaces face it, PSNR against exact shadows, and seconds of CPU to make
the maps and look all pixels up. PSSM has four parts, each of 512 × 512 texels; *as large* is one
map of as many texels, 1024 × 1024."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the recommended combination of methods; return their section."""
    use_variant()
    found = measure_all(measure_techniques, SCENES, report)
    means = {scene: cells.mean(axis=(0, 1)) for scene, cells in found.items()}
    claims = [claim_gain(means), claim_split(means), claim_size(means), claim_best(means)]
    rows = [
        (
            scene,
            name,
            f"{100 * values[i, 0]:.2f}",
            f"{values[i, 1]:.1f}",
            f"{1e3 * values[i, 2]:.0f}",
        )
        for scene, values in means.items()
        for i, name in enumerate(TECHNIQUES)
    ]
    heads = "scene", "technique", "wrong light [%]", "PSNR [dB]", "time [ms]"
    caption = "`street`, view V1: exact shadows, and those by three of the techniques."
    pictures = [Picture("combination", draw_street(), caption)]
    return Section("What is recommended", TEXT, claims, [Table(heads, rows)], pictures)


def measure_techniques(view):
    """Return the mean error, the PSNR [dB] and the CPU seconds of each technique, in one view."""
    found = []
    for technique in TECHNIQUES.values():
        lit = view.compute_lit(view.make_shadow(**technique))
        seconds = measure_least_seconds(
            lambda how: view.compute_lit(view.make_shadow(**how)), technique, times=1
        )
        found.append((view.measure_error(lit), view.compute_psnr(lit), seconds))
    return found


def compare_gains(means, better, worse):
    """Return the gain of one technique over another as text, and whether it gains in each scene.

    The gain is in dB, with the ratio of times; `better` and `worse` are indices of techniques.
    """
    return (
        ", ".join(
            f"{scene} {values[better, 1] - values[worse, 1]:+.1f} dB at "
            f"{values[better, 2] / values[worse, 2]:.1f} times the time"
            for scene, values in means.items()
        ),
        all(values[better, 1] > values[worse, 1] for values in means.values()),
    )


def claim_gain(means):
    ours, holds = compare_gains(means, RECOMMENDED, BASE)
    return Claim(
        "LiSPSM + VSM is better than uniform depth maps.",
        "5",
        "the recommendation",
        ours,
        to_verdict(holds),
    )


def claim_split(means):
    ours, holds = compare_gains(means, SPLIT, RECOMMENDED)
    return Claim(
        "PSSM improves it.",
        "2.2.3, 5",
        "the statement",
        ours,
        to_verdict(holds),
        "Its four maps have four times the texels.",
    )


def claim_size(means):
    ours, holds = compare_gains(means, SPLIT, LARGE)
    return Claim(
        "PSSM is better than one map of as many texels.",
        "2.2.3",
        "no figure",
        ours,
        UNSTATED,
        "It is, in each scene." if holds else "Not in each scene.",
    )


def claim_best(means):
    names = list(TECHNIQUES)
    best = {scene: names[int(values[:, 1].argmax())] for scene, values in means.items()}
    return Claim(
        "LiSPSM + VSM + PSSM comes next to stencil volumes, over all.",
        "5",
        "the recommendation",
        ", ".join(f"{scene}: {name}" for scene, name in best.items()),
        to_verdict(set(best.values()) == {names[SPLIT]}),
        "The best of this table by PSNR. With hard shadows for the truth the filter is what costs; "
        "see Table 4.",
    )


def draw_street():
    """Draw the scene `street` by three techniques."""
    chosen = "uniform + depth", "LiSPSM + VSM", "LiSPSM + VSM + PSSM"
    return View.load("street", "V1", 1).draw_techniques({name: TECHNIQUES[name] for name in chosen})
