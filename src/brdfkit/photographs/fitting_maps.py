"""Maps fitted to observations: each texel for itself, then all together, as smooth as helps lights
that were held out."""

from dataclasses import dataclass, replace

import numpy as np

from brdfkit.fitting.stopped import Stopped
from brdfkit.photographs.misfit import MISFIT, misfits
from brdfkit.photographs.numbers import CHANNELS
from brdfkit.photographs.observations import shown_colours
from brdfkit.photographs.open_numbers import are_seen, is_open
from brdfkit.photographs.restarts import propagated, restarted
from brdfkit.photographs.search import Equations, equations, search_each, search_together
from brdfkit.photographs.starts import WIDTHS, rows

TAUS = 1.0, 0.3, 0.1, 0.03  # typical differences of neighbours, of which one is chosen
FEW_TO_HOLD_OUT = 8  # lights, below which none is held out
USUAL = 0.1  # the τ of so few
COARSE = 4  # texels along a side of the first maps
SEARCHES = 5  # for the noise, at most
SETTLED = 0.7  # of the noise before
SWEEPS = 2  # of numbers handed on to neighbours
PATCH = 48  # texels along a side of the part on which τ is chosen


def usual_total(lights, smoothness):
    """How many steps a search for maps takes, about, for its progress."""
    held_out = smoothness is None and lights >= FEW_TO_HOLD_OUT
    return 250 + 300 * held_out


@dataclass(frozen=True)
class FittedMaps:
    """Rows `x` (n, count) and the `Equations` there; `tau`, by which neighbours may differ; the
    `noise`, as a variance of relative radiances; and `errors`: of each τ that was tried, that of
    the lights held out, relative."""

    x: np.ndarray
    about: Equations
    tau: float
    noise: float
    strength: np.ndarray
    errors: dict[float, float]


def fit_maps(numbers, seen, smoothness=None, report=lambda: None):
    """The `FittedMaps` of `Observations`; `smoothness`: τ, or None for one that is chosen.

    On Ctrl-C `Stopped` has those of the finest maps that are finished, if there are any.
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
        raise Stopped(_enlarged(numbers, seen, *finest)) from None
    return FittedMaps(x, equations(numbers, x, seen), tau, noise, strength, errors)


def _enlarged(numbers, seen, x, noise, coarse):
    """The `FittedMaps` of rows of maps of the shape `coarse`."""
    height, width = seen.shape
    side = 1  # a power of 2, as in `coarse_to_fine`
    while side * coarse[0] < height or side * coarse[1] < width:
        side *= 2
    grid = x.reshape(*coarse, -1).repeat(side, axis=0).repeat(side, axis=1)
    x = grid[:height, :width].reshape(height * width, -1)
    strength = strengths(numbers, x, seen, noise, USUAL)
    return FittedMaps(x, equations(numbers, x, seen), USUAL, noise, strength, {})


def coarse_to_fine(numbers, seen, report):
    """Yield (rows, noise, shape) of maps that are first a few texels large, then twice as fine and
    so on: a texel alone may mistake a highlight for its colour, a part of the sample less so."""
    side = 2 ** max(0, int(np.ceil(np.log2(max(seen.shape) / COARSE))))
    pooled = seen.pooled(side)
    tried = [
        search_each(numbers, rows(numbers, pooled, width), pooled, report=report)
        for width in WIDTHS
    ]
    errors = np.array([error for _, error in tried])
    best = errors.argmin(axis=0)
    x = np.array([x for x, _ in tried])[best, np.arange(len(best))]
    noise = noise_of(numbers, errors.min(axis=0), pooled)
    yield x, noise, pooled.shape
    while side > 1:
        side //= 2
        coarse, pooled = pooled.shape, seen.pooled(side)
        x = refined(x, coarse, pooled.shape)
        x, noise = settled(numbers, x, pooled, noise, report)
        strength = strengths(numbers, x, pooled, noise, USUAL)
        x = finish(numbers, x, pooled, strength, noise, report)
        noise = noise_of(numbers, equations(numbers, x, pooled, slopes=False).error, pooled)
        yield x, noise, pooled.shape


def settled(numbers, x, seen, noise, report):
    """(rows, noise): what coarser maps leave is no noise of finer ones, which it would smooth."""
    for _ in range(SEARCHES):
        strength = strengths(numbers, x, seen, noise, USUAL)
        x = search_together(numbers, x, seen, strength, report=report)
        before, noise = (
            noise,
            noise_of(numbers, equations(numbers, x, seen, slopes=False).error, seen),
        )
        if noise > SETTLED * before:
            break
    return x, noise


def refined(x, coarse, fine):
    """Rows of maps of the shape `coarse` for those of `fine`, twice as many a side."""
    grid = np.repeat(np.repeat(x.reshape(*coarse, -1), 2, axis=0), 2, axis=1)
    return grid[: fine[0], : fine[1]].reshape(fine[0] * fine[1], -1)


def finish(numbers, x, seen, strength, noise, report):
    """Rows of the least squares together; texels that are not explained, or that their neighbours'
    numbers suit better, begin at others once more."""
    x = search_together(numbers, x, seen, strength, report=report)
    other = restarted(numbers, x, seen, noise, report)
    for _ in range(SWEEPS):
        other = propagated(numbers, other, seen, report)
    if (other != x).any():
        x = search_together(numbers, other, seen, strength, report=report)
    return x


def noise_of(numbers, errors, seen):
    """The variance of a relative radiance, from what the texels leave: the median is robust."""
    counted = (seen.weights > 0).sum(axis=(0, 2))
    free = np.maximum(counted - numbers.count, 0.2 * counted)
    return max(float(np.median(errors / np.maximum(free, 1))), 1e-10)


def strengths(numbers, x, seen, noise, tau):
    """σ² / τ² (count,) of each number, in its unit."""
    return noise / (tau * units_of(numbers, x, seen)) ** 2


def units_of(numbers, x, seen):
    """The units (count,) of differences. That of a weight is the one by which its lobe alone would
    be as bright as what is seen: not the weight so far, as one that is near 0 would rest there."""
    hessian = equations(numbers, x, seen).hessian
    of_weights = slice(0, numbers.shapes.start)
    brightness = np.diagonal(hessian, axis1=1, axis2=2)[:, of_weights]
    counted = (seen.weights > 0).sum(axis=(0, 2))[:, None] / CHANNELS
    alone = np.sqrt(counted / np.maximum(brightness, 1e-12 * counted + 1e-300))
    units, lit = np.ones(numbers.count), shown_colours(seen)
    scale = np.median(alone[counted[:, 0] > 0], axis=0).reshape(-1, CHANNELS)[:, lit].mean(axis=1)
    units[of_weights] = np.repeat(scale, CHANNELS)
    return units


def held_out_errors(numbers, seen, noise, report):
    """τ → the RMS relative error of lights that were held out, on a patch in the middle."""
    part = patch(seen)
    lights = np.arange(len(seen.radiance))
    held = lights[1 :: max(2, len(lights) // 3)]
    taught, asked = part.under(np.setdiff1d(lights, held)), part.under(held)
    *_, (start, _, _) = coarse_to_fine(numbers, taught, report)
    units, found = units_of(numbers, start, taught), {}
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


def standard_errors(numbers, fitted, seen):
    """Standard errors (n, count) of each number by the equations, neighbours given.

    Those of a texel that is not explained are by what it leaves. Where photographs leave numbers
    open, they do so in the neighbours, too: there each has its limits or its unit in their place.
    """
    noise, own = fitted.noise, fitted.about.hessian
    unit = np.diag(noise / ranges(numbers, fitted.x, seen) ** 2)
    together = own + 4 * np.diag(fitted.strength * are_seen(own)) + unit
    matrix = np.where(is_open(own)[:, None, None], own + unit, together)
    variance = np.diagonal(np.linalg.inv(matrix), axis1=1, axis2=2)
    misfit = misfits(fitted.about.error, noise, seen)
    noise = noise * np.where(misfit > MISFIT, misfit, 1) ** 2
    return np.sqrt(np.maximum(variance, 0) * noise[:, None])


def ranges(numbers, x, seen):
    """How far (count,) each number may be from where it is, at most, about."""
    found, (low, high) = units_of(numbers, x, seen), numbers.limits()
    limited = np.isfinite(high - low)
    found[limited] = (high - low)[limited] / 2
    return found
