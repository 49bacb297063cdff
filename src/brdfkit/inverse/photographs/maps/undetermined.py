"""What the lights leave open, in words."""

import numpy as np

from brdfkit.core.names import join_words
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS

OPEN = 1e-4  # an eigenvalue of the Hessian, of unit diagonal, below which a combination is open
PART = 0.3  # of the largest entry: which numbers are in that combination
SHARE = 0.05  # of the texels, from which it is said


def describe_open(numbers, fitted, lights):
    """Sentences on numbers that many texels do not determine for themselves."""
    said = []
    if lights == 1:
        said.append("One light: roughness and strength trade off here, and the normal with both.")
    hessian = fitted.about.hessian
    hessian = hessian[np.diagonal(hessian, axis1=1, axis2=2).any(axis=1)]  # none at the edge
    kept, scaled = _of_seen(hessian)
    values, vectors = np.linalg.eigh(scaled)
    left_open = values[:, 0] < OPEN
    if left_open.mean() < SHARE:
        return tuple(said)
    weakest = np.abs(vectors[left_open, :, 0])
    weakest /= weakest.max(axis=1, keepdims=True)
    names = [_names(numbers)[k] for k in kept]
    share = dict(zip(names, (weakest > PART).mean(axis=0), strict=True))
    several = {}
    for name, value in share.items():
        plain = name.partition("[")[0]
        several[plain] = max(value, several.get(plain, 0))
    worst = [name for name, value in several.items() if value > 0.25] or list(several)
    apart = f"{join_words(worst)} apart" if len(worst) > 1 else worst[0]
    said.append(
        f"In {100 * left_open.mean():.0f} % of the texels the photographs do not tell {apart}: "
        "there their neighbours decide. More lights near the mirror's direction would."
    )
    return tuple(said)


def are_seen(hessian):
    """Which numbers (count,) the photographs show anywhere: not those of colours without light."""
    return np.diagonal(hessian, axis1=1, axis2=2).any(axis=0)


def is_open(hessian):
    """Which texels (n,) leave a combination of numbers open, by Hessians (n, count, count)."""
    return np.linalg.eigvalsh(_of_seen(hessian)[1])[:, 0] < OPEN


def _of_seen(hessian):
    """(the numbers that `are_seen`, Hessians of these, of unit diagonal)."""
    kept = np.flatnonzero(are_seen(hessian))
    hessian = hessian[:, kept[:, None], kept]
    scale = 1 / np.sqrt(np.maximum(np.diagonal(hessian, axis1=1, axis2=2), 1e-300))
    return kept, hessian * scale[:, :, None] * scale[:, None, :]


def _names(numbers):
    weights = [f"{name}[{c}]" for name in numbers.lobes for c in range(CHANNELS)]
    return [*weights, *numbers.form.columns, "normal[x]", "normal[y]"]
