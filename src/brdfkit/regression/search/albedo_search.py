"""Corrects a fit whose albedo is wrong, by a second search with a term for the albedo.

A loss compares single values. A model that cannot meet all of them may reflect far too much or too
little light in total, for instance if grazing angles are missing, a highlight falls between the
samples, or the material has retro-reflection. The second search minimises

    E² / E₀² + share · mean over θ_i and channels of ((a - a*) / ā*)²,

where E is the loss and E₀ its value after the first search, a is the model's directional albedo at
the angle of incidence θ_i, a* the albedo of the data, and ā* the mean of a* over the channels. The
factor `share` is raised until the albedo is right, or the loss grows too much. A fit with correct
albedos is not changed.
"""

from __future__ import annotations

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.model.evaluation import mix_lobes
from brdfkit.model.samples import Samples
from brdfkit.regression.albedo import TargetAlbedo, format_light_share
from brdfkit.regression.losses.loss import Loss
from brdfkit.regression.problem.pixel_problem import PixelProblem
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.search.levenberg_marquardt import ROUNDING
from brdfkit.regression.search.multistart import make_part_problems, search_from_starts

# Factors of the albedo term in the minimised function, which are tried one after the other
SHARES = 10.0, 40.0, 160.0
# The second search is accepted if the distance of the albedos from the data falls to this share
DISTANCE_SHARE = 0.6
# Largest factor by which the loss may grow in the second search; it is multiplied by the largest
# albedo after the first search, if this is above 1
LARGEST_LOSS_RATIO = 1.4

# Start of the note on a fit with corrected albedo, by which `Refit` recognises such a fit
NOTE = "by the loss alone"

DIFFERENCE = Loss(
    "light",
    "difference of albedos",
    lambda model, measured, cos_i, cos_o: model - measured,
    measure="samples",
)


def correct_albedo(
    whole: Problem,
    u: FloatArray,
    weights: FloatArray,
    target: TargetAlbedo,
    points: FloatArray,
    rng: np.random.Generator,
) -> tuple[FloatArray, FloatArray, str] | None:
    """Search again for a fit whose albedo differs from the albedo of its data.

    Return the new solution and a note, (u, weights, note), or None if the albedo is right or cannot
    be corrected. `whole`: the problem on all samples; `u` (1, shapes), `weights` (1, channels,
    lobes): the solution of the first search; `target`: the albedo of the data; `points` (count,
    shapes): further starts; `rng`: a generator that draws parts of the samples if there are many.
    """

    def compute_albedos(u: FloatArray, weights: FloatArray) -> FloatArray:
        """Return the albedos (angles, channels) of the model with these parameters."""
        model = whole.model(**whole.space.to_named_values(u[0]))
        return target.compute_albedos(lambda wi, wo: mix_lobes(model, weights[0].T, wi, wo))

    free = compute_albedos(u, weights)
    if target.accepts_albedos(free):
        return None
    wrong = target.find_wrong_angles(free)
    first = whole.compute_sums(u, weights, curvature=False).error[0]
    first = max(first, ROUNDING * whole.black_squares.sum())
    parts, points, accepted = make_part_problems(whole, rng), np.concatenate([u, points]), None
    for share in SHARES:
        problems = [AlbedoProblem(part, target, wrong, first, share) for part in parts]
        ends, *_ = search_from_starts(problems, points, lambda done, total: None)
        end = ends.u[:1], ends.weights[:1]
        corrected = compute_albedos(*end)
        error = whole.compute_sums(*end, curvature=False).error[0]
        if error > (LARGEST_LOSS_RATIO * max(free.max(), 1)) ** 2 * first:
            break
        if target.compute_albedo_distance(
            corrected
        ) <= DISTANCE_SHARE * target.compute_albedo_distance(free):
            accepted = *end, _describe_correction(target, wrong, free, corrected)
        if target.accepts_albedos(corrected):
            break
        points = end[0]
    return accepted


def _describe_correction(
    target: TargetAlbedo, wrong: BoolArray, free: FloatArray, corrected: FloatArray
) -> str:
    """Return the note on a fit with corrected albedo: its albedo at the worst angle, then and now.

    `wrong` (n,): whether the albedo was wrong at each angle; `free`, `corrected` (n, channels): the
    albedos after the first and after the second search.
    """
    gains = np.log(np.maximum(free.max(axis=1), 1e-9))
    logs = np.maximum(np.abs(np.log(target.compute_albedo_ratios(free))), gains)
    row = int(np.argmax(np.where(wrong, logs, -np.inf)))
    shares = (
        format_light_share(albedos[row].mean()) for albedos in (free, target.values, corrected)
    )
    before, measured, after = shares
    measured = f", where the measurement reflects {measured}"
    return (
        f"{NOTE} it would reflect {before} of the light at "
        f"{target.theta_i[row]:g}°{measured * bool(target.known[row])}; with a term for its albedo "
        f"it reflects {after}"
    )


class AlbedoProblem(PixelProblem):
    """The function that the second search minimises: the squared loss plus a term for the albedo.

    `problem`: the problem of the first search; `target`: the albedo of the data; `wrong` (n,):
    whether an angle of incidence contributes to the term; `error`: the squared loss after the first
    search, by which the loss is divided; `share`: the factor of the term.
    """

    def __init__(
        self, problem: Problem, target: TargetAlbedo, wrong: BoolArray, error: float, share: float
    ) -> None:
        self.albedo_settings = target, wrong, error, share
        mean = np.maximum(target.limited_values[wrong].mean(axis=1), 1e-6)
        weights = share / (len(mean) * problem.channels) / mean**2
        super().__init__(
            *(problem.model, problem.samples, problem.loss, problem.space, 1 / error),
            *(target.pixels.at(wrong), weights, DIFFERENCE),
        )

    def with_samples(self, samples: Samples) -> AlbedoProblem:
        """Return the problem with the same model, loss and albedo term on other `Samples`."""
        part = Problem(self.model, samples, self.loss, self.space)
        return AlbedoProblem(part, *self.albedo_settings)
