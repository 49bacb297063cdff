"""Searches for a fit that stays, beyond the measured angles, near a completed table."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from brdfkit.core.progress_bar import Progress
from brdfkit.fitting.guard import Brdf, Guard, compute_logarithm
from brdfkit.fitting.settings import FitSettings
from brdfkit.fitting.target_albedo import find_target_albedo
from brdfkit.images.ball import draw_pixels
from brdfkit.materials.completion.noise import DEFAULT_NOISE
from brdfkit.materials.extrapolation import note_fit_extrapolation
from brdfkit.materials.measured import Measured
from brdfkit.model import Model
from brdfkit.model.evaluation import mix_lobes
from brdfkit.model.samples import Samples
from brdfkit.regression import Loss, Picture, regress
from brdfkit.regression.albedo import (
    LARGEST_ALBEDO,
    format_light_share,
)
from brdfkit.regression.losses.loss import sum_squared_differences
from brdfkit.regression.refitting import BEYOND
from brdfkit.regression.regression import Solution
from brdfkit.regression.search.albedo_search import NOTE
from brdfkit.regression.solvers import AlbedoAtMost

# Angles of incidence [degrees] at which a guarded fit reflects at most all light
ANGLES = (0.0, 30.0, 60.0, 75.0, 80.0, 85.0, 89.0)
# A fit whose largest albedo is at most this, and that does not leave the table otherwise, is scaled
# down to 1
LARGEST_SCALED = 1.1


@dataclass(frozen=True, eq=False)
class GuardedSearch:
    """The search for a fit: free, and where needed again on the cells of a completed table.

    `model`, `samples`, `loss`: what is fitted, by which loss. `guard`: the table, or None.
    `find_largest_albedo`: a function from a BRDF to the angle of incidence [degrees] at which its
    albedo is largest, and this albedo. `settings`: the arguments of `fit`; `arguments`: those of
    `regress` that follow from them.
    """

    model: type[Model]
    samples: Samples
    loss: Loss | Picture
    guard: Guard | None
    find_largest_albedo: Callable[[Brdf], tuple[float, float]]
    settings: FitSettings
    arguments: dict[str, Any]

    def guard_solution(self, free: Solution, report: Progress | None) -> Solution:
        """Return the solution `free` on the samples, or another one if it reflects too much light.

        `report` is called with the steps done, and the number of all steps.
        """
        if self.guard is None:
            return free
        excess = self.guard.find_excess(self._make_brdf(free))
        angle, most = self.find_largest_albedo(self._make_brdf(free))
        if most <= LARGEST_ALBEDO and (excess is None or self._meets_samples(free)):
            return free
        if excess is None and most <= LARGEST_SCALED:
            scaled = replace(free, weights=free.weights / most)
            note = (
                f"{_begin_note(self.guard)} is scaled by {1 / most:.3g}: "
                f"{_describe_free_fit(most, angle)}, more than arrives"
            )
            return replace(scaled, loss=self._compute_loss(scaled), notes=(*free.notes, note))
        found = self._search_on_table(self.guard, (), report)
        if self.find_largest_albedo(self._make_brdf(found))[1] > LARGEST_ALBEDO:
            found = self._limit_albedo(self.guard, found, report)
        own, against = most, "more than arrives"
        if excess is not None and most <= LARGEST_ALBEDO:
            if not self.guard.is_nearer(*map(self._make_brdf, (found, free))):
                return free
            angle, own, known = excess
            against = f"where the table reflects {format_light_share(known)}"
        note = (
            f"{_begin_note(self.guard)} follows {self.guard.describe_table()}: "
            f"{_describe_free_fit(own, angle)}, {against}"
        )
        return replace(
            found,
            loss=self._compute_loss(found),
            evaluations=free.evaluations + found.evaluations,
            notes=(*(said for said in found.notes if not said.startswith(NOTE)), note),
            certainty=found.certainty.without_standard_errors(self.samples.values.size),
        )

    def _limit_albedo(self, guard: Guard, found: Solution, report: Progress | None) -> Solution:
        """Return a solution like `found`, which reflects too much light, that reflects less.

        It is found with a limit of the albedo at all angles. Models such as Ward's keep that limit
        at 89° only if they lose much light everywhere. So if the solution `found` is clearly nearer
        to the table, scaled down to the limit up to 85°, that is returned.
        """
        limited = self._search_on_table(guard, (AlbedoAtMost(1.0, ANGLES),), report)
        excess = np.maximum(guard.compute_largest_albedos(self._make_brdf(found)), 1)
        scaled = replace(found, weights=found.weights / excess[:, None])
        nearer = guard.is_nearer(*map(self._make_brdf, (scaled, limited)))
        return scaled if nearer else limited

    def _search_on_table(
        self, guard: Guard, limits: tuple[Any, ...], report: Progress | None
    ) -> Solution:
        """Return the solution on the cells of the table, with further constraints."""
        target = find_target_albedo(guard.completed, None, guard.max_angle)
        changes: dict[str, Any] = {}
        if self.arguments["target_albedo"] is not None:
            changes["target_albedo"] = target
        if limits and self.settings.solver is None:
            changes["constraints"] = (*self.settings.constraints, *limits)
        if isinstance(self.loss, Picture):
            brdf, seed = guard.completed.eval, self.settings.seed
            changes["pixels"] = draw_pixels(self.loss.lights, brdf, guard.max_angle, seed)
        arguments = self.arguments | changes
        return regress(self.model, guard.samples, self.loss, **arguments, report=report)

    def _make_brdf(self, solution: Solution) -> Brdf:
        """Return the BRDF of a solution, a function of directions wi and wo (n, 3)."""
        model = self.model(**solution.shapes)
        return lambda wi, wo: mix_lobes(model, solution.weights.T, wi, wo)

    def _meets_samples(self, solution: Solution) -> bool:
        """Return whether a solution meets the samples to within the noise of an instrument."""
        pairs = self.samples.wi, self.samples.wo
        values = solution.eval(self.model, self.samples), self.samples.values
        own, measured = (compute_logarithm(f, *pairs) for f in values)
        squares = (own - measured) ** 2
        return bool(np.sqrt(squares.mean()) < DEFAULT_NOISE)

    def _compute_loss(self, solution: Solution) -> float:
        """Return the loss at the measured samples; a loss of pictures is that of the table."""
        if isinstance(self.loss, Picture):
            return solution.loss
        values = solution.eval(self.model, self.samples)
        importance = self.loss.importance(self.samples)
        squares = sum_squared_differences(self.loss, values, self.samples)
        return float(np.sqrt(importance @ squares))


def _begin_note(guard: Guard) -> str:
    """Return the begin of a note on a guarded fit."""
    return f"{BEYOND} which reach {guard.reach}, the fit"


def _describe_free_fit(albedo: float, angle: float) -> str:
    """Return how much light a fit of the samples alone would reflect at an angle [degrees]."""
    light = f"{format_light_share(albedo)} of the light at {angle:g}°"
    return f'by the samples alone (extrapolate="free") it would reflect {light}'


def explain_unguarded_fit(settings: FitSettings, weights: object) -> str:
    """Return why a fit is not guarded, as a clause, or "" if it may be."""
    reasons = {
        "robust weights tell outliers from the samples alone": settings.robust is not None,
        "the table has no wavelengths": settings.spectral,
        "weights of samples do not apply to a table": weights is not None,
        "the table is isotropic": bool(settings.anisotropic),
    }
    return next((reason for reason, applies in reasons.items() if applies), "")


def note_beyond(
    data: Measured,
    max_angle: float,
    guard: Guard | None,
    solution: Solution,
    brdf: Brdf,
    unguarded: str,
) -> list[str]:
    """Return a list with a sentence on the fit beyond the measured angles, or an empty list.

    `brdf`: the BRDF of the fit. `unguarded`: why it is not guarded, as a clause, or "".
    """
    sentences = note_fit_extrapolation(data, max_angle)
    if not sentences or any(note.startswith(BEYOND) for note in solution.notes):
        return []
    (sentence,) = sentences
    if guard is None:
        return [f"{sentence}; it is not guarded, because {unguarded}" if unguarded else sentence]
    excess = guard.find_excess(brdf)
    if excess is None:
        kept = f"and reflects not much more light than {guard.describe_table()}"
        return [sentence.replace("and nothing tests it", kept)]
    own, known = map(format_light_share, excess[1:])
    return [
        f"{sentence}; at {excess[0]:g}° it reflects {own} of the light, and "
        f"{guard.describe_table()} {known}"
    ]
