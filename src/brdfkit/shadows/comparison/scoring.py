"""Scores one shadow technique: makes its shadow, and compares each pixel with a shadow ray."""

import time
from collections.abc import Callable
from math import nan
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.images.errors.psnr import psnr
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.comparison.quality import acne, aliasing_error, share_of_texels_used
from brdfkit.shadows.comparison.scores import Scores
from brdfkit.shadows.comparison.tracked_points import TrackedPoints
from brdfkit.shadows.maps.light_shadow import LightShadow
from brdfkit.shadows.maps.placement import Placement
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.resolution import texel_area_in_pixels

MARGIN = 4  # width around shadows [pixels] in which missing light is a soft border, not acne


def score_technique(
    view: LitView,
    placement: Placement,
    tracked: tuple[TrackedPoints, TrackedPoints],
    technique: Callable[[LitView, Placement], Any],
) -> tuple[Scores, FloatArray]:
    """Return a technique's scores, and the share (pixels,) of the light that it lets arrive.

    placement : placement of the view's camera and light.
    tracked : points of the view for measuring flicker, as the camera moves and as the light moves.
    technique : function that makes a shadow, an object with `visibility(p, n, active)` such as
        `LightShadow`.
    """

    def look_up_pixels(shadow: Any) -> Any:
        return shadow.visibility(view.si.p, view.si.n, view.si.is_valid())

    shadow = technique(view, placement)
    shares, seconds = time_second_run(lambda: look_up_pixels(shadow))
    _, seconds_of_both = time_second_run(lambda: look_up_pixels(technique(view, placement)))
    lit = np.array(shares)
    facing, exact = view.facing, view.exact
    lit_picture, exact_picture, facing_picture = (
        image.reshape(view.size) for image in (lit, exact, facing)
    )
    use, fineness = score_texels(shadow, view, placement)
    by_camera, by_light = (points.measure_flicker(lit, technique) for points in tracked)
    scores = Scores(
        psnr=psnr(view.compute_picture(exact), view.compute_picture(lit), facing_picture),
        wrong=float(np.abs(lit - exact)[facing].mean()),
        acne=acne(lit_picture, exact_picture, facing_picture, MARGIN),
        texture_use=use,
        aliasing=fineness,
        camera_flicker=by_camera,
        light_flicker=by_light,
        build=max(seconds_of_both - seconds, 0.0),
        look_up=seconds,
    )
    return scores, lit


def time_second_run(function: Callable[[], Any]) -> tuple[Any, float]:
    """Return a function's evaluated result, and the processor time [s] of its second run."""
    for _ in range(2):  # the first run also compiles kernels, which should not be timed
        start = time.process_time()
        result = function()
        dr.eval(result)
        dr.sync_thread()
        seconds = time.process_time() - start
    return result, seconds


def score_texels(shadow: Any, view: LitView, placement: Placement) -> tuple[float, float]:
    """Return the share of the maps' area that a view uses, and the aliasing error [dB].

    These are Q1 and Q2 of [Ergun 2008, 3.2]. Both are NaN for a `shadow` without maps.
    """
    import mitsuba as mi

    if not isinstance(shadow, LightShadow):
        return nan, nan
    camera = Projection.from_matrix(placement.camera.matrix, placement.light).make_opaque()
    film = view.sensor.film()
    # A film may crop the picture, but the camera's projection covers all of it
    pixels = np.array(view.size[::-1]) * np.array(film.size()) / np.array(film.crop_size())
    p, n = view.si.p, view.si.n
    part, facing = shadow.find_part(p), mi.Bool(view.facing)
    places, areas = [], []
    for index, its_map in enumerate(shadow.maps):
        x, y, _ = its_map.projection.project(*p)
        texels = its_map.projection, its_map.resolution
        e = texel_area_in_pixels(texels, (camera, pixels.tolist()), p, n)
        chosen = np.array(facing & (part == index))
        places.append((np.array([x, y]).T[chosen] + 1) / 2)
        areas.append(np.array(e)[chosen])
    return share_of_texels_used(places), aliasing_error(np.concatenate(areas))
