"""Checks by samples that a distance is finite and no steeper than its bound L."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from brdfkit.distance_fields.evaluation import evaluate
from brdfkit.errors import BrdfkitError

ROUNDING = 1e-9


def check(
    distance: Callable[[Any], Any],
    low: ArrayLike,
    high: ArrayLike,
    lipschitz: float = 1.0,
    samples: int = 100_000,
    seed: int = 0,
) -> None:
    """Check by pairs of points that a distance is finite, and no steeper than its bound.

    The points of a pair are apart by the diagonal of the box, down to 10⁻⁴ of it. That nothing is
    found is no proof.

    Parameters
    ----------
    distance : callable
        f(p) of points; as a node's `distance`.
    low, high : three numbers
        The corners of the box in which it is checked.
    lipschitz : float, default 1
        The bound L.
    samples : integer, default 100_000
        How many pairs are drawn.
    seed : integer, default 0
        Of the random numbers.

    Raises
    ------
    BrdfkitError
        Where f is not finite, or steeper; it says where.

    Examples
    --------
    >>> check(lambda p: 3 * p.x, (0, 0, 0), (1, 1, 1))
    brdfkit.errors.BrdfkitError: the field changes by 3 per unit near (0.6, 0.2, 0.04), more ...
    """
    rng, low, high = np.random.default_rng(seed), np.asarray(low, float), np.asarray(high, float)
    a = rng.uniform(low, high, (samples, 3))
    step = rng.normal(size=(samples, 3))
    step *= 10.0 ** rng.uniform(-4, 0, (samples, 1)) / np.linalg.norm(step, axis=1, keepdims=True)
    b = np.clip(a + step * np.linalg.norm(high - low), low, high)
    f, g = evaluate(distance, a), evaluate(distance, b)
    if not np.isfinite(f).all():
        value, at = f[~np.isfinite(f)][0], a[~np.isfinite(f)][0]
        raise BrdfkitError(f"the field is {value} at {_place(at)}; a distance is finite.")
    apart = np.linalg.norm(a - b, axis=1)
    steepness = (np.abs(f - g) - ROUNDING) / np.maximum(apart, 1e-30)
    worst = int(np.nanargmax(steepness))
    if steepness[worst] > lipschitz:
        raise BrdfkitError(
            f"the field changes by {steepness[worst]:.3g} per unit near {_place(a[worst])}, "
            f"more than its bound {lipschitz:g}: no distance does; divide it by the slope."
        )


def _place(p):
    return f"({', '.join(f'{c:.3g}' for c in p)})"
