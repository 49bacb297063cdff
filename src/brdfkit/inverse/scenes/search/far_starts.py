"""Chooses where a search begins, among many points spread over the bounds.

A wide lobe in place of a narrow highlight is a local minimum that no descent leaves. Therefore many
points are tried with few samples, and the best ones take a few steps.
"""

from collections.abc import Callable, Iterable

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.core.interrupts import Interrupted
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.search.forward_derivatives import (
    group_numbers_by_picture,
    store_by_channel,
)
from brdfkit.inverse.scenes.search.gauss_newton import (
    Search,
    choose_initial_samples,
    run_gauss_newton,
)
from brdfkit.inverse.scenes.search.normal_equations import Residuals
from brdfkit.regression.problem.box_quadratic import minimise_in_box
from brdfkit.regression.search.multistart import make_start_points

# how many of the best points take Gauss-Newton steps, and how many steps each
FINALISTS, FINALIST_STEPS = 3, 2
# Ratio of the number of samples that compare the finalists to the number that chose them
JUDGE_FACTOR = 2
# How many points are tried for each searched number in which pictures are not linear
POINTS_PER_NUMBER = 8
PICTURES = 3  # of more pictures under lamps of their own, so many choose the start
POINT_LIMIT = 32  # largest number of points besides the scene's own values


def count_default_starts(views: Views) -> int:
    """Return how many points a search tries by default, the scene's own values included."""
    return 1 + min(POINTS_PER_NUMBER * int(views.is_nonlinear_share.sum()), POINT_LIMIT)


def find_best_start(
    views: Views, count: int, seed: int, report: Callable[[], object]
) -> FloatArray:
    """Return the coordinates where the search should begin, the best of `count` points.

    The scene's own values are one of the points; they are returned at once where pictures are
    linear in all numbers. `report()` is called after each point. On Ctrl-C `Interrupted` holds a
    `Search` at the best point so far.
    """
    nonlinear = views.is_nonlinear_share
    if count == 1 or not nonlinear.any():
        return views.start
    points = make_start_points(views.start[None, nonlinear][0], count, seed)
    few = views.pick_pictures(PICTURES)
    spp = choose_initial_samples(few)
    tried: list[Residuals] = []
    finalists: list[Residuals] = []
    try:
        for coordinates in points:
            point = views.start.copy()
            point[nonlinear] = coordinates
            tried.append(_solve_linear_numbers(few, point, spp // 2, seed))
            report()
        tried.sort(key=lambda residuals: residuals.bound)
        for residuals in tried[:FINALISTS]:
            end = run_gauss_newton(few, residuals.x, FINALIST_STEPS, spp, seed)
            finalists.append(end.residuals)
            report()
    except KeyboardInterrupt:
        if not tried:
            raise
        best = _select_best_point(finalists or tried).x
        raise Interrupted(Search(Residuals.render(views, best, spp, seed))) from None
    if few is not views:
        views.cost += few.cost * len(few.targets) / len(views.targets)
    spp = choose_initial_samples(views)
    # New samples compare the finalists, because a finalist was chosen for being good with the old
    # ones
    candidates = [views.start, *(end.x for end in finalists)]
    return _select_best_point(
        Residuals.render(views, x, JUDGE_FACTOR * spp, seed + 50) for x in candidates
    ).x


def _select_best_point(points: Iterable[Residuals]) -> Residuals:
    """Return the residuals of the point with the smallest upper bound of the squared residual."""
    return min(points, key=lambda residuals: residuals.bound)


def _solve_linear_numbers(views: Views, x: FloatArray, spp: int, seed: int) -> Residuals:
    """Solve for the numbers in which pictures are linear; return the residuals at the solution.

    The solution is exact for direct light. Lamps keep their strength if colours of materials are
    searched, too, as pictures are linear in each of the two, but not in both.
    """
    of_materials = views.is_linear & ~views.is_lamp
    is_solved = of_materials if of_materials.any() else views.is_linear
    linear = np.nonzero(is_solved)[0]
    if not len(linear):
        return Residuals.render(views, x, spp, seed)
    dark = np.where(is_solved, 0, x)
    (a, residuals_a), (b, residuals_b) = (
        _render_unit_changes(views, dark, linear, spp // 2, seed + 1000 * half) for half in (0, 1)
    )
    weighed = views.weights * a
    hessian = weighed.reshape(len(a), -1) @ b.reshape(len(b), -1).T.astype(float)
    gradient = (weighed * residuals_b + views.weights * b * residuals_a).sum(axis=(1, 2)) / 2
    hessian = (hessian + hessian.T) / 2
    hessian += 1e-3 * np.diag(np.maximum(np.diagonal(hessian), 1e-30))
    box = views.lower_bounds[None, linear], views.upper_bounds[None, linear]
    x = dark.copy()
    x[linear] = minimise_in_box(hessian[None], gradient[None], *box)[0]
    return Residuals.render(views, x, spp, seed)


def _render_unit_changes(
    views: Views, x: FloatArray, numbers: IntArray, spp: int, seed: int
) -> tuple[AnyArray, FloatArray]:
    """Return the changes of pixels as each of the `numbers` goes from 0 to 1, and the residuals.

    The changes are (numbers, pixels, channels); the residuals (pixels, channels) are those with all
    `numbers` at 0, which `x` must hold.
    """
    before, split = views.render_pixels(x, spp, seed), views.split_pictures
    residuals = before - views.target_pixels
    changes = np.zeros((len(numbers), *residuals.shape), np.float32)
    rows = {number: row for row, number in enumerate(numbers)}
    for group in group_numbers_by_picture(views):
        if not rows.keys() >= set(group):
            continue
        moved = np.array(x, float)
        moved[group] = 1
        changed = views.find_changed_pictures(group)
        change = views.render_pixels(moved, spp, seed, changed) - before
        own = [picture if i in changed else 0 * picture for i, picture in enumerate(split(change))]
        store_by_channel(views.join_pictures(own), changes, [rows[number] for number in group])
    return changes, residuals
