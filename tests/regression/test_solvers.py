"""Solvers: each ends where the others do, is plain data, and may be a user's own."""

import pickle
import textwrap

import numpy as np
import pytest
from sample_sums import sample_sum
from scipy.optimize import minimize

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.core.errors import BrdfkitError
from brdfkit.regression import solvers
from brdfkit.regression.solvers.settings import SOLVERS, to_plain_data, to_solver

N = 300
# The solvers other than the default, with less effort than usual
QUICK = {
    "slsqp": {"starts": 3},
    "trust_region": {"starts": 3},
    "differential_evolution": {"population": 6, "iterations": 20},
}


@pytest.fixture(scope="module")
def noisy():
    """A material that no model meets exactly: GGX in three colours, with noise of 10 %."""
    wi, wo = draw_direction_pairs(N, seed=0, max_degrees=79)
    truth = bk.models()["ggx"](alpha_u=0.3, specular_reflectance=[0.5, 0.4, 0.3])
    values = truth.eval(wi, wo) * np.random.default_rng(0).lognormal(sigma=0.1, size=(N, 3))
    return bk.Measured.from_samples(wi, wo, values)


@pytest.mark.parametrize(
    ("model", "loss"), [("ward", "log"), ("ggx", "cosine"), ("cook_torrance", "cbrt")]
)
def test_all_solvers_end_alike(noisy, model, loss):
    least = bk.fit(noisy, model, loss=loss, starts=8).loss
    for name, fewer in QUICK.items():
        found = bk.fit(noisy, model, loss=loss, starts=8, solver={"name": name, **fewer})
        assert found.loss == pytest.approx(least, rel=1e-6), name
        assert found.message == "converged", name


@pytest.mark.parametrize("solver", QUICK)
def test_all_solvers_end_alike_on_a_table(solver):
    """Of which they see parts first."""
    least = bk.fit("satin_plastic", "cook_torrance", loss="cosine")
    how = {"name": solver, **QUICK[solver]}
    found = bk.fit("satin_plastic", "cook_torrance", loss="cosine", solver=how)
    assert found.loss == pytest.approx(least.loss, rel=1e-6)
    np.testing.assert_allclose(found.values["alpha"], least.values["alpha"], rtol=1e-4)


def test_slsqp_ends_where_scipy_does_by_itself(noisy):
    """In NumPy, with differences for derivatives, from the parameters that made the data."""
    wi, wo, measured = noisy.samples.wi, noisy.samples.wo, noisy.samples.values
    cosines = (wi[:, 2] * wo[:, 2])[:, None]

    def error(x):
        weights = {"diffuse_reflectance": x[1:4], "specular_reflectance": x[4:7]}
        model = bk.models()["ward_duer"](alpha_u=x[0], **weights)
        logs = [np.log(cosines * f + 1e-3) for f in (model.eval(wi, wo), measured)]
        return np.mean((logs[0] - logs[1]) ** 2)

    start = [0.3, *[0.4] * 3, *[0.2] * 3]
    bounds = [(0.001, 1), *[(0, None)] * 6]
    direct = minimize(error, start, method="SLSQP", bounds=bounds, options={"ftol": 1e-14})
    found = bk.fit(noisy, "ward_duer", loss=sample_sum("log"), solver=bk.solvers.SLSQP(starts=2))
    assert found.loss == pytest.approx(np.sqrt(direct.fun), rel=1e-6)
    assert found.values["alpha_u"] == pytest.approx(direct.x[0], rel=1e-3)


def test_differential_evolution_does_not_depend_on_its_start():
    """Lafortune's lobe lies far from where the single start looks for it."""
    truth = bk.models()["lafortune"](c_x=0.8, c_y=0.8, c_z=0.7, exponent=20)
    wi, wo = draw_direction_pairs(N, seed=1, max_degrees=79)
    data = bk.Measured.from_samples(wi, wo, truth.eval(wi, wo), channels=("Y",))
    how = {"anisotropic": True, "starts": 1}
    assert bk.fit(data, "lafortune", loss="cosine", **how).loss > 0.005
    evolution = bk.solvers.DifferentialEvolution(population=6, iterations=20)
    assert bk.fit(data, "lafortune", loss="cosine", solver=evolution, **how).loss < 1e-8


def test_a_fit_by_any_solver_is_reproducible(noisy):
    for name, fewer in QUICK.items():
        solver = {"name": name, **fewer}
        first, second = (bk.fit(noisy, "ward", solver=solver, starts=4) for _ in range(2))
        assert first == second


@pytest.mark.quick
@pytest.mark.parametrize("name", SOLVERS)
def test_a_solver_is_plain_data(name):
    solver = SOLVERS[name]()
    known = {cls.__name__: cls for cls in SOLVERS.values()}
    assert solver == to_solver(name) == to_solver(to_plain_data(solver))
    assert solver == pickle.loads(pickle.dumps(solver)) == eval(repr(solver), known)
    assert solver != SOLVERS[name](iterations=3)


@pytest.mark.quick
def test_a_saved_fit_knows_its_solver(noisy, tmp_path):
    solver = bk.solvers.SLSQP(starts=2)
    limits = [bk.solvers.AlbedoAtMost(5.0, theta=10), lambda model: 1.0]
    found = bk.fit(noisy, "lambert", solver=solver, constraints=limits)
    bk.save(found, tmp_path / "lambert.json")
    loaded = bk.load(tmp_path / "lambert.json")
    assert loaded == found
    assert to_solver(loaded.settings["solver"]) == solver
    unconstrained = loaded.settings | {"constraints": None}
    assert bk.fit(noisy, "lambert", **unconstrained).loss == pytest.approx(found.loss, rel=1e-9)


def test_the_solver_that_the_documentation_shows_works(noisy):
    """It is not good, but the loss is the one that it reports."""
    code = textwrap.dedent(solvers.__doc__.partition("a solver::\n\n")[2])
    scope = {"np": np, "End": solvers.End}
    exec(code, scope)
    found = bk.fit(noisy, "ward", solver=scope["RandomSearch"]())
    assert found.loss < 1.1 * bk.fit(noisy, "ward").loss
    assert bk.compare(noisy, found).errors["ward"]["cbrt"] == pytest.approx(found.loss, rel=1e-9)
    assert found.message == "stopped after 300 rounds"
    assert found.evaluations > 10_000


@pytest.mark.quick
@pytest.mark.parametrize("end", [None, [0.1], solvers.End(np.zeros(2), 0.1)])
def test_an_end_that_is_none_is_explained(noisy, end):
    class Hasty:
        def minimise(self, objective):
            return end

    with pytest.raises(BrdfkitError, match="it should return an End"):
        bk.fit(noisy, "ward", solver=Hasty())


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"solver": "slsq"}, ["'slsq'", "did you mean slsqp?"]),
        ({"solver": 3}, ["solver = 3", "SLSQP()"]),
        ({"solver": bk.solvers.SLSQP}, ["SLSQP()", "slsqp"]),
        ({"solver": {"name": "slsqp", "steps": 3}}, ["parameter of slsqp", "iterations"]),
        ({"constraints": "energy"}, ["'energy' is no constraint", "AlbedoAtMost"]),
        ({"constraints": [bk.solvers.AlbedoAtMost]}, ["no constraint", "AlbedoAtMost(1.0)"]),
        (
            {"constraints": bk.solvers.WeightsAtMost(), "solver": "trust_region"},
            ["TrustRegion takes no constraints", "SLSQP"],
        ),
        (
            {"constraints": bk.solvers.WeightsAtMost(), "robust": "huber"},
            ["robust", "no constraints"],
        ),
        ({"constraints": lambda model: -1.0}, ["lambert", "<lambda>", "beyond the limit"]),
        ({"constraints": lambda model: "no"}, ["<lambda>", "'no'", "a finite number"]),
        ({"constraints": lambda model: np.nan}, ["<lambda>", "nan"]),
    ],
)
def test_bad_solvers_and_constraints_are_explained(noisy, arguments, words):
    with pytest.raises(BrdfkitError) as error:
        bk.fit(noisy, "lambert", **arguments)
    assert all(word in str(error.value) for word in words), error.value


@pytest.mark.quick
@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: bk.solvers.SLSQP(iterations=0), "SLSQP: iterations = 0"),
        (lambda: bk.solvers.TrustRegion(tolerance=-1), "TrustRegion: tolerance = -1"),
        (lambda: bk.solvers.DifferentialEvolution(population=2.5), "population = 2.5"),
        (lambda: bk.solvers.AlbedoAtMost(0), "limit = 0"),
        (lambda: bk.solvers.AlbedoAtMost(theta=90), "theta = 90"),
        (lambda: bk.solvers.AlbedoAtMost(phi="x"), "phi = 'x'"),
        (lambda: bk.solvers.WeightsAtMost("1"), "limit = '1'"),
    ],
)
def test_bad_numbers_are_explained(make, words):
    with pytest.raises(BrdfkitError, match=words):
        make()


@pytest.mark.quick
def test_a_sweep_takes_no_code():
    with pytest.raises(BrdfkitError, match="<lambda> is your own code"):
        bk.sweep("plaster", "lambert", settings={"constraints": [lambda model: 1.0]})


@pytest.mark.quick
def test_the_error_of_an_end_is_computed_anew(noisy):
    """A solver may say what it likes."""

    class Boaster:
        def minimise(self, objective):
            return solvers.End(objective.starts[0], -1.0, None)

    found = bk.fit(noisy, "ward", solver=Boaster())
    assert found.loss == pytest.approx(bk.compare(noisy, found).errors["ward"]["cbrt"], rel=1e-9)


@pytest.mark.quick
def test_ctrl_c_in_any_solver_keeps_the_best_point(noisy):
    class Stopping:
        def minimise(self, objective):
            objective.error(objective.starts)
            raise KeyboardInterrupt

    with pytest.raises(bk.Interrupted) as stop:
        bk.fit(noisy, "ward", solver=Stopping())
    best = stop.value.best
    assert best.loss == pytest.approx(bk.compare(noisy, best).errors["ward"]["cbrt"], rel=1e-9)
