"""Maps fitted to observations: each texel for itself, then all together, as smooth as helps lights
that were held out."""

from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.interrupts import Interrupted
from brdfkit.inverse.photographs.maps.residuals import MISFIT, misfits
from brdfkit.inverse.photographs.maps.undetermined import are_seen, is_open
from brdfkit.inverse.photographs.search.coarse_to_fine import USUAL, coarse_to_fine, finish
from brdfkit.inverse.photographs.search.search import Equations, equations
from brdfkit.inverse.photographs.search.smoothness import strengths, units_of

TAUS = 1.0, 0.3, 0.1, 0.03  # typical differences of neighbours, of which one is chosen
PATCH = 48  # texels along a side of the part on which that is


def held_out_errors(numbers, seen, noise, report):
    """τ → the RMS relative error of lights that were held out, on a patch in the middle."""
    part = patch(seen)
    lights = np.arange(len(seen.radiance))
    held = lights[1 :: max(2, len(lights) // 3)]
    taught, asked = part.under(np.setdiff1d(lights, held)), part.under(held)
    *_, (start, _, _) = coarse_to_fine(numbers, taught, report)
    units, found = units_of(numbers, equations(numbers, start, taught).hessian, taught), {}
    for tau in TAUS:
        x = finish(numbers, start, taught, noise / (tau * units) ** 2, noise, report)
        left = equations(numbers, x, asked, slopes=False).error
        found[tau] = float(np.sqrt(left.sum() / max(1, (asked.weights > 0).sum())))
    return found


def patch(seen):
    """`Observations` of a patch in the middle."""
    height, width = seen.shape
    rows_, columns = min(height, PATCH), min(width, PATCH)
    top, left = (height - rows_) // 2, (width - columns) // 2
    texel = np.arange(height * width).reshape(height, width)
    inside = seen.at(texel[top : top + rows_, left : left + columns].ravel())
    return replace(inside, shape=(rows_, columns))


FEW_TO_HOLD_OUT = 8  # lights, below which none is held out


def usual_total(lights, smoothness):
    """How many steps a search for maps takes, about, for its progress."""
    held_out = smoothness is None and lights >= FEW_TO_HOLD_OUT
    return 250 + 300 * held_out


@dataclass(frozen=True)
class FittedMaps:
    """Rows `x` (n, count) and the `Equations` there; `tau`, by which neighbours may differ; the
    `noise`, as a variance of relative radiances; and `errors`: of each τ that was tried, that of
    the lights held out, relative. The equations and the `strength` of the neighbours are None where
    Ctrl-C ended the search."""

    x: np.ndarray
    about: Equations | None
    tau: float
    noise: float
    strength: np.ndarray | None
    errors: dict[float, float]


def fit_maps(numbers, seen, smoothness=None, report=lambda: None):
    """The `FittedMaps` of `Observations`; `smoothness`: τ, or None for one that is chosen.

    On Ctrl-C `Interrupted` has those of the finest maps that are finished, if there are any.
    """
    finest = None
    try:
        for finest in coarse_to_fine(numbers, seen, report):
            start, noise, _ = finest
        errors = {}
        tau = smoothness
        if tau is None:
            tau = USUAL
            if len(seen.radiance) >= FEW_TO_HOLD_OUT:
                errors = held_out_errors(numbers, seen, noise, report)
                tau = min(errors, key=errors.get)
        strength = strengths(numbers, start, seen, noise, tau)
        x = finish(numbers, start, seen, strength, noise, report)
    except KeyboardInterrupt:
        if finest is None:
            raise
        raise Interrupted(_enlarged(seen.shape, *finest)) from None
    return FittedMaps(x, equations(numbers, x, seen), tau, noise, strength, errors)


def _enlarged(shape, x, noise, coarse):
    """The `FittedMaps` of rows of maps of the shape `coarse`, as they are: without equations."""
    height, width = shape
    side = 1  # a power of 2, as in `coarse_to_fine`
    while side * coarse[0] < height or side * coarse[1] < width:
        side *= 2
    grid = x.reshape(*coarse, -1).repeat(side, axis=0).repeat(side, axis=1)
    x = grid[:height, :width].reshape(height * width, -1)
    return FittedMaps(x, None, USUAL, noise, None, {})


def standard_errors(numbers, fitted, seen):
    """Standard errors (n, count) of each number by the equations, neighbours given.

    Those of a texel that is not explained are by what it leaves. Where photographs leave numbers
    open, they do so in the neighbours, too: there each has its limits or its unit in their place.
    """
    noise, own = fitted.noise, fitted.about.hessian
    unit = np.diag(noise / ranges(numbers, own, seen) ** 2)
    together = own + 4 * np.diag(fitted.strength * are_seen(own)) + unit
    matrix = np.where(is_open(own)[:, None, None], own + unit, together)
    variance = np.diagonal(np.linalg.inv(matrix), axis1=1, axis2=2)
    misfit = misfits(fitted.about.error, noise, seen)
    noise = noise * np.where(misfit > MISFIT, misfit, 1) ** 2
    return np.sqrt(np.maximum(variance, 0) * noise[:, None])


def ranges(numbers, hessian, seen):
    """How far (count,) each number may be from where it is, at most, about."""
    found, (low, high) = units_of(numbers, hessian, seen), numbers.limits()
    limited = np.isfinite(high - low)
    found[limited] = (high - low)[limited] / 2
    return found
