"""The search for the shape parameters: several starts, then sequential quadratic programming.

Coordinates run from 0 to 1 between the bounds, logarithmically where the parameter says so.
"""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Space:
    """The shape parameters that are searched, with bounds (low, high) each, and the fixed ones."""

    names: tuple[str, ...]
    low: np.ndarray
    high: np.ndarray
    log: np.ndarray
    fixed: dict[str, float]

    def values(self, u):
        """Parameters by name at coordinates `u` in [0, 1]."""
        linear = self.low + u * (self.high - self.low)
        return dict(zip(self.names, np.where(self.log, self._geometric(u), linear), strict=True))

    def coordinates(self, values):
        """Coordinates in [0, 1] of parameters by name."""
        x = np.array([values[name] for name in self.names])
        linear = (x - self.low) / (self.high - self.low)
        with np.errstate(divide="ignore", invalid="ignore"):
            log = np.log(x / self.low) / np.log(self.high / self.low)
        return np.clip(np.where(self.log, log, linear), 0, 1)

    def slopes(self, u):
        """d parameter / d coordinate."""
        with np.errstate(divide="ignore", invalid="ignore"):
            log = self._geometric(u) * np.log(self.high / self.low)
        return np.where(self.log, log, self.high - self.low)

    def _geometric(self, u):
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.low * (self.high / self.low) ** u


@dataclass(frozen=True)
class Outcome:
    """Where a search ended: coordinates, E², evaluations of it, and why it stopped."""

    u: np.ndarray
    error: float
    evaluations: int
    message: str


def start_points(space, default, count, seed):
    """The default and `count - 1` points spread over the bounds, (count, parameters)."""
    if count == 1:
        return default[None, :]
    from scipy.stats import qmc

    spread = qmc.Halton(len(default), rng=seed).random(count - 1)
    return np.vstack([default, spread])


def evaluate(problem, space, u):
    """E² at coordinates `u`."""
    values = space.values(u) | space.fixed
    return problem.error(values, problem.solve(values))


def slsqp(problem, space, u):
    """Kraft's SQP (SciPy's SLSQP) from the start `u`, with exact derivatives."""
    from scipy.optimize import minimize

    if not space.names:
        return Outcome(u, evaluate(problem, space, u), 1, "nothing to search: weights alone")
    best = Outcome(u, np.inf, 0, "")
    evaluations = 0

    def objective(u):
        nonlocal best, evaluations
        u = np.clip(u, 0, 1)
        evaluations += 1
        searched = space.values(u)
        weights = problem.solve(searched | space.fixed)
        error, gradient = problem.error_and_gradient(searched, space.fixed, weights)
        if error < best.error:
            best = replace(best, u=u.copy(), error=error)
        return error, gradient * space.slopes(u)

    result = minimize(
        objective,
        u,
        jac=True,
        method="SLSQP",
        bounds=[(0, 1)] * len(u),
        options={"ftol": 1e-15, "maxiter": 200},
    )
    return replace(best, evaluations=evaluations, message=_why(result))


def _why(result):
    converged = {
        0: "converged",
        8: "converged to the precision of the loss",  # no descent left along the direction
        9: f"stopped after {result.nit} iterations",
    }
    return converged.get(result.status, f"stopped: {result.message}")
