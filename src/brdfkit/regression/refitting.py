"""Fits again from the end of a `Fit`: its problem, on other samples or with a parameter held."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.model.evaluation import make_model, to_weight_matrix
from brdfkit.regression import losses
from brdfkit.regression.losses.named_losses import as_loss
from brdfkit.regression.losses.picture import Picture
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.robust.search import settle
from brdfkit.regression.search.levenberg_marquardt import levenberg_marquardt
from brdfkit.regression.search.light_search import NOTE, keep_light
from brdfkit.regression.search.multistart import EXACT, MOST_STEPS


@dataclass(frozen=True, eq=False)
class Refit:
    """A `Fit` and the `Samples` that were fitted, ready to be fitted again; `light`: the `Light` of
    the data, which a fit keeps again that has kept it."""

    fit: Any
    samples: Any
    light: Any = None

    def __post_init__(self):
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
        if isinstance(as_loss(self.fit.loss_name), Picture):
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
        problem = self.problem()
        u = problem.space.coordinates(self.fit.values)[None]
        loss = math.sqrt(problem.sums(u, self.weights, curvature=False).error[0])
        if not math.isclose(loss, self.fit.loss, rel_tol=1e-6, abs_tol=1e-9):
            raise BrdfkitError(
                f"{self.fit.name}: its loss is {loss:.6g} here, {self.fit.loss:.6g} in the fit; "
                "give the material that was fitted, and fit it without weights of your own."
            )

    @property
    def weights(self):
        """The weights (1, channels, lobes) of the fit."""
        channels = self.samples.values.shape[1]
        matrix = to_weight_matrix(self.fit.model)
        return np.broadcast_to(matrix, (len(matrix), channels)).T[None].copy()

    @property
    def keeps_light(self):
        """Whether the fit was searched again for the light of its data."""
        return any(note.startswith(NOTE) for note in self.fit.notes)

    def require_least(self):
        """Raise `BrdfkitError` where the fit is not the least of its loss."""
        if self.keeps_light:
            raise BrdfkitError(
                f"{self.fit.name} was searched again for the light of its data, and is not the "
                "least of its loss alone, as is needed here; "
                "brdfkit.uncertainty.bootstrap tells how certain it is."
            )

    def problem(self, **held):
        """The `Problem` of the fit, with parameters `held` at values, by name."""
        model, settings = type(self.fit.model), self.fit.settings
        bounds = {n: v for n, v in settings.get("bounds", {}).items() if n not in held}
        fixed = settings.get("fixed", {}) | held
        anisotropic = settings.get("anisotropic", False)
        space = Space.on(self.samples, model, bounds, fixed, anisotropic)
        return Problem(model, self.samples, as_loss(self.fit.loss_name), space)

    def descend(self, problem, values, weights, rng=None):
        """(values, weights, E²) of the end that a `problem` has near shape parameters `values`, by
        name, and `weights`; of a robust fit by passes, for which `rng` is a generator."""
        u = problem.space.coordinates(values)[None]
        given = problem.expand, u, weights, problem.least
        ends = levenberg_marquardt(*given, MOST_STEPS, EXACT).ends
        start, u, weights, error = u, ends.u, ends.weights, ends.error[0]
        if self.light is not None and self.keeps_light:
            kept = keep_light(problem, u, weights, self.light, start, rng)
            if kept is not None:
                u, weights = kept[:2]
                error = problem.sums(u, weights, curvature=False).error[0]
        if robust := self.fit.settings.get("robust"):
            u, weights, *_ = settle(problem, u, weights, robust, rng, lambda done, total: None)
        return problem.space.values(u[0]), weights, error

    def values(self, shapes, weights):
        """All values of the model by name, of `shapes` by name and `weights`."""
        model, wavelengths = type(self.fit.model), self.fit.wavelengths
        return make_model(model, shapes, weights[0], wavelengths).values
