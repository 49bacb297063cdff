"""The public function `refine`, which finds parameters of a scene from pictures of it."""

from __future__ import (
    annotations,
)  # so that `help` prints the name Pictures, not its long definition

import time
from collections.abc import Callable, Iterable, Mapping
from contextlib import nullcontext
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np

from brdfkit.core.arguments import to_number, to_whole_number
from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import Interrupted
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress, make_step_counter
from brdfkit.inverse.scenes.problem.by_picture import Cameras, Pictures
from brdfkit.inverse.scenes.problem.lamps import Lights
from brdfkit.inverse.scenes.problem.making_views import make_views
from brdfkit.inverse.scenes.problem.parameters import PARAMETER_LIMIT
from brdfkit.inverse.scenes.problem.targets import read_targets
from brdfkit.inverse.scenes.problem.unseen_parameters import make_no_effect_error
from brdfkit.inverse.scenes.problem.views import Views, suppress_sampler_warnings
from brdfkit.inverse.scenes.result.conclusions import make_refinement
from brdfkit.inverse.scenes.result.refinement import Refinement
from brdfkit.inverse.scenes.result.search_check import (
    SearchCheck,
    check_search,
    make_checked_refinement,
)
from brdfkit.inverse.scenes.search.descent import count_descent_steps, minimise_by_descent
from brdfkit.inverse.scenes.search.far_starts import (
    FINALISTS,
    count_default_starts,
    find_best_start,
)
from brdfkit.inverse.scenes.search.gauss_newton import Search, run_gauss_newton

STEP_LIMIT = 30  # default largest number of steps; nearly all searches converge earlier
NO_ERRORS = "descent, the search for many numbers, gives no standard errors"


Bounds: TypeAlias = Mapping[str, tuple[float, float] | None]


@in_turn
def refine(
    scene: Any,
    pictures: Pictures,
    *,
    parameters: Iterable[str] | Bounds | None = None,
    starts: int | None = None,
    steps: int | None = None,
    lights: Lights | None = None,
    cameras: Cameras | None = None,
    smoothness: float | None = None,
    spp: int = 1024,
    mask: Pictures | None = None,
    accept_8_bit: bool = False,
    seed: int = 0,
    progress: Progress | None = None,
) -> Refinement:
    """Find the parameters of a scene whose rendered pictures match given ones.

    The derivatives come from the whole path tracer: light that bounces, meshes, lights and
    materials. The search takes Gauss-Newton steps. Two renderings with independent samples keep
    noise from biasing the result, and the samples grow until rendering is quieter than the
    difference from the pictures. Ctrl-C raises `Interrupted`, whose ``best`` is the best
    `Refinement` so far.

    Parameters
    ----------
    scene : mitsuba.Scene, dict, path, Model or Fit
        A Mitsuba scene, its dictionary or .xml file, with a known camera, lights and shapes; or a
        material, which is then put on the ball of `render`. The integrator must have derivatives,
        as ``prb``, ``prbvolpath`` and those of brdfkit do; ``path`` and ``volpath`` are replaced by
        the first two. A `mitsuba.Scene` ends with the values that were found;
        `Refinement.put_into` writes them into other scenes.
    pictures : ndarray or path, several of them, or a dict of names to them
        A picture for each sensor of the scene, or with `lights` any number of them: linear values
        (height, width, channels), or an OpenEXR file. Names are for `lights`, `cameras` and `mask`.
    parameters : names, or dict of names to (low, high), default all of brdfkit's models
        The parameters to search, by their names in `mitsuba.traverse`, with or without ``.value``
        at the end: numbers, colours, ``.data``, the texels of textures, environment maps and
        volumes, and ``.to_world`` of lamps, whose three numbers are a position, or the direction in
        which a distant lamp shines. The default bounds are those of a model's parameter, 0 to 1 for
        shares and roughnesses of Mitsuba's BSDFs, and otherwise 0 to infinity.
    starts : int, optional
        The number of starting points: the scene's own values, and others spread over the bounds of
        the numbers in which pictures are not linear. The default is 8 points for each such number,
        at most 32, besides the scene's own; 1 uses these alone.
    steps : int, optional
        The largest number of steps after the choice of the starting point, at least 1. The default
        is 30; numbers that trade off, such as those of two lobes, need most of them. With textures,
        the limit holds for the short steps of L-BFGS-B in each of three stages.
    lights : dict of names of pictures to names of lamps, optional
        The lamps of the scene that burned in each picture; all others are off in it. A lamp is
        named as in `mitsuba.traverse`, or by its shape. Or several lists of lamps, in the order of
        the pictures. By default all lamps burn in all pictures.
    cameras : dict of names of pictures to ids of sensors, optional
        The sensor that took each picture. By default that is the only sensor, or the one with the
        picture's name as its id, or else the sensors in their order.
    smoothness : float, optional
        For textures and volumes: the weight, at least 0, of the mean squared difference of
        neighbouring texels in the loss; more is smoother. The unit of texels is their range, or
        their mean at the start where there is no upper bound. By default pixels that are held out
        choose the best of five weights.
    spp : int, default 1024
        The largest number of samples per pixel, at least 4. The last steps take most of the time,
        in proportion to it; 128 or 256 are a good beginning. The search uses half of the samples
        and checks its end with all of them; if the check disagrees, the search goes on with all,
        and the check uses twice as many.
    mask : ndarray or path, several of them, or a dict of names of pictures to them, optional
        The pixels of each picture that count: booleans or weights ≥ 0 (height, width), or a picture
        file that is white there; None for a picture that counts everywhere. Masked pixels may hold
        anything. An alpha channel is ignored unless it is passed as ``mask=picture[..., 3]``.
        Clipped pixels, three or more that equal the largest value of their channel, never count,
        and neither do the pixels beside them.
    accept_8_bit : bool, default False
        Whether to accept pictures of 8 bits, by inverting sRGB's curve.
    seed : int, default 0
        The seed of the samples and starting points. Equal seeds give equal results; for textures
        they differ by rounding, as the GPU or several threads add derivatives in any order.
    progress : callable, optional
        Called with (done, total); see `brdfkit.progress`.

    Returns
    -------
    Refinement
        The values with their standard errors; prints as a table. ``fit`` is the material's `Fit`.

    Raises
    ------
    BrdfkitError
        For a scene that does not load, an integrator without derivatives, pictures that do not fit
        the cameras, have 8 bits or are not finite, masks that do not fit the pictures, unknown
        parameters, lamps or cameras, a picture in which no lamp burns, a negative smoothness,
        textures of integers, and parameters without any effect on the pictures.

    Examples
    --------
    >>> alpha = ["ball.bsdf.alpha_u"]
    >>> result = refine("cornell.xml", "photograph.exr", parameters=alpha)    # doctest: +SKIP

    Photographs under one lamp each:

    >>> photographs = {"left": "left.exr", "right": "right.exr"}
    >>> lights = {"left": "lamp_1", "right": "lamp_2"}
    >>> result = refine("dome.xml", photographs, lights=lights)    # doctest: +SKIP
    """
    began = time.perf_counter()
    variant = use_variant()
    if not variant.endswith(("_rgb", "_mono")) or variant.startswith("scalar"):
        raise BrdfkitError(
            f"refine: the variant {variant} has no derivatives of pictures in linear colours; set "
            "llvm_ad_rgb or cuda_ad_rgb."
        )
    spp = to_whole_number("refine: spp", spp, 4)
    steps = STEP_LIMIT if steps is None else to_whole_number("refine: steps", steps, 1)
    if starts is not None:
        to_whole_number("refine: starts", starts, 1)
    if smoothness is not None:
        to_number("refine: smoothness", smoothness, least=0)
    targets = read_targets(pictures, accept_8_bit, mask)
    views = make_views(scene, targets, parameters, lights, cameras)
    with views.lighting.restored_after_errors() if views.lighting else nullcontext():
        return _search(views, starts, steps, smoothness, spp, seed, progress, began)


def _search(
    views: Views,
    starts: int | None,
    steps: int,
    smoothness: float | None,
    spp: int,
    seed: int,
    progress: Progress | None,
    began: float,
) -> Refinement:
    """Search the parameters of `views`, with the arguments of `refine`; return the result.

    `began` is the time at which `refine` was called.
    """
    by_descent = len(views.start) > PARAMETER_LIMIT or any(u.shape for u in views.unknowns)
    seed_of_search = seed + 100
    try:
        if by_descent:
            report = make_step_counter(progress, count_descent_steps(smoothness, steps))
            state, weight = minimise_by_descent(
                views, smoothness, steps, spp, seed_of_search, report
            )
            how = "by held-out pixels" if smoothness is None else "as given"
            notes: tuple[str, ...] = f"smoothness {weight:g}, {how}", NO_ERRORS
            return make_refinement(views, state, time.perf_counter() - began, notes=notes)
        count = count_default_starts(views) if starts is None else starts
        report = make_step_counter(progress, (count + FINALISTS if count > 1 else 0) + steps)
        with suppress_sampler_warnings():
            x = find_best_start(views, count, seed, report)
            state, search_check = _search_and_check(views, x, steps, spp, seed_of_search, report)
        return make_checked_refinement(views, state, search_check, time.perf_counter() - began)
    except Interrupted as stop:
        notes = (NO_ERRORS,) if by_descent else ()
        seconds = time.perf_counter() - began
        best = make_refinement(views, stop.best, seconds, notes=notes, interrupted=True)
        raise Interrupted(best, f"refine: the best so far leaves {best.loss:.3g}") from None


def _search_and_check(
    views: Views, x: FloatArray, steps: int, spp: int, seed: int, report: Callable[[], object]
) -> tuple[Search, SearchCheck | None]:
    """Search from the coordinates `x` with half of the samples, and check the end with all.

    If the check disagrees, go on with all samples, and check the end with twice as many.
    """
    state = _search_visible_numbers(views, x, steps - steps // 2, spp // 2, seed, report)
    state, search_check = check_search(views, state, seed)
    agreed = state.converged and not (search_check and search_check.describe_differences())
    if agreed or state.steps == steps:
        return state, search_check
    left = steps - state.steps
    longer = _search_visible_numbers(views, state.residuals.x, left, spp, seed + 200, report)
    longer.steps += state.steps
    longer.history[:0] = state.history
    return check_search(views, longer, seed + 200)


def _search_visible_numbers(
    views: Views, x: FloatArray, steps: int, spp: int, seed: int, report: Callable[[], object]
) -> Search:
    """Search from `x`; numbers that pictures do not depend on keep the scene's own values."""
    state = run_gauss_newton(views, x, steps, spp, seed, report)
    assert state.equations is not None
    unseen = state.equations.find_unseen_numbers(views, state.residuals.x)
    if unseen.all():
        raise make_no_effect_error(views)
    own = np.where(unseen, views.start, state.residuals.x)
    state.residuals = replace(state.residuals, x=own)
    return state
