"""Measures the time of a sample of an environment map by several methods, and their memory."""

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import read_probes
from brdfkit.theses.ergun2015.map_samplers import (
    COMPRESSION,
    FEW,
    OURS,
    make_our_emitter,
    make_rival_emitter,
    make_thesis_emitter,
)

from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section, Table
from brdfkit.theses.timing import compare_times, measure_in_turns, wait_for

SECONDS = 60
WIDTH, DRAWS, TURNS = 1 << 18, 8, 15  # threads, samples of each, and measurements
LAW, SUMS = f"law, {FEW} blocks", "cumulative sums"
WALK = "walk down the tree"
METHODS = {
    LAW: make_thesis_emitter,
    f"law, {OURS:,} blocks": lambda rgb: make_thesis_emitter(rgb, OURS),
    "steps": lambda rgb: make_our_emitter(rgb, distribution="steps"),
    WALK: make_our_emitter,
    "alias table of blocks": lambda rgb: make_our_emitter(rgb, distribution="alias"),
    SUMS: make_rival_emitter,
    "alias tables of cells": lambda rgb: make_rival_emitter(rgb, "alias"),
    "envmap": lambda rgb: make_rival_emitter(rgb, "envmap"),
}
TEXT = f"""CPU time in one thread of {WIDTH * DRAWS:,} samples in one kernel, for each method in
turns, {TURNS} times; in brackets are 95 % intervals of the ratio of pairs. *Point*: a point of the
map and its density alone. *Direction*: with its radiance, as an integrator asks for it; Mitsuba's
`envmap` has only this. The law has the thesis's blocks of uniform density. Steps, the walk and one
alias table have brdfkit's {OURS:,} blocks with linear densities; the other alias tables are those
of the map's rows and of the cells of each. Bytes are those of the tables from which samples are
drawn, without the map."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the time and the memory of samples; return their section of the page."""
    use_variant()
    name, rgb = next(iter(read_probes(sources).items()))
    lamps = {label: make(rgb) for label, make in METHODS.items()}
    points = {label: lamp.map_sampler for label, lamp in lamps.items() if label != "envmap"}
    report(1, 3)
    by_point = measure_in_turns(
        {
            label: lambda by=by: draw_many(lambda u: draw_point(by, u))
            for label, by in points.items()
        },
        TURNS,
    )
    report(2, 3)
    by_direction = measure_in_turns(
        {
            label: lambda by=by: draw_many(lambda u: draw_direction(by, u))
            for label, by in lamps.items()
        },
        TURNS,
    )
    report(3, 3)
    memory = {label: count_bytes(by) for label, by in points.items()}
    rows = [
        (
            label,
            *describe_time(by_point, label),
            *describe_time(by_direction, label),
            f"{memory[label]:,}" if label in memory else "",
        )
        for label in METHODS
    ]
    heads = "method", "point [ns]", f"over {SUMS}", "direction [ns]", f"over {SUMS}", "bytes"
    caption = f"Of {name}, {rgb.shape[1]} × {rgb.shape[0]} pixels."
    claims = [
        claim_faster("a point", by_point),
        claim_faster("a direction", by_direction),
        claim_walk(by_point, by_direction),
        claim_memory(memory, rgb),
    ]
    drawing = (
        "Bars are medians, dark that of the thesis's form, and lines reach from the least to the "
        "largest measurement."
    )
    picture = Picture("sample_times", draw_times(by_point, by_direction), drawing)
    return Section("The time of a sample", TEXT, claims, [Table(heads, rows, caption)], [picture])


def draw_point(sampler, u):
    """Draw a point of a map by two uniform numbers; return numbers that depend on all of it."""
    import mitsuba as mi

    return sum(sampler.sample(u, mi.Bool(True)))


def draw_direction(lamp, u):
    """Draw a direction of an emitter like `draw_point`."""
    import drjit as dr
    import mitsuba as mi

    ds, weight = lamp.sample_direction(dr.zeros(mi.SurfaceInteraction3f), u)
    return ds.d.x + ds.d.y + ds.d.z + ds.pdf + weight.x + weight.y + weight.z


def draw_many(draw):
    """Run a kernel that draws many samples, and adds up what `draw` returns for each."""
    import drjit as dr
    import mitsuba as mi

    def add(i, total, numbers):
        u = mi.Point2f(numbers.next_float32(), numbers.next_float32())
        return i + 1, total + draw(u), numbers

    _, total, _ = dr.while_loop(
        (mi.UInt32(0), mi.Float(0), mi.PCG32(WIDTH)), lambda i, *_: i < DRAWS, add
    )
    wait_for(total)


def count_bytes(sampler):
    """Return the bytes of the tables from which a sampler draws, without look-ups of densities."""
    return getattr(sampler, "sampler", sampler).nbytes


def describe_time(seconds, label):
    """Return the median nanoseconds of a sample, and the ratio of times by pairs, in words."""
    if label not in seconds:
        return "", ""
    each = 1e9 * np.median(seconds[label]) / (WIDTH * DRAWS)
    return f"{each:.1f}", str(compare_times(seconds[label], seconds[SUMS]))


def claim_faster(what, seconds):
    """Claim that a sample by the thesis's law takes less time than one by cumulative sums."""
    ratio = compare_times(seconds[SUMS], seconds[LAW])
    return Claim(
        f"To draw {what} by the law takes less time than by cumulative sums: the thesis's form.",
        "9.1, Figure 9.2",
        "a drawing",
        f"{ratio} times as fast",
        to_verdict(ratio.low > 1),
        "O(1) against O(log n): confirmed where the whole interval is above 1.",
    )


def claim_walk(*seconds):
    """Claim that a walk down a stored tree is slower than cumulative sums."""
    point, direction = (compare_times(by[WALK], by[SUMS]) for by in seconds)
    return Claim(
        "A stored tree is slower in practice than cumulative sums: brdfkit's blocks.",
        "6.2",
        "no figure",
        f"a point takes {point} times as long, a direction {direction}",
        to_verdict(min(point.low, direction.low) > 1),
        f"The walk draws one of {OURS:,} blocks. The thesis walks twice, for a density besides.",
    )


def claim_memory(memory, rgb):
    """Claim that blocks take memory by their number, and less than cumulative sums."""
    smaller = rgb[::2, ::2]
    fixed = [count_bytes(make_thesis_emitter(m).map_sampler) for m in (rgb, smaller)]
    sums = [count_bytes(make_rival_emitter(m).map_sampler) for m in (rgb, smaller)]
    ratio = memory[SUMS] / memory[LAW]
    return Claim(
        "Blocks take O(b) memory, cumulative sums O(n m).",
        "9.1",
        f"1:{COMPRESSION} in Figure 9.3",
        f"{fixed[0]:,} bytes for {FEW} blocks and {fixed[1]:,} on a map of a quarter of the "
        f"pixels; sums {sums[0]:,} and {sums[1]:,}",
        to_verdict(fixed[0] == fixed[1] and sums[0] > 3 * sums[1] and ratio > 1),
        f"{ratio:.0f} times less, by {memory[LAW] // FEW} bytes of a block: the 1:{COMPRESSION} is "
        "one of numbers, of pixels to blocks, by which we chose ours. The density in a "
        "direction of a BSDF takes a fourth channel of the map besides.",
        arithmetic=True,
    )


def draw_times(by_point, by_direction):
    """Draw the nanoseconds of a sample by each method, with the range of the measurements."""
    drawn = make_figure(8, 3)
    for axes, (title, seconds) in zip(
        drawn.subplots(1, 2, sharey=True),
        {"a point of the map": by_point, "a direction with its radiance": by_direction}.items(),
        strict=True,
    ):
        for row, label in enumerate(METHODS):
            if label in seconds:
                each = 1e9 * seconds[label] / (WIDTH * DRAWS)
                least, middle, most = np.percentile(each, (0, 50, 100))
                axes.barh(row, middle, color=COLOURS[0 if label == LAW else 4])
                axes.plot((least, most), (row, row), color=COLOURS[-1])
        axes.set_yticks(range(len(METHODS)), list(METHODS))
        axes.set_ylim(len(METHODS) - 0.5, -0.5)
        axes.set_xlabel("ns")
        style_axes(axes, title, "")
    return drawn
