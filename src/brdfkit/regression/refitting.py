"""Repeats a fit from its end, on other samples or with a parameter fixed."""

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
from brdfkit.regression.robust.search import search_robust
from brdfkit.regression.search.albedo_search import NOTE, correct_albedo
from brdfkit.regression.search.levenberg_marquardt import levenberg_marquardt
from brdfkit.regression.search.multistart import EXACT, LARGEST_STEPS


@dataclass(frozen=True, eq=False)
class Refit:
    """A `Fit` and the `Samples` that were fitted, ready to be fitted again.

    `target_albedo`: the `TargetAlbedo` of the data, for a fit that was corrected by it.
    """

    fit: Any
    samples: Any
    target_albedo: Any = None

    def __post_init__(self) -> None:
        if self.fit.loss_name == "rendered":
            raise BrdfkitError(
                f"{self.fit.name} was found by refine, from pictures of a scene and not from "
                "samples; fit it to a measured material first."
            )
        if self.fit.loss_name not in losses.named:
            raise BrdfkitError(
                f"{self.fit.name} was fitted by a loss of your own, {self.fit.loss_name}, which a "
                "fit does not keep; fit by one of brdfkit.losses.named first."
            )
        if isinstance(to_loss(self.fit.loss_name), Picture):
            raise BrdfkitError(
                f"{self.fit.name} was fitted by pictures, whose pixels show the same samples; fit "
                "by another loss first."
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
        problem = self.make_problem()
        u = problem.space.to_coordinates(self.fit.values)[None]
        loss = math.sqrt(problem.compute_sums(u, self.weights, curvature=False).error[0])
        if not math.isclose(loss, self.fit.loss, rel_tol=1e-6, abs_tol=1e-9):
            raise BrdfkitError(
                f"{self.fit.name}: its loss is {loss:.6g} here, {self.fit.loss:.6g} in the fit; "
                "give the material that was fitted, and fit it without weights of your own."
            )

    @property
    def weights(self) -> FloatArray:
        """The weights (1, channels, lobes) of the fit."""
        channels = self.samples.values.shape[1]
        matrix = to_weight_matrix(self.fit.model)
        return np.broadcast_to(matrix, (len(matrix), channels)).T[None].copy()

    @property
    def has_corrected_albedo(self) -> bool:
        """Whether the fit was searched again for the light of its data."""
        return any(note.startswith(NOTE) for note in self.fit.notes)

    def require_least_loss(self) -> None:
        """Raise `BrdfkitError` if the fit does not minimise its loss alone."""
        if self.has_corrected_albedo:
            raise BrdfkitError(
                f"{self.fit.name} was searched again for the light of its data, and is not the "
                "least of its loss alone, as is needed here; "
                "brdfkit.uncertainty.bootstrap tells how certain it is."
            )

    def make_problem(self, **values: float) -> Problem:
        """Return the `Problem` of the fit, with some shape parameters fixed at `values`."""
        model, settings = type(self.fit.model), self.fit.settings
        bounds = {n: v for n, v in settings.get("bounds", {}).items() if n not in values}
        fixed = settings.get("fixed", {}) | values
        anisotropic = settings.get("anisotropic", False)
        space = Space.for_samples(self.samples, model, bounds, fixed, anisotropic)
        return Problem(model, self.samples, losses.named.by_sample[self.fit.loss_name], space)

    def search_from(
        self,
        problem: Problem,
        values: Mapping[str, Any],
        weights: FloatArray,
        rng: Any = None,
    ) -> tuple[dict[str, float], FloatArray, float]:
        """Search a `problem` from shape parameters `values`, by name, and `weights`.

        Return (values, weights, E²) at the end. `rng`: a generator, for robust fits and for fits
        with corrected light.
        """
        u = problem.space.to_coordinates(values)[None]
        given = problem.expand, u, weights, problem.least
        ends = levenberg_marquardt(*given, LARGEST_STEPS, EXACT).ends
        start, u, weights, error = u, ends.u, ends.weights, ends.error[0]
        if self.target_albedo is not None and self.has_corrected_albedo:
            corrected = correct_albedo(problem, u, weights, self.target_albedo, start, rng)
            if corrected is not None:
                u, weights = corrected[:2]
                error = problem.compute_sums(u, weights, curvature=False).error[0]
        if robust := self.fit.settings.get("robust"):
            u, weights, *_ = search_robust(
                problem, u, weights, robust, rng, lambda done, total: None
            )
        return problem.space.to_values(u[0]), weights, error

    def to_values(self, shapes: dict[str, Any], weights: FloatArray) -> dict[str, Any]:
        """Return all values of the model by name, from `shapes` by name and `weights`."""
        model, wavelengths = type(self.fit.model), self.fit.wavelengths
        return make_model(model, shapes, weights[0], wavelengths).values
