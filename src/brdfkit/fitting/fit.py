"""`fit`: a model fitted to a measured material."""

import inspect
import time
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from brdfkit.core.errors import no_such
from brdfkit.core.interrupts import Interrupted
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.version import versions
from brdfkit.fitting.light_of_data import light_of_data
from brdfkit.fitting.notes import list_notes
from brdfkit.fitting.settings import require_plain, to_settings
from brdfkit.images.ball import draw_pixels
from brdfkit.materials.extrapolation import note_on_extrapolation
from brdfkit.materials.measured.selection import select_samples
from brdfkit.materials.measured.spectrum_to_rgb import wavelengths
from brdfkit.materials.resolve import MaterialLike, to_measured
from brdfkit.model import Model, labels
from brdfkit.model.evaluation import with_weights
from brdfkit.model.samples.measures import weigh, whole
from brdfkit.regression import Fit, Loss, Picture, as_loss, regress
from brdfkit.regression.measurement_noise import regress_noisy
from brdfkit.regression.solvers import AlbedoAtMost, Solver, WeightsAtMost
from brdfkit.regression.solvers.settings import to_plain

Constraint = AlbedoAtMost | WeightsAtMost | Callable[[Model], ArrayLike]


@in_turn
def fit(
    name: str | Path | type[Model],
    data: MaterialLike,
    loss: str | Loss | Picture | Callable[..., Any] = "cbrt",
    *,
    robust: str | None = None,
    weights: ArrayLike | None = None,
    use_standard_error: bool = True,
    solver: str | Solver | None = None,
    constraints: Constraint | Iterable[Constraint] | None = None,
    starts: int | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    fixed: Mapping[str, float] | None = None,
    anisotropic: bool | None = None,
    max_angle: float = 80.0,
    spectral: bool = False,
    seed: int = 0,
    progress: Callable[[int, int], object] | None = None,
) -> Fit:
    """Fit a model to a measured material.

    Unless another solver is given, a damped Gauss-Newton search (Levenberg-Marquardt) from several
    starts at once, in double precision with exact derivatives: the shape parameters, and the
    weights of every channel, which follow them. Fits of several threads run one after the other.
    Ctrl-C raises `Interrupted`, whose `best` is the best fit so far; with constraints, or before
    any point was evaluated, a plain KeyboardInterrupt.

    Parameters
    ----------
    name : str, Path or class
        The model: its label, as ``"ggx"``, ``"koenderink:order=8"`` or ``"ggx+ward"``; a file that
        defines one; or a class derived from `Model`.
    data : Measured, str or Path
        The measured material, or the name or path of one.
    loss : str, Loss, Picture or callable, default "cbrt"
        What is made small: a name in `brdfkit.losses.named`, a `Loss`, a `Picture`, or your own
        difference of a model's value from the measured one, a function (model, measured, cos_i,
        cos_o) of Dr.Jit's arrays.
    robust : str, optional
        The weight by which outliers lose their say, as ``"bisquare"`` [Kurt 2007, eq. 5.14]; the
        others are in `brdfkit.regression.robust.reweighting.WEIGHTS`. By default all samples count.
    weights : array_like, shape (n,), optional
        Factors of the samples of the measurement; of a table, of its cells, in the table's shape or
        flat. A sample counts by its factor times how much of the loss's measure of directions it
        stands for. By default all factors are 1.
    use_standard_error : bool, default True
        Whether samples count by their standard errors, where the measurement states them: those
        whose noise is more than the model's own error, less.
    solver : solver or str, optional
        What searches: `LevenbergMarquardt`, `SLSQP`, `TrustRegion` or `DifferentialEvolution`, as
        ``SLSQP(starts=4)``, its name, as ``"slsqp"``, or an object of yours with their method. By
        default `LevenbergMarquardt`, and `SLSQP` where there are constraints.
    constraints : constraint or several, optional
        What the model has to meet: `AlbedoAtMost`, `WeightsAtMost`, or functions of the model with
        its values, each of which returns one or several numbers that are not negative where it is
        met. Derivatives of functions are taken by differences.
    starts : int, optional
        Points from which the search begins: the defaults and others, spread over the bounds. By
        default 16 for each searched parameter, at most 96.
    bounds : dict of str to (float, float), optional
        Narrower bounds of shape parameters, as ``{"alpha_u": (0.01, 0.5)}``.
    fixed : dict of str to float, optional
        Shape parameters that keep a value, as ``{"f0": 0.04}``.
    anisotropic : bool, optional
        Whether ``alpha_v`` and its like are searched, too, or else follow ``alpha_u``. By default
        they are where the measurement is anisotropic.
    max_angle : float, default 80
        Samples with an angle to the normal at or beyond it [degrees, above 0 to 90] are left out.
    spectral : bool, default False
        Whether a measurement of wavelengths is fitted at these, with a weight for each, or else as
        linear sRGB. Every wavelength counts alike.
    seed : int, default 0
        Seed of the starts, and of the part of a large table by which they are compared; equal seeds
        give equal fits.
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
        or bounds and values beyond the model's; where `data` was not measured, has no wavelengths
        for a spectral fit, or no sample is left; for a formula or loss that is not finite; for
        weights or standard errors that do not fit; for a robust fit without more samples than
        parameters; and for a `Picture` with robust, weights or spectral, or of a model that may be
        negative.

    Examples
    --------
    >>> print(fit("ward", "paint.binary"))    # doctest: +SKIP
    """
    began = time.perf_counter()
    model, data = labels.model(labels.read_files(name)), to_measured(data)
    how: dict[str, Any] = {"seed": seed, "starts": starts, "bounds": bounds, "fixed": fixed}
    how |= {"solver": solver, "constraints": constraints}
    how["anisotropic"] = data.anisotropic if anisotropic is None else anisotropic
    given = {"robust": robust, "max_angle": max_angle, "use_standard_error": use_standard_error}
    checked = check_settings({**given, **how}, f"{model.type_name()}: ")
    how = {name: checked[name] for name in how}
    loss = as_loss(loss)
    samples = select_samples(data, max_angle, weights, use_standard_error, spectral)

    light = light_of_data(data if spectral else data.rgb, weights, max_angle)

    def to_fit(found):
        known = wavelengths(data) if spectral else ()
        fitted = with_weights(model, found.shapes, found.weights, known)
        albedo = light.judge(fitted.eval)
        warnings = [] if light.has_another_unit else albedo.warnings()
        return Fit(
            model=fitted,
            data=data.name,
            loss_name=loss.name,
            loss=found.loss,
            samples=len(samples.wi),
            evaluations=found.evaluations,
            seconds=time.perf_counter() - began,
            message=_add_warning(found.message) if warnings else found.message,
            at_bounds=found.at_bounds,
            certainty=found.certainty,
            notes=(
                *found.notes,
                *warnings,
                *list_notes(data, samples, loss, found, fitted, weights is not None),
                *note_on_extrapolation(data, float(max_angle)),
            ),
            albedo=albedo,
            **tell_weights(loss, samples, max_angle),
            settings={
                **given,
                **how,
                "max_angle": float(max_angle),
                "spectral": bool(spectral),
                "solver": to_plain(how["solver"]),
                "constraints": list(map(to_plain, how["constraints"])),
            },
            checksum=data.checksum,
            versions=dict(versions()),
        )

    solve = regress if samples.errors is None else regress_noisy
    if isinstance(loss, Picture):
        require_plain(robust=robust, weights=weights, spectral=spectral)
        pixels = draw_pixels(loss.lights, data.rgb.eval, max_angle, checked["seed"])
        solve = partial(regress, pixels=pixels)
    # A sum over the samples as they are is just that
    as_it_is = getattr(loss, "measure", None) == "samples" or light.has_another_unit
    kept = None if as_it_is else light
    try:
        return to_fit(
            solve(model, samples, loss, robust=robust, light=kept, **how, report=progress)
        )
    except Interrupted as stop:
        best = to_fit(stop.best)
        raise Interrupted(
            best, f"{best.name}: the best fit so far has the loss {best.loss:.6g}"
        ) from None


# The settings: all arguments but the model, the material with its weights, and the progress
SETTINGS = {
    name: parameter.default
    for name, parameter in inspect.signature(fit).parameters.items()
    if name not in ("name", "data", "weights", "progress")
}


def _add_warning(message):
    """The message of a fit whose light is wrong."""
    end, semicolon, rest = message.partition(";")
    ended = end.startswith(("converged", "settled"))
    return f"{end}, but its light is wrong{semicolon}{rest}" if ended else message


def tell_weights(loss: Loss | Picture, samples: Any, max_angle: float) -> dict[str, float]:
    """`Fit.effective_samples` and `Fit.unrepresented` of the `Samples` of a fit."""
    if isinstance(loss, Picture):
        return {}
    weights = loss.importance(samples)
    own, covered = weigh(samples.extents, loss.measure), 1.0
    if isinstance(own, np.ndarray):
        covered = float(own.sum()) / whole(float(max_angle), loss.measure)
    return {
        "effective_samples": float(weights.sum() ** 2 / (weights @ weights)),
        "unrepresented": max(1 - covered, 0.0),
    }


def check_settings(given: Mapping[str, Any], where: str = "") -> dict[str, Any]:
    """All `SETTINGS` of a fit: those `given` by name, and the others' defaults.

    Raises the `BrdfkitError` that `fit` raises for any model and any material; in it `where` stands
    before the names of bounds.

    >>> check_settings({"loss": "cbrt"})["max_angle"]
    80.0
    """
    for name in given:
        if name not in SETTINGS:
            raise no_such("setting of a fit", name, SETTINGS)
    settings = {**SETTINGS, **given}
    return to_settings(settings, where)
