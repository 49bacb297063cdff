"""The parts of a fit, each against something independent of it."""

import numpy as np
import pytest
from random_models import random_model
from robust_least_squares import sample_weights
from sample_sums import sample_sum

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model import labels
from brdfkit.model.evaluation import compute_lobe_values
from brdfkit.model.samples import Samples
from brdfkit.regression import losses
from brdfkit.regression.problem.folding import fold_problem
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.subset import Shares, draw_subset
from brdfkit.regression.robust.reweighting import WEIGHTS, compute_leverages

MODELS_WITHOUT_SUMS = [name for name in bk.models() if name != "mixture"]


def table(seed=0, shape=(12, 8, 24)):
    """A table of random values: no model meets it."""
    values = np.random.default_rng(seed).uniform(0.1, 1, (*shape, 3))
    return select_samples(bk.Measured.from_table(values), 80.0)


def problem_of(name, samples, loss="cosine"):
    """The `Problem` of a model, with what the directions determine fixed."""
    model = labels.model(name)
    space = Space.for_model(model, {}, model.determine_parameters(samples), True)
    return Problem(model, samples, losses.named.by_sample[loss], space)


def point(problem, seed, points=2):
    """Random coordinates, and weights by which no model is clamped at 0."""
    rng = np.random.default_rng(seed)
    u = rng.uniform(0.2, 0.8, (points, len(problem.space.names)))
    weights = rng.uniform(0.05, 0.5, (points, problem.channels, problem.weight_limits.shape[1]))
    weights[..., 0] += 3 * (problem.weight_limits[0, 0] < 0)
    return u, weights


@pytest.mark.parametrize("loss", losses.named.by_sample)
@pytest.mark.parametrize("name", MODELS_WITHOUT_SUMS)
def test_squared_error_and_gradient(name, loss):
    """E² against NumPy, its gradient against central differences: at several points at once."""
    rng = np.random.default_rng(1)
    wi, wo = draw_direction_pairs(60, seed=2, max_degrees=79)
    data = bk.Measured.from_samples(wi, wo, rng.uniform(0.1, 1, (60, 3)))
    problem = problem_of(name, select_samples(data, 90.0), loss)
    u, weights = point(problem, 3)
    here = problem.expand_at_weights(u, weights)

    def error(u, weights):
        return problem.expand_at_weights(u, weights).error

    for k in range(len(u)):
        values = problem.space.to_named_values(u[k])
        linear = dict(zip(problem.model.weights(), map(tuple, weights[k].T), strict=True))
        model = problem.model(**values, **linear)
        expected = bk.compare(data, model, max_angle=90.0).errors[model.name][loss]
        assert np.sqrt(here.error[k]) == pytest.approx(expected, rel=1e-10)
    h, shapes = 1e-6, u.shape[1]
    for j in range(here.gradient.shape[1]):
        step = np.zeros((1, here.gradient.shape[1]))
        step[0, j] = h
        by_u, by_weights = step[:, :shapes], step[:, shapes:].reshape(1, *weights.shape[1:])
        ends = [error(u + s * by_u, weights + s * by_weights) for s in (-1, 1)]
        numeric = (ends[1] - ends[0]) / (4 * h)  # the gradient is half that of E²
        np.testing.assert_allclose(here.gradient[:, j], numeric, rtol=1e-5, atol=1e-8)


@pytest.mark.quick
@pytest.mark.parametrize("name", MODELS_WITHOUT_SUMS)
def test_a_folded_objective_is_the_full_one(name):
    """To 1e-12: E², gradient and Hessian; which models fold follows from their lobes."""
    problem = problem_of(name, table())
    folded = fold_problem(problem)
    lobes = random_model(problem.model, 1).lobes()
    free = any(lobe.factors is None for lobe in lobes if not lobe.diffuse)
    assert folded is None or not free
    if folded is None:
        return
    u, weights = point(problem, 4)
    full, quick = (p.expand_loss(u, weights) for p in (problem, folded))
    np.testing.assert_allclose(quick.weights, full.weights, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(quick.error, full.error, rtol=1e-12)
    size = np.abs(full.hessian).max()
    np.testing.assert_allclose(quick.gradient, full.gradient, atol=1e-11 * size)
    np.testing.assert_allclose(quick.hessian, full.hessian, atol=1e-11 * size)


@pytest.mark.quick
def test_what_folds():
    """Facets whose shadowing holds the width do not."""
    samples = table()
    assert fold_problem(problem_of("ward", samples))
    assert fold_problem(problem_of("koenderink", samples))
    assert not fold_problem(problem_of("ggx", samples))
    assert not fold_problem(problem_of("ward", samples, "log"))
    wi, wo = draw_direction_pairs(500, seed=2, max_degrees=79)
    scattered = Samples.from_arrays(wi, wo, np.ones((500, 1)), None, "Y", "scattered")
    assert not fold_problem(problem_of("ward", scattered))


@pytest.mark.quick
def test_a_part_stands_for_the_whole():
    """Its weights make up for what is left out: sums over it are those over all, on average."""
    samples = table(shape=(24, 12, 24))
    rng = np.random.default_rng(0)
    shares = Shares.from_influence(samples, samples.values.sum(axis=1) ** 4)
    sums = []
    for _ in range(50):
        part, rows = draw_subset(samples, shares, 300, rng)
        np.testing.assert_array_equal(part.values, samples.values[rows])
        sums.append(part.weight @ part.values)
    expected = samples.weight @ samples.values
    off = (np.mean(sums, axis=0) - expected) / (np.std(sums, axis=0) / np.sqrt(50))
    assert np.abs(off).max() < 4


@pytest.mark.parametrize("name", ["bisquare", "huber", "cauchy"])
@pytest.mark.parametrize("model", ["koenderink", "pca_polynomial:degree=4"])
def test_settled_weights_give_the_solution_back(model, name):
    """What "settled" means: fitted values to 1e-6 of their spread."""
    wi, wo = draw_direction_pairs(600, seed=8, max_degrees=79)
    rng = np.random.default_rng(9)
    values = 0.3 + 0.1 * wi[:, 2:] * wo[:, 2:] + 0.01 * rng.standard_t(2, (600, 1))
    data = bk.Measured.from_samples(wi, wo, values, channels=("Y",))
    fit = bk.fit(data, model, loss=sample_sum("plain"), robust=name)
    assert fit.message.startswith("settled")
    columns, _ = compute_lobe_values(fit.model, wi, wo)
    solution = np.ravel([fit.values[n] for n in fit.model.weights()])
    fitted = columns @ solution
    residuals = (values[:, 0] - fitted) / np.sqrt(1 - compute_leverages(columns.T))
    weights = sample_weights(residuals, name, columns.shape[1], 1e-12)
    root = np.sqrt(weights)[:, None]
    again = columns @ np.linalg.lstsq(columns * root, values * root, rcond=None)[0][:, 0]
    assert np.abs(again - fitted).max() < 1e-6 * np.std(values)
    assert name in WEIGHTS
