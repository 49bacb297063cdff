"""Samplers of maps: each follows its density, in all their forms and with every look-up."""

from types import SimpleNamespace

import numpy as np
import pytest
from brdfkit.plugins.emitters.sampled_envmap import Alias, Cdf, Mip

import brdfkit as bk
from brdfkit.checks import directions
from brdfkit.checks import emitters as checks
from brdfkit.checks.plugin_subject import make_example
from brdfkit.lighting.sampling.alias_table import make_alias_table
from brdfkit.lighting.sampling.blocks import DISTRIBUTIONS, LOOKUPS, Blocks
from brdfkit.lighting.sampling.power_map import subtract_mean_brightness

BY_NAME = {
    "cdf": Cdf,
    "mip": Mip,
    "alias": Alias,
} | {
    f"{law}, {lookup}": lambda map_, law=law, lookup=lookup: Blocks(
        map_, 200, "relative", law, lookup
    )
    for law in DISTRIBUTIONS
    for lookup in LOOKUPS
}


def sky(height=33, width=64):
    """Brightness of an uneven sky with a sun, over black ground."""
    v, u = np.meshgrid(np.linspace(0, 1, height), np.linspace(0, 1, width), indexing="ij")
    noise = np.random.default_rng(0).gamma(3, 0.3, (height, width))
    sun = 500 * np.exp(-((u - 0.3) ** 2 + (v - 0.2) ** 2) / 1e-3)
    return np.where(v < 0.7, noise + sun, 0)


@pytest.mark.parametrize("name", BY_NAME)
def test_a_sampler_follows_its_density(name, llvm_variant):
    """Counts of samples in squares against the integral of the density; of 3,000 none may be off
    by 5 standard deviations. And the density of a sample is that of its place."""
    mi = llvm_variant
    sampler = BY_NAME[name](sky())
    u = np.random.default_rng(1).random((2, 400_000), np.float32)
    x, y, stated = sampler.sample(mi.Point2f(mi.Float(u[0]), mi.Float(u[1])), True)
    there = np.array(sampler.density(x, y, True))
    x, y, stated = (np.array(a) for a in (x, y, stated))
    off = np.abs(there - stated) > 2e-3 * stated
    assert off.mean() < 1e-3  # on the edge of two cells rounding decides

    counts = np.histogram2d(y, x, (32, 64), ((0, 32), (0, 64)))[0]
    n = 8  # points along a cell
    v, w = np.meshgrid((np.arange(32 * n) + 0.5) / n, (np.arange(64 * n) + 0.5) / n, indexing="ij")
    at = (mi.Float(a.ravel().astype(np.float32)) for a in (w, v))
    density = np.array(sampler.density(*at, True)).reshape(32, n, 64, n).mean(axis=(1, 3))
    assert density.mean() == pytest.approx(1, abs=2e-3)
    expected = density * (u.shape[1] / density.size)
    assert counts[expected == 0].sum() == 0
    lit = expected > 20
    assert lit.sum() > 100
    assert np.abs((counts - expected)[lit] / np.sqrt(expected[lit])).max() < 5


@pytest.mark.parametrize("lookup", ["tree", "grid"])
def test_every_lookup_finds_the_same_density(lookup, llvm_variant):
    mi = llvm_variant
    u = np.random.default_rng(2).random((2, 50_000), np.float32)
    x, y = mi.Float(u[0] * 64), mi.Float(u[1] * 32)
    found, expected = (
        np.array(BY_NAME[f"exact, {name}"](sky()).density(x, y, True))
        for name in (lookup, "texture")
    )
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("name", BY_NAME)
def test_a_scalar_variant_draws_the_same(name, llvm_variant):
    mi = llvm_variant
    points = np.random.default_rng(3).random((5, 2)).astype(np.float32)
    sampler = BY_NAME[name](sky())
    expected = np.array([np.array(a) for a in sampler.sample(mi.Point2f(points.T), True)]).T
    mi.set_variant("scalar_rgb")
    try:
        sampler = BY_NAME[name](sky())
        found = np.array([sampler.sample(mi.Point2f(*p.tolist()), True) for p in points])
        densities = [sampler.density(*map(float, row[:2]), True) for row in found]
    finally:
        mi.set_variant("llvm_ad_rgb")
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-3)
    np.testing.assert_allclose(densities, found[:, 2], rtol=1e-3)


@pytest.mark.quick
@pytest.mark.parametrize("seed", range(5))
def test_an_alias_table_holds_its_weights(seed):
    random = np.random.default_rng(seed)
    weights = random.gamma(0.2, size=random.integers(1, 60)) * (random.random() > 0.1)
    thresholds, aliases = make_alias_table(weights)
    n = len(weights)
    found = (thresholds + np.bincount(aliases, 1 - thresholds, n)) / n
    expected = weights / weights.sum() if weights.sum() > 0 else np.full(n, 1 / n)
    np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.quick
def test_a_compensated_map_is_what_is_above_its_mean():
    even = np.full((8, 16), 0.3)
    np.testing.assert_array_equal(subtract_mean_brightness(even), even)
    above = subtract_mean_brightness(sky())
    assert (above == 0).mean() > 0.9
    np.testing.assert_allclose((sky() - above)[above > 0], (sky() - above).max())


FORMS = [
    ("kdtree_envmap", {"distribution": "alias"}),
    ("kdtree_envmap", {"distribution": "hyperbolic"}),
    ("kdtree_envmap", {"distribution": "steps", "lookup": "tree"}),
    ("sampled_envmap", {"sampler": "mip"}),
    ("sampled_envmap", {"sampler": "alias"}),
]


@pytest.mark.parametrize(("name", "settings"), FORMS)
def test_the_forms_of_an_emitter_pass_its_checks(name, settings, llvm_variant):
    """χ² (32 points along a cell) at a level of 1 % in all, mean light, weights, ∫ density."""
    entries = make_example(name, **settings)
    emitter = SimpleNamespace(plugin=llvm_variant.load_dict(entries))
    draw, radiance_and_pdf = checks.make_sampler(emitter)
    p = directions.run_chi_squared_test(draw, lambda w: radiance_and_pdf(w)[1], tests=len(FORMS))
    assert p is not None
    report = bk.check(entries, only=["weights", "normalisation", "mean light"])
    assert report, str(report)


def test_memory_is_a_hundredth_of_the_map(llvm_variant):
    """4,096 blocks of 2048 × 1024 pixels; a texture needs one channel of the map besides."""
    pixels = np.kron(sky(32, 64), np.ones((32, 32)))
    pixels *= np.random.default_rng(0).gamma(3, 0.3, pixels.shape)
    hundredth = 0.01 * pixels.size * 3 * 4
    for law, lookup in (("exact", "tree"), ("steps", "tree"), ("steps", "grid")):
        assert Blocks(pixels, 4096, "relative", law, lookup).nbytes <= hundredth
    texture = Blocks(pixels, 4096, "relative", "exact", "texture")
    assert texture.nbytes - texture.lookup.nbytes <= hundredth


def test_walking_keeps_strata(llvm_variant):
    """As Mitsuba's descent of mip levels does, and sorted blocks do not: the variance of the mean
    column of 32 × 32 jittered points, over that of as many independent ones."""
    mi = llvm_variant
    random = np.random.default_rng(4).random((64, 2, 1024))
    corner = np.stack(np.meshgrid(np.arange(32), np.arange(32))).reshape(2, -1)
    left = {}
    for name in ("exact, texture", "mip", "steps, texture"):
        sampler, variances = BY_NAME[name](sky()), []
        for u in ((corner + random) / 32, random):
            u = u.transpose(1, 0, 2).reshape(2, -1).astype(np.float32).clip(0, 1 - 1e-7)
            x = np.array(sampler.sample(mi.Point2f(mi.Float(u[0]), mi.Float(u[1])), True)[0])
            variances.append(x.reshape(64, -1).mean(axis=1).var())
        left[name] = variances[0] / variances[1]
    assert left["exact, texture"] < 3 * left["mip"] < 0.1 < left["steps, texture"]
