"""Checks whether one formula fits the sorted powers of an environment map's blocks.

The thesis's law needs a single number in place of the power of each block.
"""

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import read_probes
from brdfkit.theses.ergun2015.map_samplers import COMPRESSION, FEW, OURS

from brdfkit.core.colours import luminance
from brdfkit.images.errors.psnr import psnr
from brdfkit.lighting.sampling import tree
from brdfkit.lighting.sampling.block_laws import Hyperbolic, Steps
from brdfkit.lighting.sampling.power_map import cell_power
from brdfkit.theses.claims import UNSTATED, Claim, to_verdict
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 6
COUNTS = 64, 128, FEW, 256, 512, 1024, 2048, OURS
CRITERIA = {"the thesis's blocks": ("sse", FEW), "brdfkit's blocks": ("relative", OURS)}
BAR = 0.1  # of a sample's relative variance: what the law may add to it
TEXT = f"""Blocks are sorted by their share of the power, the largest first. The thesis's law gives
block i the probability log(1 + 1/(u + i)) / log(1 + n/u), eq. 6.4, with one parameter u, which is
fitted here by maximum likelihood: the thesis does not say how. It does not tell its number of
blocks; at the 1:{COMPRESSION} of Figure 9.3 a map of ours has {FEW}. They are cut by the sum of
squared errors; brdfkit's, {OURS:,}, by the variance that they leave. The law of steps, which is
brdfkit's, has equal probabilities in each of eight ranges of ranks."""


def check_claims(sources, report):
    """Check the claims on the law of sorted block powers; return their section of the page."""
    maps = read_probes(sources)
    added = {label: {} for label in CRITERIA}
    for done, (name, rgb) in enumerate(maps.items()):
        power = cell_power(luminance(rgb))
        for label, (criterion, _) in CRITERIA.items():
            for count in COUNTS:
                shares = compute_sorted_shares(power, count, criterion)
                added[label][name, f"{count:,}"] = [
                    compute_added_variance(shares, law.fit_to_shares(shares))
                    for law in (Hyperbolic, Steps)
                ]
        report(done + 1, len(maps))
    claims = [claim_law(), *(claim_shape(label, added[label]) for label in CRITERIA)]
    return Section(
        "The law of sorted blocks",
        TEXT,
        [*claims, claim_compression(maps)],
        [tabulate_added(label, by, list(maps)) for label, by in added.items()],
        [Picture("block_law", draw_laws(maps), "Sorted shares, and the laws fitted to them.")],
    )


def compute_sorted_shares(power, count, criterion):
    """Return the blocks' shares (n,) of a map's power, the largest first."""
    boxes = tree.build_tree(power, count, criterion).blocks
    shares = tree.block_sums(power, boxes).clip(0)
    return np.sort(shares / shares.sum())[::-1]


def compute_added_variance(shares, law):
    """Return the relative variance of samples drawn by a law, beyond that by exact shares."""
    return float(np.sum(shares**2 / law.probability(np.arange(len(shares)))) - 1)


def tabulate_added(label, added, names):
    """Return a table of what the law adds to a sample's variance: a row per map."""
    counts = [f"{count:,}" for count in COUNTS]
    rows = [(name, *(f"{added[name, count][0]:.3f}" for count in counts)) for name in names]
    caption = f"What the law adds to the relative variance of a sample, for {label}."
    return Table(("map", *(f"{count} blocks" for count in counts)), rows, caption)


def claim_law():
    """Claim that the law's probabilities sum to 1 and that its inverse is exact."""
    law, xi = Hyperbolic(256, 5.0), np.linspace(0, 1, 1001)[:-1]
    off = abs(law.probability(np.arange(256)).sum() - 1)
    back = np.abs(law.cumulative_probability(law.inverse_cumulative(xi)) - xi).max()
    return Claim(
        "The law's probabilities sum to 1, and its inverse is a closed form.",
        "eqs. 6.3-6.5",
        "sum 1, F(F⁻¹(ξ)) = ξ",
        f"sum off by {off:.0e}, ξ by {back:.0e}",
        to_verdict(max(off, back) < 1e-12),
        "n = 256, u = 5.",
        arithmetic=True,
    )


def claim_shape(label, added):
    """Claim that sorted shares are near a hyperbola, by the variance that this adds to samples.

    `added` maps each map and number of blocks to what the thesis's law and the law of steps add.
    """
    ours, verdict = judge_over_grid(
        ("map", "number of blocks"), {cell: by[0] < BAR for cell, by in added.items()}
    )
    hyperbolic, steps = np.array(list(added.values())).T
    return Claim(
        f"Sorted blocks look like 1 / (x + u), so that the law may replace their shares: {label}.",
        "6.3, Figure 6.3",
        "a drawing",
        f"adds less than {BAR:g} to the relative variance of a sample {ours}; "
        f"{hyperbolic.min():.2f} to {hyperbolic.max():.2f}, steps {steps.min():.2f} to "
        f"{steps.max():.2f}",
        verdict,
        "Sorted shares of many blocks fall faster than a hyperbola at the end, and lamps stand out "
        f"at the beginning. The thesis gives no measure: the bar of {BAR:g} is ours, near the 0.08 "
        "of cumulative sums. The estimate has no bias all the same: P̂ divides it, not the share.",
    )


def claim_compression(maps):
    """Claim that a map of blocks is still recognised at the thesis's compression."""
    name = "uffizi" if "uffizi" in maps else next(iter(maps))
    power = cell_power(luminance(maps[name]))
    count = max(power.size // COMPRESSION, 1)
    boxes = tree.build_tree(power, count, "sse").blocks
    means = tree.block_sums(power, boxes)
    held = np.empty_like(power)
    for (x0, x1, y0, y1), total in zip(boxes, means, strict=True):
        held[y0:y1, x0:x1] = total / ((x1 - x0) * (y1 - y0))
    quality = psnr(power, held, peak=power.max())
    return Claim(
        f"Uffizi is still recognised at 1:{COMPRESSION}.",
        "Figure 9.3",
        "a drawing",
        f"{name}: {len(boxes):,} blocks for {power.size:,} pixels, PSNR {quality:.1f} dB",
        UNSTATED,
        "Of the power per angle; the thesis compared by eye, and does not say what it counts as "
        "stored.",
    )


def draw_laws(maps):
    """Draw sorted shares and laws, a row per map: of the thesis's and of brdfkit's blocks."""
    drawn = make_figure(8, 2.3 * len(maps))
    grid = drawn.subplots(len(maps), len(CRITERIA), squeeze=False)
    for row, (name, rgb) in zip(grid, maps.items(), strict=True):
        for axes, (label, (criterion, count)) in zip(row, CRITERIA.items(), strict=True):
            shares = compute_sorted_shares(cell_power(luminance(rgb)), count, criterion)
            laws = {
                "hyperbolic": Hyperbolic.fit_to_shares(shares),
                "steps": Steps.fit_to_shares(shares),
            }
            draw_shares(axes, f"{name}, {label}", shares, laws)
    grid[0, 0].legend(frameon=False)
    return drawn


def draw_shares(axes, name, shares, laws):
    """Draw sorted shares and laws over the rank of the block, both logarithmic."""
    rank = np.arange(len(shares)) + 1
    axes.loglog(rank, shares, color=COLOURS[-1], linewidth=2, label="shares")
    for (label, law), colour in zip(laws.items(), COLOURS, strict=False):
        axes.loglog(rank, law.probability(rank - 1), color=colour, linewidth=1.2, label=label)
    axes.set_ylim(max(shares[-1], 1e-8) / 2, shares[0] * 3)
    axes.set_xlabel("rank of the block")
    style_axes(axes, name, "probability")
