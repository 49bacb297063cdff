"""The public function `svbrdf`, which fits maps of a flat sample to photographs of it."""

from __future__ import annotations

import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.interrupts import Interrupted
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress, make_step_counter
from brdfkit.inverse.photographs.arguments import (
    check_variant,
    choose_map_shape,
    to_capture,
    to_smoothness,
    to_texel_parameters,
)
from brdfkit.inverse.photographs.capture.capture import Capture, downsample
from brdfkit.inverse.photographs.capture.observations import Observations, sample_at_texels
from brdfkit.inverse.photographs.maps.maps import Maps, to_error_maps
from brdfkit.inverse.photographs.maps.residuals import describe_misfit
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS
from brdfkit.inverse.photographs.maps.undetermined import describe_undetermined
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


@in_turn
def svbrdf(
    capture: str | Path | Capture,
    model: str = "ggx",
    *,
    resolution: int | None = None,
    anisotropic: bool = False,
    fixed: Mapping[str, float] | None = None,
    smoothness: float | None = None,
    accept_8_bit: bool = False,
    progress: Progress | None = None,
) -> Svbrdf:
    """Fit maps of a model's parameters and of the normal to photographs of a flat sample.

    Gauss-Newton steps fit maps of a few large texels first, then ever finer ones. Neighbouring
    texels are drawn to each other, so strongly that photographs held out are predicted best. Then
    Mitsuba renders the photographs of the maps, and the maps are corrected by the differences until
    only noise is left. The fit assumes direct light alone, because a flat sample throws hardly any
    light on itself. Ctrl-C raises `Interrupted`, whose ``best`` has the finest maps so far, without
    standard errors. Equal photographs give equal maps up to rounding, about 1e-8, because Mitsuba
    adds light up in any order.

    Parameters
    ----------
    capture : path or Capture
        A folder with linear photographs and the file ``capture.toml``, which says where the camera
        and the lights are; or the content of such a folder.
    model : str, default "ggx"
        Label of the model, with a shape parameter ``alpha_u`` or others.
    resolution : int, optional
        Texels along the longer side of the maps, at least 4. By default a texel is a square as
        large as a pixel in the middle, and there are at most 512.
    anisotropic : bool, default False
        Whether to fit maps of ``alpha_v`` and its like, and of ``anisotropy_angle``, the direction
        of ``alpha_u`` [radians, counterclockwise from the sample's x].
    fixed : dict of str to float, optional
        Shape parameters with one value everywhere, as ``{"f0": 0.04}``. By default ``f0`` has the
        model's default: few lights do not tell it from the specular reflectance.
    smoothness : float, optional
        The typical difference of neighbouring texels, at least 0.003: less is smoother. By default
        photographs that are held out choose it; with fewer than 8 lights it is 0.1.
    accept_8_bit : bool, default False
        Whether to accept photographs of 8 bits, and to invert the sRGB curve that they contain.
    progress : callable, optional
        Called with (done, total); see `brdfkit.progress`.

    Returns
    -------
    Svbrdf
        The maps with their uncertainty; prints as a table, and `write` makes files of it.

    Raises
    ------
    BrdfkitError
        For a folder, a file or photographs that are wrong, a model whose weights may be negative,
        unknown parameters, and a variant of Mitsuba without RGB.

    Examples
    --------
    >>> maps = svbrdf("photographs/paper")    # doctest: +SKIP
    """
    began = time.perf_counter()
    check_variant()
    name, photographs = to_capture(capture, accept_8_bit)
    parameters = to_texel_parameters(model, anisotropic, fixed)
    smoothness = to_smoothness(smoothness)
    shape = choose_map_shape(photographs, resolution)
    clipped = photographs.clipped.mean() if photographs.lost is None else 0.0
    photographs = downsample(photographs, shape)
    observed = Observations.collect(photographs, shape)
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
            notes=(*notes, *describe_capture(photographs, clipped, observed)),
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
