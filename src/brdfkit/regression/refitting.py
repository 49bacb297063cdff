"""Repeats a finished fit from its solution, on other samples or with one parameter fixed.

Bootstraps and profiles use it to find out how certain the parameters are.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.model.evaluation import make_model, to_weight_matrix
from brdfkit.regression import losses
from brdfkit.regression.losses.named_losses import to_loss
from brdfkit.regression.losses.picture import Picture
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.robust.search import search_robust_solution
from brdfkit.regression.search.albedo_search import NOTE, correct_albedo
from brdfkit.regression.search.levenberg_marquardt import levenberg_marquardt
from brdfkit.regression.search.multistart import EXACT, LARGEST_STEPS

# Start of the note on a fit to a completed table in place of the samples
BEYOND = "beyond the measured angles,"
# Start of the note on a fit to a table that `complete` made
COMPLETED = "fitted to a completed table,"


@dataclass(frozen=True, eq=False)
class Refit:
    """A finished `Fit` with the `Samples` that it was fitted to, ready for repeated searches.

    Raises `BrdfkitError` for a fit that cannot be repeated, because its settings or its samples are
    not known. `target_albedo`: the `TargetAlbedo` of the data, for a fit that was corrected by it.
    """

    fit: Any
    samples: Any
    target_albedo: Any = None

    def __post_init__(self) -> None:
        if self.fit.loss_name == "rendered":
            raise BrdfkitError(
                f"{self.fit.name} was found by refine, from pictures of a scene, not from samples; "
                "fit the model to a measured material first."
            )
        if self.fit.loss_name not in losses.named:
            raise BrdfkitError(
                f"{self.fit.name} was fitted by a loss of your own, {self.fit.loss_name}, whose "
                "formula the fit does not contain; fit by one of brdfkit.losses.named first."
            )
        if isinstance(to_loss(self.fit.loss_name), Picture):
            raise BrdfkitError(
                f"{self.fit.name} was fitted by the loss picture, whose pixels are not independent "
                "samples; fit by another loss first."
            )
        if self.samples.errors is not None:
            raise BrdfkitError(
                f"{self.fit.name} was fitted by the standard errors of the measurement, whose "
                "weights are not repeated; fit with use_standard_error=False first."
            )
        if self.fit.settings.get("constraints"):
            raise BrdfkitError(
                f"{self.fit.name} was fitted with constraints, which are not repeated; fit without "
                "them first."
            )
        for start, remedy in ((BEYOND, ""), (COMPLETED, "the measured values ")):
            if any(note.startswith(start) for note in self.fit.notes):
                raise BrdfkitError(
                    f"{self.fit.name} was fitted to a completed table, of which no cell was "
                    f'measured alone; fit {remedy}with extrapolate="free" first.'
                )
        problem = self.make_problem()
        u = problem.space.to_coordinates(self.fit.values)[None]
        loss = math.sqrt(problem.compute_sums(u, self.weights, curvature=False).error[0])
        if not math.isclose(loss, self.fit.loss, rel_tol=1e-6, abs_tol=1e-9):
            raise BrdfkitError(
                f"{self.fit.name}: the loss on this material is {loss:.6g}, but "
                f"{self.fit.loss:.6g} in the fit; give the material that was fitted, and fit it "
                "without weights of your own."
            )

    @property
    def weights(self) -> FloatArray:
        """The weights of the fitted model's lobes, (1, channels, lobes)."""
        channels = self.samples.values.shape[1]
        matrix = to_weight_matrix(self.fit.model)
        return np.broadcast_to(matrix, (len(matrix), channels)).T[None].copy()

    @property
    def has_corrected_albedo(self) -> bool:
        """Whether a second search corrected the albedo of the fit."""
        return any(note.startswith(NOTE) for note in self.fit.notes)

    def require_uncorrected_albedo(self) -> None:
        """Raise `BrdfkitError` if the fit minimises its loss and a term for the albedo together."""
        if self.has_corrected_albedo:
            raise BrdfkitError(
                f"{self.fit.name} was searched again to have the albedo of its data, so that its "
                "loss is not the least one; use brdfkit.uncertainty.bootstrap instead."
            )

    def make_problem(self, **values: float) -> Problem:
        """Return the `Problem` that the fit solved, with the given shape parameters fixed."""
        model, settings = type(self.fit.model), self.fit.settings
        bounds = {n: v for n, v in settings.get("bounds", {}).items() if n not in values}
        fixed = settings.get("fixed", {}) | values
        anisotropic = settings.get("anisotropic", False)
        space = Space.for_samples(self.samples, model, bounds, fixed, anisotropic)
        return Problem(model, self.samples, losses.named.by_sample[self.fit.loss_name], space)

    def search_from_start(
        self,
        problem: Problem,
        values: Mapping[str, Any],
        weights: FloatArray,
        rng: Any = None,
    ) -> tuple[dict[str, float], FloatArray, float]:
        """Search for the solution of a `problem`, by the same steps as the fit, from one start.

        Return the solution (values, weights, squared loss). `values`: shape parameters of the start
        by name; `weights` (1, channels, lobes): weights of its lobes; `rng`: a generator for the
        random choices of robust fits and of fits with a corrected albedo.
        """
        u = problem.space.to_coordinates(values)[None]
        given = problem.expand_loss, u, weights, problem.weight_limits
        ends = levenberg_marquardt(*given, LARGEST_STEPS, EXACT).ends
        start, u, weights, error = u, ends.u, ends.weights, ends.error[0]
        if self.target_albedo is not None and self.has_corrected_albedo:
            corrected = correct_albedo(problem, u, weights, self.target_albedo, start, rng)
            if corrected is not None:
                u, weights = corrected[:2]
                error = problem.compute_sums(u, weights, curvature=False).error[0]
        if robust := self.fit.settings.get("robust"):
            u, weights, *_ = search_robust_solution(
                problem, u, weights, robust, rng, lambda done, total: None
            )
        return problem.space.to_named_values(u[0]), weights, error

    def to_named_values(self, shapes: dict[str, Any], weights: FloatArray) -> dict[str, Any]:
        """Return all parameters of the model by name, from `shapes` by name and lobe `weights`."""
        model, wavelengths = type(self.fit.model), self.fit.wavelengths
        return make_model(model, shapes, weights[0], wavelengths).values
