"""Compares pictures whose light is sampled by blocks with those by cumulative sums of the map."""

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import read_probes

from brdfkit.core.colours import luminance
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.images.errors.psnr import psnr
from brdfkit.lighting.sampling import tree
from brdfkit.lighting.sampling.block_laws import Hyperbolic
from brdfkit.lighting.sampling.power_map import cell_power
from brdfkit.theses.claims import Claim, measure_least_seconds, to_verdict
from brdfkit.theses.page import Section, Table

SECONDS = 60
BLOCKS, SIZE, SPP, REFERENCE = 4096, 96, 16, 4096
DRAWS = 1 << 20
SAMPLERS = {
    "blocks by share": {"type": "kdtree_envmap", "criterion": "sse"},
    "blocks by law": {
        "type": "kdtree_envmap",
        "criterion": "sse",
        "distribution": "hyperbolic",
    },
    "cumulative sums": {"type": "sampled_envmap", "sampler": "cdf"},
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
TEXT = f"""A ball of {SIZE} × {SIZE} pixels in each map, with {SPP} samples of the light per pixel
and none of the surface, against one with {REFERENCE:,} samples of both. PSNR of linear values, peak
the 99.9th percentile. The thesis names three materials and no formula: ours are rough chromium
(α = 0.1), a blue metallic `ggx` (α = 0.2) and a white diffuse ball. {BLOCKS:,} blocks."""


@in_turn
def check_claims(sources, report):
    """Check the claims on light samples by blocks of a map; return their section."""
    use_variant()
    maps = read_probes(sources)
    total, rows, differences = len(maps) * len(MATERIALS), [], {name: [] for name in SAMPLERS}
    for name, rgb in maps.items():
        for material, bsdf in MATERIALS.items():
            found = compare_samplers(rgb, bsdf)
            rows.append((name, material, *(f"{value:.1f}" for value in found.values())))
            for label, value in found.items():
                differences[label].append(value - found["cumulative sums"])
            report(len(rows), total + 2)
    bias = claim_bias(maps)
    report(total + 1, total + 2)
    claims = [bias, claim_time(maps), *(claim_quality(differences, n) for n in list(SAMPLERS)[:2])]
    table = Table(("map", "material", *SAMPLERS), rows, "PSNR [dB].")
    return Section("Samples of blocks", TEXT, claims, [table])


def compare_samplers(rgb, bsdf):
    """Return the PSNR [dB] by sampler of pictures of a ball in the map `rgb`, at equal samples."""
    lamps = {name: make_emitter(rgb, how) for name, how in SAMPLERS.items()}
    reference = render_ball(bsdf, lamps["blocks by share"], {"type": "direct"}, REFERENCE)
    by_light = {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0}
    return {
        name: psnr(reference, render_ball(bsdf, lamp, by_light, SPP))
        for name, lamp in lamps.items()
    }


def make_emitter(rgb, how):
    """Return the Mitsuba dictionary of an environment map; `how` describes its sampler."""
    import mitsuba as mi

    blocks = {"blocks": BLOCKS} if how["type"] == "kdtree_envmap" else {}
    return how | blocks | {"bitmap": mi.Bitmap(rgb.astype(np.float32))}


def render_ball(bsdf, lamp, integrator, spp):
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
    return np.array(mi.render(scene, spp=spp, seed=spp), float)


def claim_bias(maps):
    """Claim that samples by the fitted law have the map's integral as their mean."""
    z = {}
    for name, rgb in maps.items():
        drawn = estimate_integral(rgb, SAMPLERS["blocks by law"])
        exact = estimate_integral(rgb, SAMPLERS["cumulative sums"])
        z[name] = (drawn[0] - exact[0]) / np.hypot(drawn[1], exact[1])
    worst = max(z.values(), key=abs)
    return Claim(
        "Samples by the fitted law are unbiased.",
        "6.3",
        "by construction",
        f"z-score of the map's integral between {min(z.values()):+.1f} and {max(z.values()):+.1f}",
        to_verdict(abs(worst) < 3),
        f"{DRAWS:,} samples of each map, against as many by cumulative sums.",
    )


def estimate_integral(rgb, how):
    """Return the integral of a map's luminance by samples, and its standard error."""
    import drjit as dr
    import mitsuba as mi

    lamp = mi.load_dict(make_emitter(rgb, how), parallel=False)
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(1, DRAWS)
    _, weight = lamp.sample_direction(dr.zeros(mi.SurfaceInteraction3f), sampler.next_2d())
    values = np.array(mi.luminance(weight), float)
    return values.mean(), values.std() / np.sqrt(DRAWS)


def claim_time(maps):
    """Claim that blocks and law take no longer to prepare than cumulative sums."""
    power = [cell_power(luminance(rgb)) for rgb in maps.values()]
    blocks = sum(measure_least_seconds(_prepare_blocks, p) for p in power)
    sums = sum(measure_least_seconds(_prepare_sums, p) for p in power)
    return Claim(
        "To prepare the blocks takes no longer than to prepare cumulative sums.",
        "9.1",
        "963 ms and 973 ms",
        f"{blocks / sums:.0f} times as long, {1e3 * blocks / len(power):.0f} ms and "
        f"{1e3 * sums / len(power):.1f} ms in the mean",
        to_verdict(blocks <= 1.1 * sums),
        f"NumPy's cumulative sums over {power[0].shape[1]} × {power[0].shape[0]} cells. Both times "
        "of the thesis are of PBRT, and may hold what they share, such as reading the map.",
    )


def _prepare_blocks(power):
    boxes = tree.build_tree(power, BLOCKS, "sse").blocks
    shares = np.sort(tree.block_sums(power, boxes))[::-1]
    Hyperbolic.fit_to_shares(shares / shares.sum())


def _prepare_sums(power):
    rows = power.cumsum(axis=1)
    rows[:, -1].cumsum()


def claim_quality(differences, name):
    """Claim that pictures by samples of blocks are as good as by cumulative sums."""
    found = differences[name]
    return Claim(
        f"Pictures from {name} are as good as from cumulative sums.",
        "Figure 9.1",
        "equal quality",
        f"{np.mean(found):+.1f} dB in the mean, {min(found):+.1f} to {max(found):+.1f}",
        to_verdict(np.mean(found) > -CLOSE),
        f"At equal samples; confirmed where at most {CLOSE:g} dB are lost in the mean. The "
        "thesis's PSNRs are lost.",
    )
