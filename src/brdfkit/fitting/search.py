"""The search for the shape parameters from one start: sequential quadratic programming."""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Outcome:
    """Where a search ended: coordinates `u`, E² there, how often E² was computed, and why the
    search stopped."""

    u: np.ndarray
    squared_error: float
    evaluations: int
    message: str


def squared_error_at(problem, space, u):
    """E² at the coordinates `u`, with the best weights."""
    values = space.values(u) | space.fixed
    return problem.squared_error(values, problem.solve(values))


def slsqp(problem, space, u):
    """The `Outcome` of Kraft's SQP (SciPy's SLSQP) from the start `u`, with exact derivatives."""
    from scipy.optimize import minimize

    if not space.names:
        return Outcome(
            u, squared_error_at(problem, space, u), 1, "nothing to search: weights alone"
        )
    best = Outcome(u, np.inf, 0, "")
    evaluations = 0

    def objective(u):
        nonlocal best, evaluations
        u = np.clip(u, 0, 1)
        evaluations += 1
        searched = space.values(u)
        weights = problem.solve(searched | space.fixed)
        error, gradient = problem.squared_error_and_gradient(searched, space.fixed, weights)
        if error < best.squared_error:
            best = replace(best, u=u.copy(), squared_error=error)
        return error, gradient * space.slopes(u)

    result = minimize(
        objective,
        u,
        jac=True,
        method="SLSQP",
        bounds=[(0, 1)] * len(u),
        options={"ftol": 1e-15, "maxiter": 200},
    )
    return replace(best, evaluations=evaluations, message=_explain_stop(result))


def _explain_stop(result):
    explanations = {
        0: "converged",
        8: "converged to the precision of the loss",  # no descent left along the direction
        9: f"stopped after {result.nit} iterations",
    }
    return explanations.get(result.status, f"stopped: {result.message}")
