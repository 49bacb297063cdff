"""Newton's matrix where it is not convex, for longer steps of passes that creep."""

import numpy as np

# Newton's steps are at most 1 / this times longer than ordinary ones, in each direction
LEAST_CURVATURE = 0.02


def make_convex(newton, hessian):
    """Newton's matrix (n, n) with eigenvalues, beside those of `hessian`, an ordinary pass's, that
    are positive and not small, and the projection (n, n) onto the directions where they were
    negative, or None."""
    scale = 1 / np.sqrt(np.maximum(np.diag(hessian), 1e-300))
    scaled = hessian * np.outer(scale, scale) + 1e-10 * np.eye(len(hessian))
    root = np.linalg.cholesky(scaled)
    inner = np.linalg.solve(root, np.linalg.solve(root, newton * np.outer(scale, scale)).T)
    values, vectors = np.linalg.eigh((inner + inner.T) / 2)
    both = root @ vectors / scale[:, None]
    convex = (both * np.clip(np.abs(values), LEAST_CURVATURE, 1)) @ both.T
    negative = values < 0
    if not negative.any():
        return convex, None
    return convex, np.linalg.solve(both.T, both.T * negative[:, None])
