"""Makes the thesis's methods for 80 scenes over a grid of what it does not tell, and judges them.

These are the number of kernels, the share of a lobe that a texel of its mip level covers, the
number of directions of filtered sampling, the bias of their level, and the filter of the warped
lobe's map, which Wang convolves with lobes and the thesis also looks up in mips.
"""

import math
from itertools import product

from brdfkit.theses.ergun2015.printed_lobes import PrintedLobes, PrintedMixtures

from brdfkit.lighting.filtering.bsdf_directions import OVERLAP
from brdfkit.lighting.filtering.filtered_sampling import FilteredSampling
from brdfkit.lighting.filtering.paraboloid_levels import COVERAGE
from brdfkit.theses.claims import Claim
from brdfkit.theses.grid import judge_over_grid

GOOD = 30  # dB: the PSNR from which a scene counts
CLOSE = 0.05  # of the scenes: two counts that differ by no more are called near
PRINTED = {"kde": 61, "warped": 53, "filtered_sampling": 52}  # of 80 scenes
KERNELS = 8, 16, 32
COVERAGES = 0.5, 0.9
DIRECTIONS = 16, 64, 128
BIASES = 0, 1  # levels that filtered sampling adds; [Colbert & Křivánek 2007] add one
FILTERS = "mips", "lobes"
SETTINGS = "number of kernels", "coverage", "number of directions", "bias", "warped lobe's filter"


class PrintedSampling(FilteredSampling):
    """Filtered sampling at the published level: a direction has the solid angle 4^bias / (N p).

    brdfkit's is chosen for Ward's lobe and one of the thesis's very maps.
    """

    def __init__(self, count, bias):
        super().__init__(count)
        self.narrower = -math.log(1 - COVERAGE) / OVERLAP / 4**bias

    def radiance(self, scene, sampler, si, light, active):
        """Return the reflected radiance like `FilteredSampling`, by lobes of another width."""
        return super().radiance(scene, sampler, si, NarrowedLight(light, self.narrower), active)


class NarrowedLight:
    """A `Light` whose lobes are narrower by a factor of their concentration."""

    def __init__(self, light, factor):
        self.light, self.factor, self.irradiance = light, factor, light.irradiance

    def mean_radiance_over_lobe(self, axis, kappa):
        """Return the mean radiance over a lobe that is narrower than asked for."""
        return self.light.mean_radiance_over_lobe(axis, kappa * self.factor)


def make_printed_integrators(lights):
    """Return an integrator for each of the thesis's forms, by its label.

    `lights` are the filtered lights by filter, which all of them share.
    """
    import mitsuba as mi

    shadings = {name_warped(a, "mips"): (PrintedLobes(1, a), "mips") for a in COVERAGES}
    shadings[name_warped(COVERAGE, "lobes")] = PrintedLobes(1), "lobes"
    for n, a in product(KERNELS, COVERAGES):
        shadings[name_kernels(n, a)] = PrintedLobes(n, a), "mips"
    for a in COVERAGES:
        shadings[name_mixture(a)] = PrintedMixtures(a), "mips"
    for n, b in product(DIRECTIONS, BIASES):
        shadings[name_sampling(n, b)] = PrintedSampling(n, b), "mips"
    found = {}
    for label, (shading, filter_) in shadings.items():
        made = mi.load_dict({"type": "filtered_environment", "filter": filter_})
        made.shading, made.light = shading, lights[filter_]
        found[label] = made
    return found


def name_warped(coverage, filter_):
    """Return the label of the warped lobe as printed; convolved maps have no coverage."""
    return "warped, printed: lobes" if filter_ == "lobes" else f"warped, printed: a = {coverage:g}"


def name_kernels(count, coverage):
    """Return the label of kernels as printed."""
    return f"kde, printed: {count}, a = {coverage:g}"


def name_mixture(coverage):
    """Return the label of mixtures as printed."""
    return f"gmm, printed: a = {coverage:g}"


def name_sampling(count, bias):
    """Return the label of filtered sampling at the published level."""
    return f"filtered_sampling, published: {count}, bias {bias}"


def count_over_grid(by_kind):
    """Return the scenes over 30 dB of the three methods, for each cell of the grid of settings.

    `by_kind` maps labels to PSNRs (scenes, 2), of which the first is that of 8-bit sRGB.
    """
    good = {label: count_good(values) for label, values in by_kind.items()}
    return {
        (str(n), f"{a:g}", str(d), str(b), f): {
            "kde": good[name_kernels(n, a)],
            "warped": good[name_warped(a, f)],
            "filtered_sampling": good[name_sampling(d, b)],
        }
        for n, a, d, b, f in product(KERNELS, COVERAGES, DIRECTIONS, BIASES, FILTERS)
    }


def claim_best_printed(by_kind):
    """Claim that kernels as printed have most scenes over 30 dB of three methods."""
    counts = count_over_grid(by_kind)
    ours, verdict = judge_over_grid(SETTINGS, {cell: is_best(by) for cell, by in counts.items()})
    return Claim(
        "Of three methods, kernels (KDE) have most scenes over 30 dB: the thesis's forms.",
        "9.3",
        f"{describe_counts(PRINTED)} of 80",
        f"{ours}; {describe_ranges(counts)} of {len(next(iter(by_kind.values())))}",
        verdict,
        describe_nearest(by_kind),
    )


def count_good(values):
    """Return how many scenes have a PSNR over 30 dB, of PSNRs (scenes, 2) with 8-bit sRGB first."""
    return int((values[:, 0] >= GOOD).sum())


def is_best(counts, lead=0):
    """Return whether kernels have more scenes than all other methods, by more than a `lead`."""
    return all(counts["kde"] > count + lead for name, count in counts.items() if name != "kde")


def describe_counts(counts):
    """Return the scenes of each method in words."""
    return ", ".join(f"{name} {count}" for name, count in counts.items())


def describe_nearest(by_kind):
    """Return in words which forms come nearest to the printed counts of kernels and sampling."""
    kernels = [name_kernels(n, a) for n, a in product(KERNELS, COVERAGES)]
    sampling = [name_sampling(d, b) for d, b in product(DIRECTIONS, BIASES)]
    words = []
    for names, printed in ((kernels, PRINTED["kde"]), (sampling, PRINTED["filtered_sampling"])):
        good = {name: count_good(by_kind[name]) for name in names}
        best = min(names, key=lambda name, good=good, printed=printed: abs(good[name] - printed))
        words.append(f"`{best}` with {good[best]} to the {printed}")
    return (
        f"The grid is of what the thesis does not tell. Nearest come {' and '.join(words)} printed."
    )


def claim_near_printed(by_kind):
    """Claim that the warped lobe as printed and filtered sampling have about as many scenes."""
    total = len(next(iter(by_kind.values())))
    lobes = {f"mips with a = {a:g}": name_warped(a, "mips") for a in COVERAGES}
    lobes["lobes"] = name_warped(COVERAGE, "lobes")  # convolved maps have no coverage
    good = {label: count_good(values) for label, values in by_kind.items()}
    cells = {
        (f, str(d), str(b)): abs(good[lobe] - good[name_sampling(d, b)]) <= CLOSE * total
        for (f, lobe), d, b in product(lobes.items(), DIRECTIONS, BIASES)
    }
    ours, verdict = judge_over_grid(("warped lobe's filter", *SETTINGS[2:4]), cells)
    return Claim(
        "One warped lobe [Wang et al. 2009] has as many as filtered sampling: the thesis's forms.",
        "9.3",
        "53 and 52 of 80",
        f"within {CLOSE * total:.0f} {ours}",
        verdict,
    )


def claim_matte_printed(means):
    """Claim that the warped lobe with mips is the worst of the thesis's forms on rough materials.

    `means` maps labels to mean PSNRs by roughness, of which the last is that of the roughest.
    """
    cells = {
        (str(n), f"{a:g}", str(d), str(b)): is_worst_at_the_end(
            means[name_warped(a, "mips")], means[name_kernels(n, a)], means[name_sampling(d, b)]
        )
        for n, a, d, b in product(KERNELS, COVERAGES, DIRECTIONS, BIASES)
    }
    ours, verdict = judge_over_grid(SETTINGS[:4], cells)
    lobe = [means[name_warped(a, "mips")] for a in COVERAGES]
    return Claim(
        "One warped lobe with mips is worst on matte materials: the thesis's forms.",
        "8.6",
        "no figure",
        f"{ours}; {min(m[0] for m in lobe):.1f} dB or more on the glossiest, "
        f"{max(m[-1] for m in lobe):.1f} dB at most on the most matte",
        verdict,
    )


def is_worst_at_the_end(values, *others):
    """Return whether the last of `values` is their least, and below the last of all `others`."""
    return bool(values[-1] == min(values) and all(values[-1] < other[-1] for other in others))


def describe_ranges(counts):
    """Return the least and the most scenes of each method over the grid, in words."""
    words = []
    for name in PRINTED:
        each = [by[name] for by in counts.values()]
        words.append(f"{name} {min(each)} to {max(each)}")
    return ", ".join(words)
