"""Constraints of fits: they are met, at the best point that meets them, and said."""

import numpy as np
import pytest
from click.testing import CliRunner
from sample_sums import sample_sum
from scipy.optimize import minimize_scalar, nnls

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.cli import main
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.quadrature import make_ring_rule
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model import labels
from brdfkit.regression import losses
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.solvers.constraints import Constraints

ANGLES = 0, 30, 60, 80


def synthetic(model, noise=0.0, n=300):
    wi, wo = draw_direction_pairs(n, seed=0, max_degrees=79)
    values = model.eval(wi, wo)
    values = values * np.random.default_rng(0).lognormal(sigma=noise, size=values.shape)
    return bk.Measured.from_samples(
        wi, wo, values, channels=("Y", "R", "G", "B")[-values.shape[1] :]
    )


def albedos(model, points=400):
    """The albedos (angles, channels), by other nodes than the constraint's."""
    found = []
    for theta in ANGLES:
        wi = from_angles(np.radians(theta), 0.0)
        wo, rule = make_ring_rule(wi, points)
        found.append(rule @ model.eval(np.broadcast_to(wi, wo.shape), wo))
    return np.array(found)


@pytest.mark.quick
def test_lambert_ends_at_the_limit():
    """Its albedo is its reflectance; the best one within the limit is the limit."""
    data = synthetic(bk.models()["lambert"](diffuse_reflectance=[0.8, 0.6, 0.3]), noise=0.1)
    for limit in (bk.solvers.AlbedoAtMost(0.5), bk.solvers.WeightsAtMost(0.5)):
        found, free = bk.fit(data, "lambert", constraints=limit), bk.fit(data, "lambert")
        own = found.values["diffuse_reflectance"]
        np.testing.assert_allclose(own[:2], 0.5, rtol=0, atol=1e-6)
        assert own[2] == pytest.approx(free.values["diffuse_reflectance"][2], rel=1e-6)
        assert "is at its limit" in found.notes[0]
        assert f"without the constraints E would be {free.loss:.6g}" in found.message


@pytest.mark.parametrize("loss", ["log", "plain"])
def test_the_limit_is_met_from_a_perfect_fit(loss):
    """Where E is 0 without the constraint."""
    data = synthetic(bk.models()["ward"](diffuse_reflectance=0.8))
    found = bk.fit(data, "ward", loss=loss, starts=4, constraints=bk.solvers.AlbedoAtMost(0.6))
    assert albedos(found.model, 128).max() == pytest.approx(0.6, abs=1e-6)
    # A little less light is not better: the limit holds it
    less = found.model.changed(diffuse_reflectance=found.model.diffuse_reflectance[0] - 1e-3)
    assert bk.compare(data, less).errors["ward"][loss] > found.loss


@pytest.mark.quick
def test_what_meets_the_constraints_is_returned_as_it_is():
    data = synthetic(bk.models()["ggx"](), noise=0.1)
    found, free = (
        bk.fit(data, "ggx", constraints=[bk.solvers.AlbedoAtMost(1.0)]),
        bk.fit(data, "ggx"),
    )
    assert found.values == free.values
    assert found.notes == free.notes


@pytest.mark.quick
def test_one_parameter_by_brute_force():
    """The width is fixed, and at the limit each diffuse weight leaves one specular weight."""
    data = synthetic(bk.models()["ward"](alpha_u=0.3), noise=0.1)
    wi, wo, measured = data.samples.wi, data.samples.wo, data.samples.values
    cosines = (wi[:, 2] * wo[:, 2])[:, None]
    lobe = bk.models()["ward"](diffuse_reflectance=0, specular_reflectance=1, alpha_u=0.3)
    gloss, most = lobe.eval(wi, wo), albedos(lobe, 96).max()

    def error(diffuse):
        model = diffuse / np.pi + (0.3 - diffuse) / most * gloss
        return np.mean((np.log(cosines * model + 1e-3) - np.log(cosines * measured + 1e-3)) ** 2)

    best = minimize_scalar(error, bounds=(0, 0.3), method="bounded", options={"xatol": 1e-9})
    loss = sample_sum("log")
    found = bk.fit(
        data, "ward", loss=loss, fixed={"alpha_u": 0.3}, constraints=bk.solvers.AlbedoAtMost(0.3)
    )
    assert found.loss == pytest.approx(np.sqrt(best.fun), rel=1e-9)
    assert found.values["diffuse_reflectance"][0] == pytest.approx(best.x, rel=1e-4)


def setup(label, data, loss, constraints):
    model = labels.model(label)
    problem = Problem(
        model, select_samples(data, 80.0), losses.named[loss], Space.for_model(model, {}, {}, False)
    )
    return problem, Constraints(constraints, problem)


@pytest.mark.parametrize(("model", "loss"), [("ward", "log"), ("cook_torrance", "cosine")])
def test_the_end_is_feasible_and_stationary(model, loss):
    """Kuhn and Tucker: the gradient of E² is a sum of those of active constraints and bounds, with
    factors ≥ 0; by differences of E² alone."""
    data = synthetic(bk.models()["ggx"](diffuse_reflectance=[0.5, 0.4, 0.3]), noise=0.1)
    limit = 0.9 * albedos(bk.fit(data, model, loss=loss, starts=8).model, 64).max()
    limits = [bk.solvers.AlbedoAtMost(limit)]
    found = bk.fit(data, model, loss=loss, starts=8, constraints=limits)
    problem, constraints = setup(model, data, loss, limits)
    u = problem.space.to_coordinates(found.values)
    weights = np.array([found.values[name] for name in problem.model.weights()]).T
    z = np.concatenate([u, weights.ravel()])
    assert constraints.values(z).min() >= -1e-8

    def error(z):
        return problem.compute_sums(
            z[None, : len(u)], z[len(u) :].reshape(1, *weights.shape)
        ).error[0]

    h = 1e-5 * np.eye(len(z))
    gradient = np.array([error(z + step) - error(z - step) for step in h]) / 2e-5
    active = constraints.values(z) < 1e-6
    at_low, at_high = z <= 1e-9, np.concatenate([u >= 1 - 1e-9, weights.ravel() < -1])
    normals = [*constraints.slopes(z)[active], *np.eye(len(z))[at_low], *-np.eye(len(z))[at_high]]
    _, residual = nnls(np.array(normals).T, gradient)
    assert active.any()
    assert residual < 1e-3 * np.linalg.norm(gradient)


@pytest.mark.parametrize("model", ["ggx", "oren_nayar:form=full", "koenderink:order=2", "eon"])
def test_slopes_are_those_of_the_values(model):
    """Of squared weights and of clamped models, too."""
    data = synthetic(bk.models()["lambert"](diffuse_reflectance=[0.5, 0.4, 0.3]))
    problem, constraints = setup(
        model, data, "log", [bk.solvers.AlbedoAtMost(theta=(20, 70), phi=(0, 40))]
    )
    shapes = len(problem.space.names)
    count = shapes + 3 * problem.weight_limits.shape[1]
    z = np.random.default_rng(0).uniform(0.2, 0.6, count)
    z[shapes:] -= (np.arange(count - shapes) % 3 == 2) * (problem.weight_limits.min() < 0)
    slopes = constraints.slopes(z)
    h = 1e-6 * np.eye(count)
    expected = [(constraints.values(z + s) - constraints.values(z - s)) / 2e-6 for s in h]
    np.testing.assert_allclose(slopes, np.transpose(expected), rtol=0, atol=1e-5)


def test_a_users_function_is_a_constraint():
    """It ends where the same constraint of brdfkit's does."""

    def spare(model):
        return 0.4 - np.add(model.diffuse_reflectance, model.specular_reflectance)

    truth = bk.models()["ward"](diffuse_reflectance=[0.5, 0.4, 0.1], specular_reflectance=0.1)
    data = synthetic(truth, noise=0.1)
    own, ours = (
        bk.fit(data, "ward", constraints=c) for c in (spare, bk.solvers.WeightsAtMost(0.4))
    )
    assert own.loss == pytest.approx(ours.loss, rel=1e-8)
    assert "the constraint spare is at its limit" in own.notes[0]
    assert max(np.add(own.model.diffuse_reflectance, own.model.specular_reflectance)) <= 0.4 + 1e-8


def test_a_fit_that_gains_light_is_kept_from_it():
    """`ward_duer` shows blasted gold with an albedo of 1.8 at 85°; kept to 1, it fits worse."""
    free = bk.fit("blasted_gold", "ward_duer", use_standard_error=False)
    limit = bk.solvers.AlbedoAtMost(1.0, theta=(0, 45, 75, 85))
    found = bk.fit("blasted_gold", "ward_duer", use_standard_error=False, constraints=limit)
    assert max(free.albedo.fit[-1]) > 1.5
    assert max(found.albedo.fit[-1]) == pytest.approx(1, abs=1e-4)
    assert free.loss < found.loss < 4 * free.loss


@pytest.mark.quick
def test_the_command_line_knows_solvers_and_constraints():
    words = ["fit", "plaster", "-m", "lambert", "--loss", "plain", "--albedo-at-most", "0.3"]
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 0
    assert "is at its limit" in done.output
    refused = CliRunner().invoke(main, [*words, "--solver", "trust_region"])
    assert refused.exit_code == 2
    assert "TrustRegion takes no constraints" in refused.output


def test_a_fit_that_gains_light_is_remarked():
    words = ["fit", "blasted_gold", "-m", "ward_duer"]
    free = CliRunner().invoke(main, words)
    kept = CliRunner().invoke(main, [*words, "--albedo-at-most", "1"])
    assert "of the light at 89°, more than arrives" in free.stdout
    assert "converged, but its light is wrong" in free.stdout
    assert "more than arrives" not in kept.stdout
