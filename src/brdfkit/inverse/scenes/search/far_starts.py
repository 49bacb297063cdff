"""Where a search begins: at the best of many points, of which few samples tell enough.

A wide lobe beside a narrow highlight is a valley of its own; no descent leaves it.
"""

import numpy as np

from brdfkit.core.interrupts import Interrupted
from brdfkit.inverse.scenes.search.forward_derivatives import share, tangents
from brdfkit.inverse.scenes.search.gauss_newton import Search, few_samples, search
from brdfkit.inverse.scenes.search.normal_equations import Residuals
from brdfkit.regression.problem.box_quadratic import minimise_in_box
from brdfkit.regression.search.starting_points import start_points

BEST = 3  # points that go on
FEW = 2  # steps that they take
MORE = 2  # times as many samples judge where they came to
PER_NUMBER = 8  # points for each number in which pictures are not linear


def start(views, count, seed, report):
    """The coordinates of the best of `count` points after some steps; the scene's own is one.

    `report()` is called after each point. Without any that pictures are not linear in, the scene's
    own point is best. On Ctrl-C `Interrupted` has a `Search` at the best so far.
    """
    curved = views.curved
    if count == 1 or not curved.any():
        return views.start
    spread = start_points(None, views.start[None, curved][0], count, seed)
    spp, tried, ends = few_samples(views), [], []
    try:
        for coordinates in spread:
            point = views.start.copy()
            point[curved] = coordinates
            tried.append(_solve_linear(views, point, spp // 2, seed))
            report()
        tried.sort(key=lambda residuals: residuals.bound)
        for residuals in tried[:BEST]:
            ends.append(search(views, residuals.x, FEW, spp, seed).here)
            report()
    except KeyboardInterrupt:
        if not tried:
            raise
        raise Interrupted(Search(_best(ends or tried))) from None
    return _best(_judge(views, [views.start, *(end.x for end in ends)], spp, seed)).x


def _judge(views, points, spp, seed):
    """The `Residuals` at several points, by more samples, which chose none of them."""
    return [Residuals.at(views, x, MORE * spp, seed + 50) for x in points]


def _best(several):
    """The `Residuals` that are least for sure."""
    return min(several, key=lambda residuals: residuals.bound)


def _solve_linear(views, x, spp, seed):
    """The `Residuals` at `x`, its linear numbers those of the least squares, for direct light."""
    linear = np.nonzero(views.linear)[0]
    if not len(linear):
        return Residuals.at(views, x, spp, seed)
    dark = np.where(views.linear, 0, x)
    (a, reached_a), (b, reached_b) = (
        _steps_from(views, dark, linear, spp // 2, seed + 1000 * half) for half in (0, 1)
    )
    weighed = views.weights * a
    hessian = weighed.reshape(len(a), -1) @ b.reshape(len(b), -1).T.astype(float)
    gradient = (weighed * reached_b + views.weights * b * reached_a).sum(axis=(1, 2)) / 2
    hessian = (hessian + hessian.T) / 2
    hessian += 1e-3 * np.diag(np.maximum(np.diagonal(hessian), 1e-30))
    box = views.least[None, linear], views.most[None, linear]
    found = minimise_in_box(hessian[None], gradient[None], *box)[0]
    x = dark.copy()
    x[linear] = found
    return Residuals.at(views, x, spp, seed)


def _steps_from(views, x, numbers, spp, seed):
    """(what each of the `numbers` adds to the pixels, from 0 to 1; the residuals without them).

    Those of a colour change their own channels, and are taken in one picture.
    """
    without = views.residuals(x, spp, seed)
    found = np.zeros((len(numbers), *without.shape), np.float32)
    rows = {number: row for row, number in enumerate(numbers)}
    for group in tangents(views):
        if not rows.keys() >= set(group):
            continue
        moved = np.array(x, float)
        moved[group] = 1
        change = views.residuals(moved, spp, seed) - without
        share(change, found, [rows[number] for number in group])
    return found, without


def usual_count(views):
    """How many points a search begins at."""
    return 1 + min(PER_NUMBER * int(views.curved.sum()), 32)
