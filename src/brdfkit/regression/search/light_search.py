"""Corrects the light that a fit reflects: a second search has a term for its albedos.

A loss compares single values. A model that cannot meet all of them may reflect far too much or too
little light in total, for instance if grazing angles are missing, a highlight falls between the
samples, or the material has retro-reflection. The second search minimises

    E² / E₀² + share · mean over θ_i and channels of ((a - a*) / ā*)²,

where a is the model's albedo, a* the data's at the angle of incidence θ_i, ā* its mean over the
channels, and E₀ the error of the first search. A fit with correct albedos is not changed.
"""

from __future__ import annotations

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.model.evaluation import mix_lobes
from brdfkit.model.samples import Samples
from brdfkit.regression.light import Light, format_share
from brdfkit.regression.losses.loss import Loss
from brdfkit.regression.problem.pixel_problem import PixelProblem
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.search.levenberg_marquardt import ROUNDING
from brdfkit.regression.search.multistart import add_parts, search_from_starts

# Factors of the term for the light, tried one after the other
SHARES = 10.0, 40.0, 160.0
# The second end is accepted if the logarithm of the factor between the albedos falls to this share,
# and if E grows at most by this factor (times the first end's albedo, if that is above 1)
DEPARTURE_SHARE, LARGEST_LOSS_RATIO = 0.6, 1.4

# The start of the note on a fit with corrected light
NOTE = "by the loss alone"

DIFFERENCE = Loss(
    "light",
    "difference of albedos",
    lambda model, measured, cos_i, cos_o: model - measured,
    measure="samples",
)


def correct_light(
    whole: Problem,
    u: FloatArray,
    weights: FloatArray,
    light: Light,
    points: FloatArray,
    rng: np.random.Generator,
) -> tuple[FloatArray, FloatArray, str] | None:
    """Search again if a fit reflects other light than its data; return (u, weights, note).

    None stands for a fit with correct light, or a model that cannot have it. `whole`: the
    `Problem`; `u`, `weights`: the end of the first search; `light`: the `Light` of the data;
    `points` (count, shapes): further start points; `rng`: a generator for parts of many samples.
    """

    def look(u: FloatArray, weights: FloatArray) -> FloatArray:
        model = whole.model(**whole.space.values(u[0]))
        return light.look(lambda wi, wo: mix_lobes(model, weights[0].T, wi, wo))

    free = look(u, weights)
    if light.is_right(free):
        return None
    wrong = light.find_wrong_angles(free)
    first = max(whole.sums(u, weights, curvature=False).error[0], ROUNDING * whole.black.sum())
    parts, points, accepted = add_parts(whole, rng), np.concatenate([u, points]), None
    for share in SHARES:
        problems = [LightProblem(part, light, wrong, first, share) for part in parts]
        ends, *_ = search_from_starts(problems, points, lambda done, total: None)
        end = ends.u[:1], ends.weights[:1]
        corrected, error = look(*end), whole.sums(*end, curvature=False).error[0]
        if error > (LARGEST_LOSS_RATIO * max(free.max(), 1)) ** 2 * first:
            break
        if light.departure(corrected) <= DEPARTURE_SHARE * light.departure(free):
            accepted = *end, _explain_light(light, wrong, free, corrected)
        if light.is_right(corrected):
            break
        points = end[0]
    return accepted


def _explain_light(light: Light, wrong: BoolArray, free: FloatArray, corrected: FloatArray) -> str:
    """Return the note on a fit with corrected light.

    `wrong` (n,): at which angles the albedos were wrong; `free`, `corrected` (n, channels): albedos
    without and with the term for the light.
    """
    gains = np.log(np.maximum(free.max(axis=1), 1e-9))
    logs = np.maximum(np.abs(np.log(light.factors(free))), gains)
    row = int(np.argmax(np.where(wrong, logs, -np.inf)))
    shares = (format_share(albedos[row].mean()) for albedos in (free, light.values, corrected))
    before, measured, after = shares
    measured = f", where the measurement reflects {measured}"
    return (
        f"{NOTE} it would reflect {before} of the light at "
        f"{light.theta_i[row]:g}°{measured * bool(light.known[row])}; with a term for its light it "
        f"reflects {after}"
    )


class LightProblem(PixelProblem):
    """E² of a model on `Samples` over E² of a first search, plus a term for the albedos.

    `wrong` (n,): the angles of the `light` that have the term; `error`: E² of the first search;
    `share`: the factor of the term.
    """

    def __init__(
        self, problem: Problem, light: Light, wrong: BoolArray, error: float, share: float
    ) -> None:
        self.light_settings = light, wrong, error, share
        mean = np.maximum(light.target[wrong].mean(axis=1), 1e-6)
        weights = share / (len(mean) * problem.channels) / mean**2
        super().__init__(
            *(problem.model, problem.samples, problem.loss, problem.space, 1 / error),
            *(light.pixels.at(wrong), weights, DIFFERENCE),
        )

    def with_samples(self, samples: Samples) -> LightProblem:
        """Return the same problem on other `Samples`."""
        part = Problem(self.model, samples, self.loss, self.space)
        return LightProblem(part, *self.light_settings)
