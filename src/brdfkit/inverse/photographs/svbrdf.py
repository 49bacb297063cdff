"""`svbrdf`: maps of a flat sample, from photographs under known lights."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np

from brdfkit.core.interrupts import Interrupted
from brdfkit.core.jit.threads import in_turn
from brdfkit.inverse.photographs.arguments import (
    require_variant,
    to_capture,
    to_numbers,
    to_shape,
    to_smoothness,
)
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.checks import require_shown
from brdfkit.inverse.photographs.capture.downsampling import shrunk
from brdfkit.inverse.photographs.capture.observations import Observations, gathered, shown_colours
from brdfkit.inverse.photographs.maps.maps import Maps, errors_of
from brdfkit.inverse.photographs.maps.residuals import describe_misfit
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS
from brdfkit.inverse.photographs.maps.undetermined import describe_open
from brdfkit.inverse.photographs.result.levelling import describe_capture, describe_normals
from brdfkit.inverse.photographs.result.result import Svbrdf
from brdfkit.inverse.photographs.result.simulated_errors import simulated_errors
from brdfkit.inverse.photographs.search.fitting_maps import fit_maps, usual_total
from brdfkit.inverse.photographs.search.through_renderer import (
    Rendered,
    compute_psnr,
    left_of,
    misfits_of,
    refine_through_renderer,
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
    progress: Callable[[int, int], object] | None = None,
) -> Svbrdf:
    """Fit maps of a model's parameters and of the normal to photographs of a flat sample.

    First the photographs of large parts of the sample, then of ever smaller ones, at last of each
    texel, by Gauss-Newton steps for all at once. Neighbouring texels are drawn to each other, as
    strongly as lights that were held out are predicted best. Then Mitsuba renders the photographs
    of the maps, and what the real ones show beyond is fitted, until only noise is left. Direct
    light alone is fitted: a flat sample throws hardly any light on itself. Ctrl-C raises
    `Interrupted`, whose ``best`` has the finest maps so far, without standard errors. Equal
    photographs give equal maps but for rounding, about 1e-8, since Mitsuba adds light up in any
    order.

    Parameters
    ----------
    capture : path or Capture
        A folder with linear photographs and the file ``capture.toml``, which says where the camera
        and the lights are; or what such a folder holds.
    model : str, default "ggx"
        Label of the model, with a shape parameter ``alpha_u`` or others.
    resolution : int, optional
        Texels along the longer side of the maps, at least 4. By default a texel is a square as
        large as a pixel in the middle, and there are at most 512.
    anisotropic : bool, default False
        Whether ``alpha_v`` and its like have maps of their own, and ``anisotropy_angle`` one: the
        direction of ``alpha_u`` [radians, counterclockwise from the sample's x].
    fixed : dict of str to float, optional
        Shape parameters that are alike everywhere, as ``{"f0": 0.04}``. By default ``f0`` is, at
        the model's default: from few lights it cannot be told from the specular reflectance.
    smoothness : float, optional
        By how much neighbouring texels may differ, from 0.003 on: less is smoother. By default
        chosen by lights that are held out; with fewer than 8 lights 0.1.
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
        For a folder, a file or photographs that are wrong, a model with weights of its lobes that
        may be negative, parameters that are none, and a variant of Mitsuba's without RGB.

    Examples
    --------
    >>> maps = svbrdf("photographs/paper")    # doctest: +SKIP
    """
    began = time.perf_counter()
    require_variant()
    name, taken = to_capture(capture, accept_8_bit)
    numbers = to_numbers(model, anisotropic, fixed)
    smoothness = to_smoothness(smoothness)
    shape = to_shape(taken, resolution)
    clipped = taken.clipped.mean() if taken.lost is None else 0.0
    taken = shrunk(taken, shape)
    seen = Observations.of(taken, shape)
    require_shown(taken, seen)
    report = _counter(progress, usual_total(len(taken.names), smoothness))

    def outcome(fitted, *notes, **known):
        return Svbrdf(
            name=name,
            model=model,
            maps=Maps.of(numbers, fitted.x, shape, taken.size).maps,
            fixed=numbers.fixed,
            size=taken.size,
            smoothness=float(fitted.tau),
            held_out=fitted.errors,
            notes=(*notes, *describe_capture(taken, clipped, seen)),
            seconds=time.perf_counter() - began,
            capture=taken,
            **known,
        )

    def conclude(best, errors):
        fitted = best.fitted
        maps = Maps.of(numbers, fitted.x, shape, taken.size).maps
        beyond = gathered(taken, taken.pictures - best.pictures, shape)
        misfit = misfits_of(beyond, fitted.noise, seen)
        diffuse = maps.get("diffuse_reflectance", np.ones(CHANNELS))[..., shown_colours(seen)]
        left = left_of(taken, best.pictures)
        told_apart = CHANNELS * len(taken.names) > numbers.count
        noise = fitted.noise**0.5 if told_apart else 0.0
        return outcome(
            fitted,
            *describe_open(numbers, fitted, len(taken.names)),
            *describe_misfit(misfit, noise, left, float(np.median(diffuse))),
            *(describe_normals(maps["normal"]) if told_apart else ()),
            uncertainty=errors_of(numbers, errors, fitted.x, shape),
            misfit=misfit.reshape(shape),
            **_compared(best, taken),
        )

    fitted = best = None
    try:
        fitted = fit_maps(numbers, seen, smoothness, report)
        best, rounds = refine_through_renderer(numbers, fitted, seen, taken, report)
        return conclude(best, simulated_errors(numbers, best, rounds, seen, taken, report))
    except KeyboardInterrupt as stop:
        so_far = (stop.best if isinstance(stop, Interrupted) else best) or fitted
        if so_far is None:
            raise
        if isinstance(so_far, Rendered):
            found = outcome(so_far.fitted, INTERRUPTED, **_compared(so_far, taken))
        else:
            found = outcome(so_far, INTERRUPTED)
        raise Interrupted(found, f"{name}: there are maps so far") from None


def _compared(best, capture):
    """What an `Svbrdf` knows of the pictures of a `Rendered`."""
    dB = compute_psnr(capture, best.pictures)
    return {"residual": best.left, "predicted": dB, "rendered": best.pictures}


def _counter(progress, usual):
    """A function that reports one more step; how many there will be is an estimate."""
    done = 0

    def report():
        nonlocal done
        done += 1
        if progress:
            progress(done, max(done + 1, usual))

    return report
