"""The prior, the posterior and `complete`, against dense algebra, simulations and real data."""

import dataclasses
import json
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.completion.model_materials import draw_material
from brdfkit.materials.completion.noise import DEFAULT_NOISE, choose_noise
from brdfkit.materials.completion.observations import Lookup, observe, turn
from brdfkit.materials.completion.planning import choose_directions
from brdfkit.materials.completion.posterior import DEGREES_OF_FREEDOM, solve
from brdfkit.materials.completion.prior import Prior, find_components, leave
from brdfkit.materials.completion.prior_cells import (
    CELLS,
    compute_cosine,
    from_logarithm,
    get_cells,
    to_logarithm,
)
from brdfkit.materials.completion.prior_choice import get_default_prior
from brdfkit.materials.completion.prior_file import read_prior, write_prior
from brdfkit.materials.completion.prior_making import draw_row
from brdfkit.materials.measured.albedos import compute_directional_albedo
from brdfkit.model.samples import Table

REACHED = np.radians(75)


@pytest.fixture(scope="module")
def prior():
    return get_default_prior()


@pytest.fixture(scope="module")
def small(prior):
    """The default prior with six components: fast to draw from."""
    return dataclasses.replace(prior, components=prior.components[:, :6])


@pytest.fixture(scope="module")
def reached():
    """Cells that a goniometer reaches, light and detector at least 5° apart."""
    cells = get_cells()
    apart = np.sum(cells.wi * cells.wo, axis=1) < np.cos(np.radians(5))
    return np.flatnonzero((cells.theta_i < REACHED) & (cells.theta_o < REACHED) & apart)


@pytest.fixture(scope="module")
def twenty(prior, reached):
    """The 20 cells that tell most, of 6,000."""
    cells = get_cells()
    rows = np.random.default_rng(0).permutation(reached)[:6000]
    return rows[choose_directions(prior, cells.wi[rows], cells.wo[rows], 20)[0]]


def random_pairs(rng, count, largest=75.0):
    """Random pairs of directions (count, 3)."""
    theta = np.radians(rng.uniform(0, largest, (2, count)))
    phi = rng.uniform(0, 2 * np.pi, (2, count))
    return from_angles(theta[0], phi[0]), from_angles(theta[1], phi[1])


def measured_at(wi, wo, values, **details):
    """A measured material of three channels, or one, with the values (n, channels)."""
    channels = ("R", "G", "B") if values.shape[1] == 3 else ("Y",)
    return bk.Measured.from_samples(wi, wo, values, channels=channels, name="paint", **details)


def test_posterior_is_that_of_dense_gaussian_conditioning(small):
    rng = np.random.default_rng(3)
    wi, wo = random_pairs(rng, 15)
    observed = observe(wi, wo, np.exp(rng.normal(-1, 1, (15, 2))), 0.05)
    posterior = solve(small, observed)
    lookup = Lookup.at(wi, wo)
    q, mean, left = map(lookup.interpolate, (small.components, small.mean, small.new_remainder))
    some = rng.choice(CELLS, 200, replace=False)
    across = small.components[some] @ q.T
    misfit = 0.0
    for k in range(2):
        covariance = q @ q.T + np.diag(left + observed.variance[:, k])
        residual = observed.logarithm[:, k] - mean
        expected = small.mean[some] + across @ np.linalg.solve(covariance, residual)
        np.testing.assert_allclose(posterior.logarithm[k][some], expected, rtol=0, atol=1e-8)
        prior_variance = np.sum(small.components[some] ** 2, axis=1) + small.new_remainder[some]
        explained = np.sum(across * np.linalg.solve(covariance, across.T).T, axis=1)
        deviation = np.sqrt(prior_variance - explained) * max(posterior.scale, 1)
        np.testing.assert_allclose(posterior.deviation[k][some], deviation, rtol=1e-8)
        misfit += residual @ np.linalg.solve(covariance, residual)
    freedom = DEGREES_OF_FREEDOM + 2 * 15
    assert posterior.scale**2 == pytest.approx((DEGREES_OF_FREEDOM + misfit) / freedom, rel=1e-8)


def test_intervals_cover_materials_of_the_prior(small, twenty):
    rng, cells, count = np.random.default_rng(5), get_cells(), 150
    hits = 0
    for _ in range(count):
        y = small.mean + small.components @ rng.normal(size=small.rank)
        y = y + np.sqrt(small.new_remainder) * rng.normal(size=CELLS)
        values = from_logarithm(y[twenty], cells.cosine[twenty]) * (1 + 0.05 * rng.normal(size=20))
        posterior = solve(small, observe(cells.wi[twenty], cells.wo[twenty], values[:, None], 0.05))
        cell = rng.choice(np.flatnonzero(cells.own))
        half = stats.t.ppf(0.975, posterior.freedom) * posterior.deviation[0, cell]
        hits += abs(posterior.logarithm[0, cell] - y[cell]) < half
    # s is at least 1, so the intervals are a little wide
    assert stats.binom.ppf(0.001, count, 0.95) <= hits <= count - 1


def test_completions_are_reciprocal_and_reflect_at_most_all_light(twenty):
    cells = get_cells()
    wi, wo = cells.wi[twenty], cells.wo[twenty]
    silver = bk.models()["ggx"](diffuse_reflectance=0.7, alpha_u=0.4, f0=0.98)
    values = np.repeat(silver.eval(wi, wo)[:, :1], 3, axis=1) * [1.2, 1.0, 0.5]
    completed = bk.complete(measured_at(wi, wo, values))
    a, b = random_pairs(np.random.default_rng(1), 500, 89.0)
    np.testing.assert_allclose(completed.eval(a, b), completed.eval(b, a), rtol=1e-9)
    # A quadrature by midpoints, beside the one that the guard uses
    theta = (np.arange(180) + 0.5) * np.pi / 360
    phi = (np.arange(180) + 0.5) * np.pi / 180
    grid = [x.ravel() for x in np.meshgrid(theta, phi, indexing="ij")]
    out = from_angles(*grid)
    weights = 2 * np.cos(grid[0]) * np.sin(grid[0]) * (np.pi / 360) * (np.pi / 180)
    for angle in (0.0, 27.0, 35.0, 52.0, 55.0, 71.0, 81.0, 87.0, 89.0):
        light = np.broadcast_to(from_angles(np.radians(angle), 0.0), out.shape)
        albedo = weights @ completed.eval(light, out)
        assert albedo.max() <= 1, angle


def test_noise_alone_reflects_at_most_all_light():
    """The completed table is wild, so that a coarse quadrature misses much of its light."""
    rng = np.random.default_rng(6)
    theta, phi = np.radians(rng.uniform(0, 60, (2, 300))), rng.uniform(0, 2 * np.pi, (2, 300))
    wi, wo = from_angles(theta[0], phi[0]), from_angles(theta[1], phi[1])
    completed = bk.complete(measured_at(wi, wo, rng.normal(0, 0.1, (300, 1))), noise=1e-9)
    light = from_angles(np.radians(84.5), 0.0)
    assert compute_directional_albedo(completed, light, finer=5).max() <= 1


def test_variance_by_wrong_directions_is_that_of_a_simulation(prior):
    rng = np.random.default_rng(2)
    wi, wo = random_pairs(rng, 40, 60.0)
    wo[:20] = wi[:20] * [-1, -1, 1]  # in the highlight, and 3° from it
    wo[10:20] = turn(wo[10:20], np.radians(3), np.zeros(10))
    y = draw_smooth(prior)
    angle = np.radians(0.5)
    observed = observe(wi, wo, np.ones((40, 1)), 0.05, angle)
    stated = Lookup.at(wi, wo).interpolate(y)
    shifts = []
    for _ in range(300):
        a, b = (turn(w, angle, rng.uniform(0, 2 * np.pi, 40)) for w in (wi, wo))
        lookup = Lookup.at(a, b)
        values = from_logarithm(lookup.interpolate(y), lookup.cosine)
        shifts.append(to_logarithm(values, compute_cosine(wi, wo)) - stated)
    simulated = np.mean(np.square(shifts), axis=0)
    ratio = observed.compute_turned_variance(y).sum() / simulated.sum()
    assert 0.6 < ratio < 1.6


def test_aperture_averages_over_the_cone(prior):
    rng = np.random.default_rng(4)
    wi = from_angles(np.radians([20.0, 40.0, 60.0, 30.0]), np.zeros(4))
    wo = from_angles(np.radians([20.0, 40.0, 60.0, 40.0]), np.full(4, np.pi))
    y, aperture = draw_smooth(prior), np.radians(2)
    predicted, slopes = observe(wi, wo, np.ones((4, 1)), 0.05, 0.0, aperture).predict(y)
    values = []
    for _ in range(2000):
        # Evenly over the disc
        moved = turn(wo, aperture * np.sqrt(rng.random()), np.full(4, rng.uniform(0, 2 * np.pi)))
        lookup = Lookup.at(wi, moved)
        values.append(from_logarithm(lookup.interpolate(y), lookup.cosine))
    simulated = to_logarithm(np.mean(values, axis=0), compute_cosine(wi, wo))
    np.testing.assert_allclose(predicted, simulated, atol=0.05)
    np.testing.assert_allclose(np.sum(slopes, axis=0), 1, atol=0.05)


def draw_smooth(prior):
    """The logarithm of a glossy paint with a highlight about 4° wide."""
    cells = get_cells()
    paint = bk.models()["ggx"](diffuse_reflectance=0.1, alpha_u=0.1)
    return to_logarithm(paint.eval(cells.wi, cells.wo)[:, 0], cells.cosine)


def test_wrong_directions_count_less_where_told(prior, twenty):
    cells, rng = get_cells(), np.random.default_rng(6)
    wi, wo = cells.wi[twenty], cells.wo[twenty]
    mirror = bk.models()["ggx"](diffuse_reflectance=0.02, alpha_u=0.015, f0=0.8)
    truth = to_logarithm(mirror.eval(cells.wi, cells.wo)[:, 0], cells.cosine)
    angle, some = np.radians(0.5), np.flatnonzero(cells.own)[::7]
    covered, errors = np.zeros((8, 2)), np.zeros((8, 2))
    for k in range(8):
        wrong = [turn(w, angle, rng.uniform(0, 2 * np.pi, 20)) for w in (wi, wo)]
        values = mirror.eval(*wrong)[:, :1]
        for j, told in enumerate((0.0, angle)):
            posterior = solve(prior, observe(wi, wo, values, 0.05, told))
            misses = np.abs(posterior.logarithm[0] - truth)[some]
            half = stats.t.ppf(0.975, posterior.freedom) * posterior.deviation[0, some]
            covered[k, j] = np.mean(misses < half)
            errors[k, j] = np.sqrt(np.mean(misses**2))
    assert covered.mean(axis=0)[1] > 0.93, covered
    assert errors.mean(axis=0)[1] < 0.9 * errors.mean(axis=0)[0], errors


def test_chosen_directions_are_better_than_random_ones(prior, reached, twenty):
    cells, rng = get_cells(), np.random.default_rng(8)
    targets = np.flatnonzero(cells.own)[::11]
    wins = 0
    for number in range(5):
        y = to_logarithm(draw_material(np.random.default_rng([99, number])), cells.cosine)
        choices = [twenty, *(rng.choice(reached, 20, replace=False) for _ in range(5))]
        errors = []
        for rows in choices:
            values = from_logarithm(y[rows], cells.cosine[rows])[:, None]
            posterior = solve(prior, observe(cells.wi[rows], cells.wo[rows], values, 0.05))
            errors.append(np.mean((posterior.logarithm[0] - y)[targets] ** 2))
        wins += errors[0] < np.median(errors[1:])
    assert wins == 5


def test_the_shipped_prior_is_that_of_its_recipe(prior):
    rows = np.array([draw_row(number) for number in range(0, 2400, 30)])
    assert prior.materials == 2400
    assert prior.rank == 40
    left = leave(rows, prior.mean, prior.components)
    np.testing.assert_allclose(np.sqrt(np.mean(left**2)), 0.022, atol=0.006)
    squares = np.sum(prior.components**2, axis=0)
    weights = (rows - prior.mean) @ prior.components / squares
    # Standard normal weights: 80 rows × 40 components, with heavy tails
    assert abs(np.mean(weights)) < 4 / np.sqrt(weights.size)
    assert np.mean(weights**2) == pytest.approx(1, abs=0.25)


def test_components_of_a_mixture_have_the_covariance_of_both():
    rng = np.random.default_rng(0)
    rows, other = rng.normal(1, 1, (9, 30)), rng.normal(0, 2, (11, 30))
    base = Prior("b", *find_components(other, 40), np.zeros(30), np.zeros(30), 11)
    mean, components = find_components(rows, 40, base)
    share = 0.3
    centres = [x.mean(axis=0) for x in (rows, other)]
    expected = (1 - share) * np.cov(rows.T) + share * np.cov(other.T)
    between = centres[1] - centres[0]
    expected += share * (1 - share) * np.outer(between, between)
    np.testing.assert_allclose(components @ components.T, expected, atol=1e-10)
    np.testing.assert_allclose(mean, (1 - share) * centres[0] + share * centres[1])


def test_a_prior_survives_its_file(tmp_path, small):
    known = dataclasses.replace(small, sources=("a.binary sha256 12",), terms=("research only",))
    write_prior(known, tmp_path / "a.npz")
    write_prior(known, tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()
    again = read_prior(tmp_path / "a.npz")
    assert (again.sources, again.terms) == (known.sources, known.terms)
    np.testing.assert_allclose(again.components, known.components, rtol=1e-3, atol=1e-5)
    assert again.notes()["prior terms"] == "research only"


def test_bad_input_is_said_in_a_sentence(tmp_path, prior, twenty):
    cells = get_cells()
    wi, wo = cells.wi[twenty], cells.wo[twenty]
    values = np.full((20, 1), 0.2)
    infrared = dataclasses.replace(prior, wavelengths=(900.0, 1700.0), name="infrared")
    one = {field.name: getattr(prior, field.name) for field in dataclasses.fields(prior)}
    write_prior(SimpleNamespace(**one | {"materials": 1}), tmp_path / "one.npz")
    whole = tmp_path / "whole.npz"
    write_prior(dataclasses.replace(prior, components=prior.components[:, :1]), whole)
    (tmp_path / "damaged.npz").write_bytes(whole.read_bytes()[:50_000])
    np.savez(tmp_path / "other.npz", about=np.frombuffer(json.dumps([1]).encode(), np.uint8))
    anisotropic = bk.Measured.from_samples(
        wi, wo, values, channels=("Y",), name="hair", anisotropic=True
    )
    good = measured_at(wi, wo, values)
    packed = bytearray(whole.read_bytes())
    packed[packed.index(b"mean.npy") + 8] = 0xFF  # no block of packed data has this type
    (tmp_path / "packed.npz").write_bytes(packed)
    bk.save(bk.complete(good), tmp_path / "text.csv")
    cases = [
        (measured_at(wi[:3], wo[:3], values[:3]), None, "has 3 values"),
        (measured_at(np.tile(wi[:1], (20, 1)), np.tile(wo[:1], (20, 1)), values), None, "same dir"),
        (measured_at(wi, wo, 0 * values), None, "no value of the channel"),
        (measured_at(wi, wo, -values), None, "no value of the channel"),
        (measured_at(wi, wo, 10 * values), None, "divided by 6.+ in 1/sr, without a cosine"),
        (measured_at(wi, wo, 1e30 * values), None, "a value is 2e.29, which no BRDF has"),
        (tmp_path / "text.csv", None, "completed already, from 20 measured values"),
        (anisotropic, None, "is anisotropic"),
        (good, infrared, "900 to 1700 nm"),
        (good, tmp_path / "damaged.npz", "damaged"),
        (good, tmp_path / "packed.npz", "damaged .*invalid block type"),
        (good, tmp_path / "other.npz", "no prior that brdfkit wrote"),
        (good, tmp_path / "one.npz", "made of one material"),
        (good, tmp_path / "missing.npz", "missing.npz"),
        (good, 3, "should be a Prior"),
    ]
    for material, known, words in cases:
        with pytest.raises(bk.BrdfkitError, match=words) as caught:
            bk.complete(material, prior=known)
        assert str(caught.value).count("\n") == 0


def test_dark_values_are_in_no_other_unit():
    """The albedo of the first table is limited, but not because of the values."""
    theta, phi = np.radians([[7, 50, 40, 54], [27, 53, 29, 32]]), np.array([1, 1, 6, 4])
    wi, wo = from_angles(theta[0], np.zeros(4)), from_angles(theta[1], phi)
    values = np.array([[0.0], [0.15], [0.0], [0.13]])
    assert "dimmed" not in bk.complete(measured_at(wi, wo, values), aperture=15).info
    assert "divided by 2.1" in bk.complete(measured_at(wi, wo, 0 * values + 0.7)).info["dimmed"]


@pytest.mark.parametrize(("dark", "noise"), [(0, 0.1), (8, 0.1), (0, 0.0)])
def test_repeated_directions_tell_the_noise(twenty, dark, noise):
    """Values around 0 tell little of it, and copies nothing."""
    wi, wo = (np.repeat(w[twenty], 5, axis=0) for w in (get_cells().wi, get_cells().wo))
    rng = np.random.default_rng(0)
    values = np.full((100, 1), 0.2) * (1 + noise * rng.normal(size=(100, 1)))
    values[: 5 * dark] = rng.normal(0, 1e-5, (5 * dark, 1))
    found, words = choose_noise(wi, wo, values, None, None)
    assert found == pytest.approx(noise or DEFAULT_NOISE, rel=0.2)
    assert ("scatter" in words) == (noise > 0)


def test_real_paints_and_tensors_are_completed(measured_data):
    """Bars beyond the scatter: a mean error of 14 % on five paints, of 26 % on RGL files."""
    cells = get_cells()
    evaluated = (cells.theta_i < REACHED) & (cells.theta_o < REACHED)
    prior = get_default_prior()
    for pattern, count, bar in (("minidiff_paints/C2[0-9]*.xz", 5, 0.14), ("rgl/*.bsdf", 7, 0.26)):
        files = sorted(measured_data.glob(pattern))[:count]
        if not files:
            pytest.skip(f"{pattern} is missing")
        rows = np.random.default_rng(0).permutation(np.flatnonzero(evaluated))[:3000]
        apart = np.sum(cells.wi[rows] * cells.wo[rows], axis=1) < np.cos(np.radians(5))
        rows = rows[apart]
        chosen = rows[choose_directions(prior, cells.wi[rows], cells.wo[rows], 20)[0]]
        errors, covered = [], []
        for file in files:
            material = bk.load(file)
            observed = material.eval(cells.wi[chosen], cells.wo[chosen])
            truth = material.eval(cells.wi[rows], cells.wo[rows])
            posterior = solve(prior, observe(cells.wi[chosen], cells.wo[chosen], observed, 0.05))
            miss = posterior.logarithm[:, rows] - to_logarithm(truth.T, cells.cosine[rows])
            half = stats.t.ppf(0.975, posterior.freedom) * posterior.deviation[:, rows]
            errors.append(np.sqrt(np.mean(miss**2)))
            covered.append(np.mean(np.abs(miss) < half))
        assert np.mean(errors) < bar, (pattern, errors)
        assert np.mean(covered) > 0.92, (pattern, covered)


def test_kept_values_are_no_surer_than_their_noise():
    wi, wo = Table(np.zeros((20, 8, 8, 1))).directions()
    high = (wi[..., 2] > 0.5) & (wo[..., 2] > 0.5)
    values = np.where(high[..., None], 0.1, np.nan)
    for noise in (0.02, 0.5):
        completed = bk.complete(bk.Measured.from_table(values, channels=("Y",)), noise=noise)
        kept = completed.evidence == 0
        np.testing.assert_array_equal(completed.values[kept], 0.1)
        relative = completed.standard_error[kept] / 0.1
        assert relative.min() >= noise * (1 - 1e-9)
        assert np.median(relative) < max(0.2, 1.01 * noise)
