"""Fits maps of a flat sample to photographs of it, and collects the result."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.interrupts import Interrupted
from brdfkit.core.progress_bar import Progress, make_step_counter
from brdfkit.inverse.photographs.arguments import choose_map_shape
from brdfkit.inverse.photographs.capture.capture import Capture, downsample
from brdfkit.inverse.photographs.capture.observations import Observations, sample_at_texels
from brdfkit.inverse.photographs.capture.unusable import leave_out_unusable
from brdfkit.inverse.photographs.maps.maps import Maps, to_error_maps
from brdfkit.inverse.photographs.maps.residuals import describe_misfit
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS, TexelParameters
from brdfkit.inverse.photographs.maps.undetermined import describe_undetermined
from brdfkit.inverse.photographs.result.comparison import Comparison
from brdfkit.inverse.photographs.result.levelling import describe_capture, describe_normals
from brdfkit.inverse.photographs.result.result import Svbrdf
from brdfkit.inverse.photographs.result.simulated_errors import simulate_standard_errors
from brdfkit.inverse.photographs.search.fitting_maps import (
    UnfinishedMaps,
    estimate_search_steps,
    fit_maps,
)
from brdfkit.inverse.photographs.search.problem import Problem
from brdfkit.inverse.photographs.search.through_renderer import (
    RenderedMaps,
    compute_psnr,
    measure_misfit,
    refine_through_renderer,
    summarise_differences,
)

INTERRUPTED = "Interrupted: these are the maps so far, without standard errors."


def fit_maps_of_sample(
    name: str,
    photographs: Capture,
    hidden: Capture | None,
    model: str,
    parameters: TexelParameters,
    resolution: int | None,
    smoothness: float | None,
    progress: Progress | None,
) -> Svbrdf:
    """Return the maps of a flat sample; `hidden` are photographs that are held out.

    The other arguments are those of `svbrdf`. On Ctrl-C `Interrupted` holds the maps so far.
    """
    began = time.perf_counter()
    shape = choose_map_shape(photographs, resolution)
    clipped = photographs.clipped.mean() if photographs.lost is None else 0.0
    photographs = downsample(photographs, shape)
    photographs, observed, left_out = leave_out_unusable(photographs, shape)
    lights = len(photographs.names)
    report = make_step_counter(progress, estimate_search_steps(lights, smoothness))
    problem = Problem(parameters, observed, report)

    def make_result(fitted: UnfinishedMaps, notes: tuple[str, ...], **known: Any) -> Svbrdf:
        """Return the `Svbrdf` of fitted maps; `known` has attributes that unfinished maps lack."""
        return Svbrdf(
            name=name,
            model=model,
            maps=Maps.from_texel_numbers(parameters, fitted.x, shape, photographs.size).maps,
            fixed=parameters.fixed,
            size=photographs.size,
            smoothness=float(fitted.tau),
            held_out=fitted.held_out,
            notes=(*notes, *left_out, *describe_capture(photographs, clipped, observed)),
            seconds=time.perf_counter() - began,
            capture=photographs,
            **known,
        )

    def make_final_result(rendered: RenderedMaps, errors: FloatArray) -> Svbrdf:
        """Return the `Svbrdf` of a finished search: maps, uncertainty, misfit and notes.

        `rendered` has the fitted maps and their renderings. `errors` (texels, numbers) are the
        standard errors of the searched numbers of each texel.
        """
        fitted, pictures = rendered.fitted, rendered.pictures
        maps = Maps.from_texel_numbers(parameters, fitted.x, shape, photographs.size).maps
        beyond = sample_at_texels(photographs, photographs.pictures - pictures, shape)
        misfit = measure_misfit(beyond, fitted.noise, observed)
        diffuse = maps.get("diffuse_reflectance", np.ones(CHANNELS))[
            ..., observed.find_lit_channels()
        ]
        differences = summarise_differences(photographs, pictures)
        is_overdetermined = CHANNELS * lights > parameters.count
        noise = fitted.noise**0.5 if is_overdetermined else 0.0
        notes = (
            *describe_undetermined(parameters, fitted.equations.hessian, lights),
            *describe_misfit(misfit, noise, differences, float(np.median(diffuse))),
            *(describe_normals(maps["normal"]) if is_overdetermined else ()),
        )
        return make_result(
            fitted,
            notes,
            uncertainty=to_error_maps(parameters, errors, fitted.x, shape),
            misfit=misfit.reshape(shape),
            held_out_errors=_compare_with_hidden(hidden, parameters, fitted.x, shape),
            **_compare_with_photographs(rendered, photographs),
        )

    fitted = rendered = None
    try:
        fitted = fit_maps(problem, smoothness)
        rendered, rounds = refine_through_renderer(problem, fitted, photographs)
        errors = simulate_standard_errors(problem, rendered, rounds, photographs)
        return make_final_result(rendered, errors)
    except KeyboardInterrupt as stop:
        best = (stop.best if isinstance(stop, Interrupted) else rendered) or fitted
        if best is None:
            raise
        if isinstance(best, RenderedMaps):
            known = _compare_with_photographs(best, photographs)
            result = make_result(best.fitted, (INTERRUPTED,), **known)
        else:
            result = make_result(best, (INTERRUPTED,))
        raise Interrupted(result, f"{name}: there are maps so far") from None


def _compare_with_photographs(rendered: RenderedMaps, capture: Capture) -> dict[str, Any]:
    """Return the attributes of an `Svbrdf` that compare renderings with the photographs."""
    psnr = compute_psnr(capture, rendered.pictures)
    return {"residual": rendered.difference, "predicted": psnr, "rendered": rendered.pictures}


def _compare_with_hidden(
    hidden: Capture | None, parameters: TexelParameters, x: FloatArray, shape: tuple[int, int]
) -> Comparison | None:
    """Return how far the maps' radiances are from photographs that were held out.

    `x` (texels, numbers) are the searched numbers of the texels of maps of this shape.
    """
    if hidden is None:
        return None
    observed = Observations.collect(downsample(hidden, shape), shape)
    predicted = parameters.compute_radiances(x, observed)
    counts = (observed.weights > 0).all(axis=2) & (observed.radiance.mean(axis=2) > 0)
    parts = zip(hidden.names, predicted, observed.radiance, counts, strict=True)
    return Comparison.collect({name: (p[own], values[own]) for name, p, values, own in parts})
