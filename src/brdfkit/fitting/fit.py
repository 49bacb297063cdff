"""`fit`: fits a BRDF model to a measured material."""

from __future__ import annotations

import time
from collections.abc import Mapping
from functools import partial
from typing import Any

from brdfkit.core.array_types import ArrayLike
from brdfkit.core.interrupts import Interrupted
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress
from brdfkit.core.version import find_versions
from brdfkit.fitting.growth import note_growth
from brdfkit.fitting.guard import Guard
from brdfkit.fitting.guarded_search import (
    GuardedSearch,
    explain_unguarded_fit,
    note_beyond,
)
from brdfkit.fitting.notes import find_certainty, list_fit_notes, measure_sample_coverage
from brdfkit.fitting.settings import (
    Bounds,
    Constraints,
    FitSettings,
    LossLike,
    ModelLike,
    require_material_first,
    require_no_sample_settings,
)
from brdfkit.fitting.target_albedo import find_target_albedo
from brdfkit.images.ball import draw_pixels
from brdfkit.materials.measured.selection import select_samples
from brdfkit.materials.measured.spectrum_to_rgb import wavelengths
from brdfkit.materials.resolve import MaterialLike, to_measured
from brdfkit.model import labels
from brdfkit.model.evaluation import make_model
from brdfkit.regression import Fit, Picture, regress, to_loss
from brdfkit.regression.measurement_noise import regress_with_noise
from brdfkit.regression.solvers import Solver


@in_turn
def fit(
    material: MaterialLike,
    model: ModelLike,
    *,
    loss: LossLike = "cbrt",
    weights: ArrayLike | None = None,
    use_standard_error: bool = True,
    robust: str | None = None,
    solver: str | Solver | None = None,
    constraints: Constraints | None = None,
    starts: int | None = None,
    bounds: Bounds | None = None,
    fixed: Mapping[str, float] | None = None,
    anisotropic: bool | None = None,
    max_angle: float = 80.0,
    spectral: bool = False,
    extrapolate: str = "guarded",
    seed: int = 0,
    progress: Progress | None = None,
) -> Fit:
    """Fit a BRDF model to a measured material.

    The default solver is a damped Gauss-Newton search (Levenberg-Marquardt) from several starts,
    with exact derivatives in double precision. It searches the shape parameters; the best weights
    of the lobes in every channel follow from these. Fits in several threads run one after the
    other. Ctrl-C raises `Interrupted`, whose attribute `best` is the best fit so far; with
    constraints, and before the first evaluation, it raises a plain KeyboardInterrupt.

    Parameters
    ----------
    material : Measured, str or Path
        The measured material, or its name or path.
    model : str, Path or class
        The model: a label such as ``"ggx"``, ``"koenderink:order=8"`` or the sum ``"ggx+ward"``; a
        Python file that defines a model; or a class derived from `Model`.
    loss : str, Loss, Picture or callable, default "cbrt"
        The error to minimise: a name in `brdfkit.losses.named`, a `Loss`, a `Picture`, or a
        function (model, measured, cos_i, cos_o) of Dr.Jit arrays that returns the difference of a
        model value from a measured one.
    weights : array_like, shape (n,), optional
        Weights of the samples, or of the cells of a table in the table's shape or flat. Each is
        multiplied by the share of directions that the loss assigns to the sample. By default all
        are 1.
    use_standard_error : bool, default True
        Whether samples whose stated standard error exceeds the model's own error count less, and
        cells of a completed table the less, the less certain they are. It has no effect on
        measurements without standard errors.
    robust : str, optional
        Weight function that reduces the influence of outliers, such as ``"bisquare"`` [Kurt 2007,
        eq. 5.14]; `brdfkit.regression.robust.reweighting.WEIGHTS` lists them. By default all
        samples count.
    solver : solver or str, optional
        The optimiser: one of `brdfkit.solvers`, as ``SLSQP(starts=4)``, its name, as ``"slsqp"``,
        or an object of your own with the same method. By default `LevenbergMarquardt`, or `SLSQP`
        where there are constraints.
    constraints : constraint or several, optional
        Conditions on the model: `AlbedoAtMost`, `WeightsAtMost`, or functions that receive the
        model with its values and return one number or several, which are negative where the
        condition is violated. Functions are differentiated by finite differences.
    starts : int, optional
        Number of points from which the search starts: the first has the default values, and the
        others are spread over the bounds. By default 16 for each searched parameter, at most 96.
    bounds : dict of str to (float, float), optional
        Narrower bounds of shape parameters, as ``{"alpha_u": (0.01, 0.5)}``.
    fixed : dict of str to float, optional
        Values of shape parameters that are not searched, as ``{"f0": 0.04}``.
    anisotropic : bool, optional
        Whether ``alpha_v`` and similar parameters are searched; otherwise they follow
        ``alpha_u``. By default they are searched where the measurement is anisotropic.
    max_angle : float, default 80
        Largest angle to the normal [degrees, above 0 to 90]; samples at or beyond it are left out.
    spectral : bool, default False
        Whether to fit at the measured wavelengths, with a weight for each, instead of in linear
        sRGB. All wavelengths count alike.
    extrapolate : {"guarded", "free"}, default "guarded"
        What a fit does where much lies beyond the measured angles. The albedo of a guarded one is
        compared with that of `complete`'s table; if it is much larger, or above 1, the model is
        fitted to the table instead, and has no standard errors.
        ``Fit.loss`` is that of the measured samples in any case, and a note says what was done. A
        free one follows the samples alone. Only isotropic fits in linear sRGB, without `robust` and
        `weights`, are guarded.
    seed : int, default 0
        Seed of the starts, and of the part of a large table on which they are compared; equal
        seeds give equal fits.
    progress : callable, optional
        Called with (steps done, steps in all).

    Returns
    -------
    Fit
        The model with its values; prints as a table.

    Raises
    ------
    BrdfkitError
        For an unknown model, loss, robust weight or solver; for constraints that the solver or a
        robust fit does not take, or that no parameters meet; for a parameter that is not searched,
        or bounds and values beyond the model's; where `material` was not measured, has no
        wavelengths for a spectral fit, or no sample is left; for a formula or loss that is not
        finite; for weights or standard errors that do not fit; for a robust fit without more
        samples than parameters; and for a `Picture` with robust, weights or spectral, or of a model
        that may be negative.

    Examples
    --------
    >>> print(fit("paint.binary", "ward"))    # doctest: +SKIP
    """
    began = time.perf_counter()
    require_material_first("fit(material, model)", material)
    model_class, data = labels.model(labels.load_files_in_label(model)), to_measured(material)
    settings = FitSettings(
        loss=loss,
        robust=robust,
        use_standard_error=use_standard_error,
        solver=solver,
        constraints=constraints,
        starts=starts,
        bounds=bounds,
        fixed=fixed,
        anisotropic=data.anisotropic if anisotropic is None else anisotropic,
        max_angle=max_angle,
        spectral=spectral,
        extrapolate=extrapolate,
        seed=seed,
    ).check_and_convert(f"{model_class.type_name()}: ")
    error = to_loss(loss)
    samples = select_samples(data, max_angle, weights, use_standard_error, spectral)

    target = find_target_albedo(data if spectral else data.rgb, weights, max_angle)
    unguarded = explain_unguarded_fit(settings, weights)
    guard = None
    if settings.extrapolate == "guarded" and not unguarded:
        guard = Guard.for_fit(data, float(max_angle))

    def make_fit(solution: Any) -> Fit:
        """Return the `Fit` of a `Solution`, with its albedo, notes and warnings."""
        known = wavelengths(data) if spectral else ()
        fitted = make_model(model_class, solution.shapes, solution.weights, known)
        albedo = target.compare_with_fit(fitted.eval)
        warnings = [] if target.has_another_unit else albedo.warnings()
        return Fit(
            model=fitted,
            data=data.name,
            loss_name=error.name,
            loss=solution.loss,
            samples=len(samples.wi),
            evaluations=solution.evaluations,
            seconds=time.perf_counter() - began,
            message=_add_albedo_warning(solution.message) if warnings else solution.message,
            at_bounds=solution.at_bounds,
            certainty=find_certainty(data, samples, solution),
            notes=(
                *solution.notes,
                *warnings,
                *list_fit_notes(data, samples, error, solution, fitted, weights is not None),
                *note_beyond(data, float(max_angle), guard, solution, fitted.eval, unguarded),
                *note_growth(data, samples, fitted.eval, float(max_angle)),
            ),
            albedo=albedo,
            **measure_sample_coverage(error, samples, max_angle),
            settings=settings.to_record(),
            checksum=data.checksum,
            versions=dict(find_versions()),
        )

    solve = regress if samples.errors is None else regress_with_noise
    if isinstance(error, Picture):
        require_no_sample_settings(robust=robust, weights=weights, spectral=spectral)
        pixels = draw_pixels(error.lights, data.rgb.eval, max_angle, settings.seed)
        solve = partial(regress, pixels=pixels)
    # The measured albedo is not kept if its unit is unknown, nor if the loss weighs all samples
    # alike, because it then does not know their solid angles
    without_albedo = getattr(error, "measure", None) == "samples" or target.has_another_unit
    search: dict[str, Any] = settings.to_search_arguments() | {
        "target_albedo": None if without_albedo else target
    }

    guarded = GuardedSearch(
        model_class, samples, error, guard, target.find_largest_albedo, settings, search
    )
    try:
        free = solve(model_class, samples, error, **search, report=progress)
        return make_fit(guarded.guard_solution(free, progress))
    except Interrupted as stop:
        best = make_fit(stop.best)
        raise Interrupted(
            best, f"{best.name}: the best fit so far has the loss {best.loss:.6g}"
        ) from None


def _add_albedo_warning(message: str) -> str:
    """Add the warning that the fit's albedo is wrong to the message of a converged search."""
    end, semicolon, details = message.partition(";")
    converged = end.startswith(("converged", "settled"))
    return f"{end}, but its light is wrong{semicolon}{details}" if converged else message
