"""Measures the variance of samples over the number of blocks, by the thesis's form and by ours."""

import numpy as np
from brdfkit.theses.ergun2015.block_law import COUNTS
from brdfkit.theses.ergun2015.lit_balls import read_probes
from brdfkit.theses.ergun2015.map_samplers import (
    DRAWS,
    make_our_emitter,
    make_rival_emitter,
    make_thesis_emitter,
    measure_variance,
)

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 40
THESIS, THESIS_SHARES, OURS_LAW, OURS = "thesis", "thesis, by share", "brdfkit, by law", "brdfkit"
FORMS = {
    THESIS: (make_thesis_emitter, "hyperbolic"),
    THESIS_SHARES: (make_thesis_emitter, "exact"),
    OURS_LAW: (make_our_emitter, "hyperbolic"),
    OURS: (make_our_emitter, "exact"),
}
TEXT = f"""The variance of L / p, over the square of its mean, where L is the luminance of the map
between its pixels and p the density of {DRAWS:,} samples. *Thesis*: blocks by the sum of squared
errors, a uniform density in each, and the law. *By share*: the same blocks, drawn by their shares.
*brdfkit*: blocks of least variance, with linear densities, by law or by share. With the law, more
blocks are not always better: what it adds grows with their number in maps with lamps, while what is
left in the blocks falls."""


@in_turn
def check_claims(sources, report):
    """Measure how noisy samples are by the number of blocks; return the section of the page."""
    use_variant()
    maps = read_probes(sources)
    found, sums = {}, {}
    for name, rgb in maps.items():
        sums[name] = measure_variance(make_rival_emitter(rgb))
        for count in COUNTS:
            found[name, f"{count:,}"] = [
                measure_variance(make(rgb, count, distribution))
                for make, distribution in FORMS.values()
            ]
            report(len(found), len(maps) * len(COUNTS))
    means = average_over_maps(found)
    mean_sums = np.mean(list(sums.values()))
    rows = [
        (count, *(f"{value:.3f}" for value in row), f"{mean_sums:.3f}")
        for count, row in means.items()
    ]
    table = Table(("blocks", *FORMS, "cumulative sums"), rows, describe_least(means))
    picture = Picture("block_counts", draw_curves(found, sums, list(maps)))
    return Section("The number of blocks", TEXT, tables=[table], pictures=[picture])


def average_over_maps(found):
    """Return the mean variances of `FORMS` over all maps, by number of blocks."""
    counts = dict.fromkeys(count for _, count in found)
    return {n: np.mean([by for (_, c), by in found.items() if c == n], axis=0) for n in counts}


def describe_least(means):
    """Return in words at which number of blocks each form has the least variance in the mean."""
    counts, table = list(means), np.array(list(means.values()))
    least = ", ".join(
        f"{form} at {counts[k]}" for form, k in zip(FORMS, table.argmin(axis=0), strict=True)
    )
    return f"Mean over maps. The least is at so many blocks: {least}."


def draw_curves(found, sums, names):
    """Draw the variance over the number of blocks, both logarithmic, for each map."""
    drawn = make_figure(8, 2.7 * ((len(names) + 1) // 2))
    grid = drawn.subplots((len(names) + 1) // 2, 2, squeeze=False)
    for axes, name in zip(grid.flat, names, strict=False):
        for column, (form, colour) in enumerate(zip(FORMS, COLOURS, strict=False)):
            values = [by[column] for (n, _), by in found.items() if n == name]
            axes.loglog(COUNTS, values, "o-", color=colour, markersize=3, label=form)
        axes.axhline(sums[name], color=COLOURS[-1], linestyle=":", label="cumulative sums")
        axes.set_xlabel("blocks")
        style_axes(axes, name, "relative variance")
    for axes in grid.flat[len(names) :]:
        axes.remove()
    grid[0, 0].legend(frameon=False, fontsize=7)
    return drawn
