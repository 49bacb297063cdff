"""Checks by samples that a distance is finite and no steeper than its bound L."""

import numpy as np

from brdfkit.distance_fields.evaluation import evaluate
from brdfkit.errors import BrdfkitError

ROUNDING = 1e-9


def check(distance, low, high, lipschitz=1.0, samples=100_000, seed=0):
    """Raise `BrdfkitError` where a callable `distance` is not finite, or steeper than `lipschitz`.

    Pairs of points are drawn in the box from `low` to `high`, at all distances from its diagonal
    down to 10⁻⁴ of it. That none of them is too far apart is no proof.
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
