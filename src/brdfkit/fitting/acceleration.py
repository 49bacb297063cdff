"""Longer steps for passes that creep: Newton's, and mixtures of those before."""

import numpy as np

# Newton's steps are at most 1 / this times longer than ordinary ones, in each direction
LEAST_CURVATURE = 0.02
# How many steps are mixed
MIXED = 5


def make_convex(newton, hessian):
    """Newton's matrix with eigenvalues that are positive and not small beside those of `hessian`,
    an ordinary pass's."""
    scale = 1 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    scaled = hessian * np.outer(scale, scale) + 1e-10 * np.eye(len(hessian))
    root = np.linalg.cholesky(scaled)
    inner = np.linalg.solve(root, np.linalg.solve(root, newton * np.outer(scale, scale)).T)
    values, vectors = np.linalg.eigh((inner + inner.T) / 2)
    both = root @ vectors
    positive = np.clip(np.abs(values), LEAST_CURVATURE, 1)
    return (both * positive) @ both.T / np.outer(scale, scale)


class Anderson:
    """Anderson's mixing of the last steps of a fixed-point iteration [Walker & Ni 2011]; lengths
    are those of `metric`."""

    def __init__(self, metric):
        self.metric, self.points, self.steps = metric, [], []

    def mix(self, point, step):
        """The step from `point` (n,), mixed of `step` and those before."""
        self.points, self.steps = [*self.points[-MIXED:], point], [*self.steps[-MIXED:], step]
        if len(self.points) == 1:
            return step
        by_point, by_step = (np.diff(np.array(a), axis=0) for a in (self.points, self.steps))
        gram = by_step @ self.metric @ by_step.T
        share = np.linalg.lstsq(
            gram + 1e-12 * np.trace(gram) * np.eye(len(gram)),
            by_step @ self.metric @ step,
            rcond=None,
        )[0]
        return step - share @ (by_point + by_step)
