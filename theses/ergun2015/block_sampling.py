"""Compares pictures whose light is sampled by blocks with those by cumulative sums of the map."""

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import read_probes
from brdfkit.theses.ergun2015.map_samplers import (
    DRAWS,
    FEW,
    OURS,
    draw_weights,
    make_our_emitter,
    make_rival_emitter,
    make_sloped_emitter,
    make_thesis_emitter,
)

from brdfkit.core.colours import luminance
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.images.errors.psnr import psnr
from brdfkit.lighting.sampling import tree
from brdfkit.lighting.sampling.block_laws import Hyperbolic
from brdfkit.lighting.sampling.power_map import cell_power
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.grid import judge_over_grid
from brdfkit.theses.page import Section, Table
from brdfkit.theses.timing import compare_times, measure_in_turns

SECONDS = 150
SIZE, SPP, REFERENCE = 96, 16, 4096
SEEDS = 4  # pictures of each kind, whose squared errors are averaged
TURNS = 11  # measurements of each time
SUMS = "cumulative sums"
COUNTS = FEW, 512, 1024, OURS  # of the thesis's blocks
THESIS = {
    f"thesis, {count:,}": lambda rgb, count=count: make_thesis_emitter(rgb, count)
    for count in COUNTS
}
LINEAR, OUR_LAW, SHARES = "1,024, linear, by law", "brdfkit, by law", "brdfkit, by share"
SAMPLERS = {
    **THESIS,
    LINEAR: lambda rgb: make_sloped_emitter(rgb, 1024),
    OUR_LAW: lambda rgb: make_our_emitter(rgb, distribution="hyperbolic"),
    SHARES: make_our_emitter,
    SUMS: make_rival_emitter,
}
MATERIALS = {
    "chrome-steel": {"type": "roughconductor", "material": "Cr", "alpha": 0.1},
    "metallic-blue": {
        "type": "ggx",
        "diffuse_reflectance": {"type": "rgb", "value": [0.02, 0.04, 0.15]},
        "specular_reflectance": {"type": "rgb", "value": [0.2, 0.3, 0.6]},
        "alpha_u": 0.2,
        "f0": 0.5,
    },
    "white-diffuse": {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.8}},
}
CLOSE = 0.5  # dB: a smaller difference of two PSNRs counts as equal
SAYS = "At equal samples, pictures from blocks are as good as from cumulative sums"
CHOSEN = "; 1,024 is where the law has the least variance on these maps"
WHY = f"""Confirmed where at most {CLOSE:g} dB are lost in the mean. The thesis's PSNRs are lost,
and it does not say whether samples or time were equal: pictures of equal time were not made."""
TEXT = f"""A ball of {SIZE} × {SIZE} pixels in each map, with {SPP} samples of the light per pixel
and none of the surface, against one with {REFERENCE:,} samples of both. PSNR of linear values, peak
the 99.9th percentile, of {SEEDS} pictures. The thesis names three materials and no formula: ours
are rough chromium (α = 0.1), a blue metallic `ggx` (α = 0.2) and a white diffuse ball. *Thesis*: so
many blocks by the sum of squared errors, uniform in each, drawn by the law; *linear*: such blocks
with brdfkit's linear densities. *brdfkit*: {OURS:,} blocks of least variance with linear densities,
by the law or by share."""


@in_turn
def check_claims(sources, report):
    """Check the claims on light samples by blocks of a map; return their section."""
    use_variant()
    maps = read_probes(sources)
    total, rows, differences = len(maps) * len(MATERIALS), [], {name: [] for name in SAMPLERS}
    for name, rgb in maps.items():
        lamps = {label: make(rgb) for label, make in SAMPLERS.items()}
        for material, bsdf in MATERIALS.items():
            found = compare_samplers(lamps, bsdf)
            rows.append((name, material, *(f"{value:.1f}" for value in found.values())))
            for label, value in found.items():
                differences[label].append(value - found[SUMS])
            report(len(rows), total + 2)
    bias = claim_bias(maps)
    report(total + 1, total + 2)
    qualities = [claim_thesis(differences)]
    qualities += [claim_quality(differences, label) for label in (LINEAR, OUR_LAW, SHARES)]
    table = Table(("map", "material", *SAMPLERS), rows, "PSNR [dB].")
    return Section("Samples of blocks", TEXT, [bias, claim_time(maps), *qualities], [table])


def compare_samplers(lamps, bsdf):
    """Return the PSNR [dB] by emitter of pictures of a ball in its light, at equal samples."""
    reference = render_ball(bsdf, lamps[SHARES], {"type": "direct"}, REFERENCE, 0)
    by_light = {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0}
    truth = np.stack([reference] * SEEDS)
    return {
        label: psnr(
            truth,
            np.stack([render_ball(bsdf, lamp, by_light, SPP, 1 + k) for k in range(SEEDS)]),
        )
        for label, lamp in lamps.items()
    }


def render_ball(bsdf, lamp, integrator, spp, seed):
    """Render a ball of a BSDF (SIZE, SIZE, 3), without the background."""
    import mitsuba as mi

    scene = mi.load_dict(
        {
            "type": "scene",
            "integrator": integrator | {"hide_emitters": True},
            "sensor": {
                "type": "orthographic",
                "to_world": mi.ScalarTransform4f().look_at([0, 0, 4], [0, 0, 0], [0, 1, 0]),
                "film": {
                    "type": "hdrfilm",
                    "width": SIZE,
                    "height": SIZE,
                    "pixel_format": "rgb",
                    "rfilter": {"type": "box"},
                },
                "sampler": {"type": "independent"},
            },
            "ball": {"type": "sphere", "bsdf": bsdf},
            "lamp": lamp,
        },
        parallel=False,
    )
    return np.array(mi.render(scene, spp=spp, seed=seed), float)


def claim_bias(maps):
    """Claim that samples by the fitted law have the map's integral as their mean."""
    z = []
    for rgb in maps.values():
        drawn, exact = (
            draw_weights(make(rgb)) for make in (make_thesis_emitter, make_rival_emitter)
        )
        errors = np.hypot(drawn.std(), exact.std()) / np.sqrt(DRAWS)
        z.append((drawn.mean() - exact.mean()) / errors)
    return Claim(
        "Samples by the fitted law are unbiased.",
        "6.3",
        "by construction",
        f"z-score of the map's integral between {min(z):+.1f} and {max(z):+.1f}",
        to_verdict(np.abs(z).max() < 3),
        f"The thesis's form, {FEW} blocks: {DRAWS:,} samples of each map, against as many by "
        "cumulative sums.",
        arithmetic=True,
    )


def claim_time(maps):
    """Claim that blocks and law take no longer to prepare than cumulative sums."""
    power = [cell_power(luminance(rgb)) for rgb in maps.values()]
    kinds = {FEW: "sse", OURS: "relative"}
    functions = {n: lambda n=n: [_prepare_blocks(p, n, kinds[n]) for p in power] for n in kinds}
    functions[SUMS] = lambda: [_prepare_sums(p) for p in power for _ in range(10)]
    seconds = measure_in_turns(functions, TURNS)
    seconds[SUMS] /= 10
    few, ours = (compare_times(seconds[n], seconds[SUMS]) for n in kinds)
    return Claim(
        "To prepare the blocks takes no longer than to prepare cumulative sums.",
        "9.1",
        "963 ms and 973 ms",
        f"without reading the map, {few} times as long with the thesis's {FEW} blocks, {ours} with "
        f"brdfkit's {OURS:,}",
        to_verdict(few.low <= 1.1),
        f"NumPy's cumulative sums over {power[0].shape[1]} × {power[0].shape[0]} cells; in "
        "brackets the 95 % interval of pairs. Both times of the thesis are of PBRT, and probably "
        "hold what they share, such as reading the map, beside which either may be small.",
    )


def _prepare_blocks(power, count, criterion):
    boxes = tree.build_tree(power, count, criterion).blocks
    shares = np.sort(tree.block_sums(power, boxes))[::-1]
    Hyperbolic.fit_to_shares(shares / shares.sum())


def _prepare_sums(power):
    rows = power.cumsum(axis=1)
    rows[:, -1].cumsum()


def claim_thesis(differences):
    """Claim that pictures by the thesis's form are as good, over numbers of blocks."""
    means = {label: np.mean(differences[label]) for label in THESIS}
    ours, verdict = judge_over_grid(
        ("number of blocks",),
        {(f"{n:,}",): means[label] > -CLOSE for n, label in zip(COUNTS, THESIS, strict=True)},
    )
    figures = ", ".join(f"{means[label]:+.1f}" for label in THESIS)
    counts = ", ".join(f"{n:,}" for n in COUNTS)
    return Claim(
        f"{SAYS}: the thesis's form.",
        "Figure 9.1",
        "equal quality",
        f"{ours}: {figures} dB in the mean with {counts} blocks",
        verdict,
        WHY,
    )


def claim_quality(differences, label):
    """Claim that pictures by another form than the thesis's are as good as by sums."""
    found = differences[label]
    return Claim(
        f"{SAYS}: {label}.",
        "Figure 9.1",
        "equal quality",
        f"{np.mean(found):+.1f} dB in the mean, {min(found):+.1f} to {max(found):+.1f}"
        + (CHOSEN if label == LINEAR else ""),
        to_verdict(np.mean(found) > -CLOSE),
        WHY,
    )
