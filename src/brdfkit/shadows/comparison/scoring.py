"""Scores of one technique: its maps are made, read for all pixels, and held to shadow rays."""

import time
from math import nan

import drjit as dr
import numpy as np

from brdfkit.images.errors.psnr import psnr
from brdfkit.shadows.comparison.quality import aliasing_error, share_used
from brdfkit.shadows.comparison.scores import Scores
from brdfkit.shadows.maps.bias import acne
from brdfkit.shadows.maps.light_shadow import LightShadow
from brdfkit.shadows.maps.projection import Projection
from brdfkit.shadows.maps.resolution import aliasing

MARGIN = 4  # pixels about shadows in which a soft border is no acne


def score(seen, placement, watched, shadow_of):
    """The `Scores` of a technique, and the shares of light (pixels,) that it lets through.

    seen : what the camera sees, a `Seen`.
    placement : of its camera and light.
    watched : points of it while the camera moves, and while the light does: two `Watched`.
    shadow_of : the function (seen, placement) → what has `lit(p, n, active)`, as `LightShadow`.
    """

    def look(shadow):
        return shadow.lit(seen.si.p, seen.si.n, seen.si.is_valid())

    shadow = shadow_of(seen, placement)
    lit, look_up = timed(lambda: look(shadow))
    _, both = timed(lambda: look(shadow_of(seen, placement)))
    lit = np.array(lit)
    facing, exact = seen.facing, seen.exact
    pictures = (image.reshape(seen.size) for image in (lit, exact, facing))
    use, fineness = use_of_maps(shadow, seen, placement)
    by_camera, by_light = (points.flicker(lit, shadow_of) for points in watched)
    scores = Scores(
        psnr=psnr(seen.picture(exact), seen.picture(lit), facing.reshape(seen.size)),
        wrong=float(np.abs(lit - exact)[facing].mean()),
        acne=acne(*pictures, MARGIN),
        texture_use=use,
        aliasing=fineness,
        camera_flicker=by_camera,
        light_flicker=by_light,
        build=max(both - look_up, 0.0),
        look_up=look_up,
    )
    return scores, lit


def timed(function):
    """What a function returns, evaluated, and its processor time [s] when it runs again."""
    for _ in range(2):  # at first kernels are compiled
        began = time.process_time()
        found = function()
        dr.eval(found)
        dr.sync_thread()
        seconds = time.process_time() - began
    return found, seconds


def use_of_maps(shadow, seen, placement):
    """Q1, the share of the maps' texels that are used, and Q2, the aliasing error [dB]; nan for a
    `shadow` without maps."""
    import mitsuba as mi

    if not isinstance(shadow, LightShadow):
        return nan, nan
    camera = Projection.by(placement.camera.matrix, placement.light).opaque()
    film = seen.sensor.film()
    # the camera's whole picture, of which a film may show a window, in pixels of this size
    pixels = np.array(seen.size[::-1]) * np.array(film.size()) / np.array(film.crop_size())
    p, n = seen.si.p, seen.si.n
    part, facing = shadow.which(p), mi.Bool(seen.facing)
    places, areas = [], []
    for number, its_map in enumerate(shadow.maps):
        x, y, _ = its_map.projection.to_map(*p)
        texels = its_map.projection, its_map.resolution
        e = aliasing(texels, (camera, pixels.tolist()), p, n)
        chosen = np.array(facing & (part == number))
        places.append((np.array([x, y]).T[chosen] + 1) / 2)
        areas.append(np.array(e)[chosen])
    return share_used(places), aliasing_error(np.concatenate(areas))
