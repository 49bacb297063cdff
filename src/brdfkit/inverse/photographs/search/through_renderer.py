"""Corrects fitted maps with Mitsuba's renderings of them, which include the blur of pixels.

The formula for the radiance of a texel ignores that a pixel covers parts of several texels.
Therefore Mitsuba renders pictures R(x) of the maps with the searched numbers x, like the
photographs P. The difference at each texel t is added to the radiance L_t of the formula, and the
maps are fitted to the sum:

    L_t ← L_t(x) + (P - R(x))_t

At the end R(x) equals P up to noise, although the formula is not exact: it is enough that L_t
changes with x about as R does. [Van Cittert 1931] removes a blur by the same iteration.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.interrupts import Interrupted
from brdfkit.images.errors.psnr import psnr
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.observations import (
    DARK_OFFSET,
    Observations,
    sample_at_texels,
)
from brdfkit.inverse.photographs.maps.maps import Maps
from brdfkit.inverse.photographs.maps.residuals import compute_misfit
from brdfkit.inverse.photographs.maps.scene import make_sample_dict
from brdfkit.inverse.photographs.search.fitting_maps import FittedMaps
from brdfkit.inverse.photographs.search.least_squares import fit_all_texels
from brdfkit.inverse.photographs.search.problem import Problem

SAMPLES = 16  # samples per pixel of the renderings, evenly spread over the pixel
ROUND_LIMIT = 5  # largest number of rounds of correction
STEPS_PER_ROUND = 3  # few steps suffice, because each round begins near its minimum
# A round is undone if more than this share of the difference to the photographs remains: the first
# one, which removes the blur, and later ones
LARGEST_REMAINDERS = 1.0, *[0.9] * (ROUND_LIMIT - 1)


@dataclass(frozen=True)
class RenderedMaps:
    """Fitted maps with Mitsuba's renderings of them, in the photographs' cameras and lights.

    fitted : the maps.
    pictures : the renderings (lights, height, width, 3).
    difference : the RMS relative difference of the renderings from the photographs.
    """

    fitted: FittedMaps
    pictures: FloatArray
    difference: float


def refine_through_renderer(
    problem: Problem, fitted: FittedMaps, capture: Capture
) -> tuple[RenderedMaps, int]:
    """Return the corrected maps with their renderings, and the number of rounds of correction.

    On Ctrl-C `Interrupted` holds the `RenderedMaps` so far, or None.
    """
    best = None
    try:
        best = render_maps(problem, fitted, capture)
        for rounds, remainder in enumerate(LARGEST_REMAINDERS):
            corrected = correct_maps(problem, best, rounds == 0, capture)
            trial = render_maps(problem, corrected, capture)
            if not trial.difference < remainder * best.difference:
                return best, rounds
            best = trial
        return best, ROUND_LIMIT
    except KeyboardInterrupt:
        raise Interrupted(best) from None


def correct_maps(
    problem: Problem, rendered: RenderedMaps, is_first: bool, capture: Capture
) -> FittedMaps:
    """Return the maps after one round of correction with their renderings.

    The first round adds the whole difference between photographs and renderings. Later ones add
    only what exceeds the noise in each texel, so that noise is not sharpened [Wiener 1949].
    """
    fitted, observed = rendered.fitted, problem.observed
    beyond = sample_at_texels(capture, capture.pictures - rendered.pictures, observed.shape)
    if not is_first:
        misfit = np.maximum(measure_misfit(beyond, fitted.noise, observed), 1)
        beyond *= (1 - 1 / misfit**2)[:, None]
    radiance = problem.parameters.compute_radiances(fitted.x, observed) + beyond
    target = problem.with_radiances(radiance)
    # The Hessian does not depend on the radiances, so that of the earlier fit is used
    strength = target.compute_smoothness_weights(fitted.equations.hessian, fitted.noise, fitted.tau)
    x = fit_all_texels(target, fitted.x.copy(), strength, STEPS_PER_ROUND)
    return replace(fitted, x=x, equations=target.compute_equations(x), strength=strength)


def measure_misfit(differences: FloatArray, noise: float, observed: Observations) -> FloatArray:
    """Return the RMS (n,) of radiance differences (k, n, 3) per texel, in units of the noise."""
    return compute_misfit((observed.weights * differences**2).sum(axis=(0, 2)), noise, observed)


def render_maps(problem: Problem, fitted: FittedMaps, capture: Capture) -> RenderedMaps:
    """Return fitted maps with Mitsuba's renderings in the photographs' cameras and lights."""
    shape = problem.observed.shape
    maps = Maps.from_texel_numbers(problem.parameters, fitted.x, shape, capture.size)
    pictures = _render_like_photographs(maps, capture, problem.report)
    relative = _compute_relative_differences(capture, pictures)[capture.counted]
    return RenderedMaps(fitted, pictures, float(np.sqrt((relative**2).mean())))


def _compute_relative_differences(capture: Capture, pictures: FloatArray) -> FloatArray:
    """Return the relative differences (lights, height, width, 3) of pictures from photographs."""
    scale = np.maximum(capture.pictures, 0) + DARK_OFFSET * capture.pictures.mean()
    return (pictures - capture.pictures) / scale


def _render_like_photographs(
    maps: Maps, capture: Capture, report: Callable[[], object]
) -> FloatArray:
    """Return renderings (lights, height, width, 3) of maps in a capture's cameras and lights."""
    import mitsuba as mi

    sample = mi.load_dict(make_sample_dict(maps))
    sampler = {"type": "multijitter", "sample_count": SAMPLES}
    pictures: FloatArray = np.empty(capture.pictures.shape, np.float32)
    for k, camera in enumerate(capture.cameras):
        scene = {
            "type": "scene",
            "integrator": {"type": "direct"},
            "sensor": {**camera.scene_dict(capture.picture_size), "sampler": sampler},
            "sample": sample,
            "light": {
                "type": "point",
                "position": capture.positions[k].tolist(),
                "intensity": {"type": "rgb", "value": capture.intensities[k].tolist()},
            },
        }
        pictures[k] = mi.render(mi.load_dict(scene), seed=k, spp=SAMPLES)
        report()
    return pictures


def summarise_differences(capture: Capture, pictures: FloatArray) -> dict[str, float]:
    """Return the RMS relative difference of each rendering from its photograph, by name."""
    parts = zip(
        capture.names,
        _compute_relative_differences(capture, pictures),
        capture.counted,
        strict=True,
    )
    return {name: float(np.sqrt((off[counted] ** 2).mean())) for name, off, counted in parts}


def compute_psnr(capture: Capture, pictures: FloatArray) -> dict[str, float]:
    """Return the PSNR [dB] of each rendering against its photograph, over the usable pixels."""
    parts = zip(capture.names, capture.pictures, pictures, capture.counted, strict=True)
    return {
        name: psnr(photograph, picture, counted) for name, photograph, picture, counted in parts
    }
