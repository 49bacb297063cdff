"""Searches a fit once more, with a term for its light, where the first search ends far from it.

A loss compares values, and a model that cannot meet them all may end with far too much light or too
little: where grazing angles are missing, a highlight falls between the samples, or a material
reflects light back. The second search minimises

    E² / E₀² + share · mean over θ_i and channels of ((a - a*) / ā*)²,

a being the model's albedo and a* the data's, ā* its mean over the channels, and E₀ the error of the
first search. A fit whose light is right is left as it is.
"""

import numpy as np

from brdfkit.model.evaluation import mix_lobes
from brdfkit.regression.light import format_share
from brdfkit.regression.losses.loss import Loss
from brdfkit.regression.problem.pixel_problem import PixelProblem
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.search.levenberg_marquardt import ROUNDING
from brdfkit.regression.search.multistart import search, with_parts

# How much the light counts beside the error: more where less does not do
SHARES = 10.0, 40.0, 160.0
# The second end is kept where it brings the logarithm of the factor between the albedos to this
# share, and where E is at most so many times as large, times the light that is gained, if any: a
# model that pays more for its light is left as it is
NEARER, DEAREST = 0.6, 1.4

# How the note begins on a fit that keeps the light
NOTE = "by the loss alone"

DIFFERENCE = Loss(
    "light",
    "difference of albedos",
    lambda model, measured, cos_i, cos_o: model - measured,
    measure="samples",
)


def keep_light(whole, u, weights, light, points, rng):
    """Where a search has ended with other light than the data's, the end (u, weights) of another
    one with a term for it, and a note; None where the light is right, or the model cannot.

    `points` (count, shapes): where it begins, beside the first end.
    """

    def look(u, weights):
        model = whole.model(**whole.space.values(u[0]))
        return light.look(lambda wi, wo: mix_lobes(model, weights[0].T, wi, wo))

    free = look(u, weights)
    if light.is_right(free):
        return None
    counted = light.counted(free)
    first = max(whole.sums(u, weights, curvature=False).error[0], ROUNDING * whole.black.sum())
    parts, points, kept = with_parts(whole, rng), np.concatenate([u, points]), None
    for share in SHARES:
        problems = [LightProblem(part, light, counted, first, share) for part in parts]
        ends, *_ = search(problems, points, lambda done, total: None)
        end = ends.u[:1], ends.weights[:1]
        held, error = look(*end), whole.sums(*end, curvature=False).error[0]
        if error > (DEAREST * max(free.max(), 1)) ** 2 * first:
            break
        if light.departure(held) <= NEARER * light.departure(free):
            kept = *end, _explain_light(light, counted, free, held)
        if light.is_right(held):
            break
        points = end[0]
    return kept


def _explain_light(light, counted, free, held):
    """The note on a fit that keeps the `light` at the `counted` angles (n,); `free`, `held`:
    albedos without and with it."""
    gains = np.log(np.maximum(free.max(axis=1), 1e-9))
    apart = np.maximum(np.abs(np.log(light.factors(free))), gains)
    row = int(np.argmax(np.where(counted, apart, -np.inf)))
    shares = (format_share(albedos[row].mean()) for albedos in (free, light.values, held))
    before, measured, after = shares
    measured = f", where the measurement reflects {measured}"
    return (
        f"{NOTE} it would reflect {before} of the light at "
        f"{light.theta_i[row]:g}°{measured * bool(light.known[row])}; with a term for its light it "
        f"reflects {after}"
    )


class LightProblem(PixelProblem):
    """E² of a model class on `Samples`, over that of a first search, and its difference in light.

    `counted`: at which angles of the `light` (n,); `error`: E² of the first search; `share`: how
    much the light counts.
    """

    def __init__(self, problem, light, counted, error, share):
        self.given = light, counted, error, share
        mean = np.maximum(light.target[counted].mean(axis=1), 1e-6)
        weights = share / (len(mean) * problem.channels) / mean**2
        of_pixels = light.pixels.at(counted), weights, DIFFERENCE
        given = problem.model, problem.samples, problem.loss, problem.space
        super().__init__(*given, 1 / error, *of_pixels)

    def on(self, samples):
        """The same problem on other `Samples`."""
        part = Problem(self.model, samples, self.loss, self.space)
        return LightProblem(part, *self.given)
