"""`refine`: numbers of a scene, found from pictures through the path tracer."""

from __future__ import annotations  # `help` then says Pictures, and not what they are made of

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.arguments import to_number, to_whole_number
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.interrupts import Interrupted
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.inverse.scenes.problem.parameters import MOST, choose
from brdfkit.inverse.scenes.problem.scene import integrator_of, load_subject
from brdfkit.inverse.scenes.problem.targets import read_targets
from brdfkit.inverse.scenes.problem.unseen_parameters import nothing_seen
from brdfkit.inverse.scenes.problem.views import Views, quiet_samplers
from brdfkit.inverse.scenes.result.conclusions import conclude_search
from brdfkit.inverse.scenes.result.refinement import Refinement
from brdfkit.inverse.scenes.result.second_look import look_again
from brdfkit.inverse.scenes.search.descent import descend, usual_total
from brdfkit.inverse.scenes.search.far_starts import BEST, start, usual_count
from brdfkit.inverse.scenes.search.gauss_newton import search

STEPS = 30  # that a search may take; nearly all of them end by themselves before

Pictures = NDArray | str | Path | Iterable[NDArray | str | Path]


@in_turn
def refine(
    scene: Any,
    pictures: Pictures,
    parameters: Iterable[str] | Mapping[str, tuple[float, float] | None] | None = None,
    *,
    starts: int | None = None,
    steps: int | None = None,
    smoothing: float | None = None,
    samples: int = 1024,
    mask: Pictures | None = None,
    linearise: bool = False,
    seed: int = 0,
    progress: Callable[[int, int], object] | None = None,
) -> Refinement:
    """Find numbers of a scene that make its pictures equal to those that are given.

    The whole renderer is differentiated: light that bounces, meshes, lights and materials. Steps
    are those of Gauss and Newton, with the derivatives of each picture by each number; two
    independent renderings keep their noise from biasing the result, and their samples grow until
    it is less than what is left of the pictures' own. Ctrl-C raises `Interrupted`, whose ``best``
    is the best `Refinement` so far.

    Parameters
    ----------
    scene : mitsuba.Scene, dict, path, Model or Fit
        A scene of Mitsuba's, its dictionary or .xml file, with all that is known: camera, lights
        and shapes. Or a material, to begin with, on the ball of `render`. Its integrator is one
        with derivatives, as ``prb``, ``prbvolpath`` and those of brdfkit; ``path`` and ``volpath``
        stand for the first two. A `mitsuba.Scene` is left with the values that were found; of
        anything else `Refinement.put_into` makes one.
    pictures : ndarray or path, or several
        A picture for each sensor of the scene: linear values (height, width, channels), or an
        OpenEXR file.
    parameters : names, or dict of names to (low, high), default all of brdfkit's models
        What is searched: numbers and colours, by the names of `mitsuba.traverse`, with or without
        ``.value`` at the end; and ``.data``, the texels of
        textures, environment maps and volumes, as many as there are. Bounds are by default those
        of the model's parameter, 0 to 1 for shares and roughnesses of Mitsuba's BSDFs, and else 0
        to infinity.
    starts : int, optional
        Points from which the search begins: the scene's own values, and others, spread over the
        bounds of what pictures are not linear in. By default 8 for each of these numbers, at
        most 32, and the scene's own; 1 trusts that.
    steps : int, optional
        Steps that the search may take after its start, at least 1; by default 30, of which numbers
        that trade off, as those of two lobes, need most. With textures, in each of three stages of
        growing samples: short ones, by L-BFGS-B.
    smoothing : float, optional
        Of textures and volumes: the weight, at least 0, of the mean squared difference of
        neighbouring texels in the loss, in units of their bounds, or of the mean at the start where
        there is no upper bound; more is smoother. By default the best of five for pixels that are
        held out.
    samples : int, default 1024
        Samples per pixel, at most, at least 4. The last steps take most of the time, which grows
        with these and the pixels: 128 or 256 are a good beginning. A search takes half of them,
        and all for a second look at its end; where that says otherwise it goes on with all, and
        takes the second look with twice as many.
    mask : ndarray or path, or several, optional
        The pixels that count, of each picture: booleans, or weights ≥ 0 (height, width), or a
        picture's file, white where they do; None for a picture all of which does. Pixels at 0 may
        hold anything. An alpha channel serves as ``mask=picture[..., 3]``; by itself it is ignored.
    linearise : bool, default False
        Whether pictures of 8 bits are accepted, as seen by sRGB's curve.
    seed : int, default 0
        Of the samples and the starts; equal seeds give equal results, of textures but for rounding,
        since derivatives backwards are added up in any order.
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
        the cameras, have 8 bits or are not finite, masks that do not fit the pictures,
        parameters that are none, a smoothing below 0, textures of integers, and numbers on which
        no picture depends.

    Examples
    --------
    >>> found = refine("cornell.xml", "photograph.exr", ["ball.bsdf.alpha_u"])    # doctest: +SKIP
    """
    began = time.perf_counter()
    variant = use_variant()
    if not variant.endswith(("_rgb", "_mono")) or variant.startswith("scalar"):
        raise BrdfkitError(
            f"refine: the variant {variant} has no derivatives of pictures in linear colours; set "
            "llvm_ad_rgb or cuda_ad_rgb."
        )
    samples = to_whole_number("refine: samples", samples, 4)
    for name, number in (("steps", steps), ("starts", starts)):
        if number is not None:
            to_whole_number(f"refine: {name}", number, 1)
    if smoothing is not None:
        to_number("refine: smoothing", smoothing, least=0)
    views = _views(scene, read_targets(pictures, linearise, mask), parameters)
    steps = steps or STEPS
    if len(views.start) > MOST or any(unknown.shape for unknown in views.unknowns):
        return _by_descent(views, smoothing, steps, samples, seed + 100, progress, began)
    count = usual_count(views) if starts is None else starts
    report = _counter(progress, (count + BEST if count > 1 else 0) + steps)
    try:
        with quiet_samplers():
            x = start(views, count, seed, report)
            found, second_look = _search_and_check(views, x, steps, samples, seed + 100, report)
    except Interrupted as stop:
        best = conclude_search(views, stop.best, time.perf_counter() - began, interrupted=True)
        raise Interrupted(best, f"refine: the best so far leaves {best.loss:.3g}") from None
    seconds = time.perf_counter() - began
    return conclude_search(views, found, seconds, second_look=second_look)


def _search_and_check(views, x, steps, samples, seed, report):
    """(the `Search` from `x`, its `SecondLook`): of half of the samples, held against all of them;
    where these say otherwise, it goes on with all, and is held against twice as many."""
    found = _search_without_unseen(views, x, steps - steps // 2, samples // 2, seed, report)
    found, second_look = look_again(views, found, seed)
    agreed = found.converged and not second_look.notes()
    if agreed or found.steps == steps:
        return found, second_look
    more = _search_without_unseen(
        views, found.here.x, steps - found.steps, samples, seed + 200, report
    )
    more.steps += found.steps
    more.history[:0] = found.history
    return look_again(views, more, seed + 200)


def _search_without_unseen(views, x, steps, samples, seed, report):
    """The `Search` from `x`; where nothing is known, its own start means nothing."""
    found = search(views, x, steps, samples, seed, report)
    unseen = found.about.unseen(views, found.here.x)
    if unseen.all():
        raise nothing_seen(views)
    found.here = replace(found.here, x=np.where(unseen, views.start, found.here.x))
    return found


def _by_descent(views, smoothing, steps, samples, seed, progress, began):
    """The `Refinement` of many numbers, by derivatives backwards."""
    report = _counter(progress, usual_total(smoothing, steps))
    without = "descent, as for many numbers, gives no standard errors"
    try:
        found, chosen = descend(views, smoothing, steps, samples, seed, report)
    except Interrupted as stop:
        best = conclude_search(
            views, stop.best, time.perf_counter() - began, interrupted=True, notes=(without,)
        )
        raise Interrupted(best, f"refine: the best so far leaves {best.loss:.3g}") from None
    how = "by held-out pixels" if smoothing is None else "as given"
    notes = (f"smoothing {chosen:g}, {how}", without)
    return conclude_search(views, found, time.perf_counter() - began, notes=notes)


def _views(scene, targets, parameters):
    """The `Views` of what `refine` is given."""
    import mitsuba as mi

    loaded = load_subject(scene, targets[0].size)
    names = mi.traverse(loaded)
    unknowns = choose(names, parameters)
    numbers = sum(len(unknown.start) for unknown in unknowns)
    values = sum(np.count_nonzero(target.weights) for target in targets)
    if not values or values < numbers <= MOST:
        raise BrdfkitError(
            f"refine: {numbers} numbers are more than the {values} values of the pictures that "
            "count; give larger pictures, or name fewer."
        )
    return Views(loaded, integrator_of(loaded), targets, names, unknowns)


def _counter(progress, total):
    """A function that reports one more of `total`."""
    done = 0

    def report():
        nonlocal done
        done += 1
        if progress:
            progress(min(done, total), total)

    return report
