"""Maps refined through the renderer: what pixels blur, the formula of the texels does not say.

Mitsuba renders the photographs R of the maps, and what the photographs P show beyond them is added
to what the formula L says of each texel t, before all are fitted once more:

    L_t ← L_t(x) + (P - R(x))_t

At the end R(x) is P but for noise, whatever the formula leaves out; it only has to change with x
about as R does. [Van Cittert 1931] so undoes a blur.
"""

from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.interrupts import Interrupted
from brdfkit.images.errors.psnr import psnr
from brdfkit.inverse.photographs.capture.observations import DARK, gathered
from brdfkit.inverse.photographs.maps.maps import Maps
from brdfkit.inverse.photographs.maps.prediction import radiances
from brdfkit.inverse.photographs.maps.residuals import misfits
from brdfkit.inverse.photographs.maps.scene import sample_dict
from brdfkit.inverse.photographs.search.fitting_maps import FittedMaps
from brdfkit.inverse.photographs.search.search import equations, search_together
from brdfkit.inverse.photographs.search.smoothness import units_of

SAMPLES = 16  # per pixel, evenly spread
EVENLY = {"sampler": {"type": "multijitter", "sample_count": SAMPLES}}
ROUNDS = 5
STEPS = 3  # of each round, which begins near its end
GAIN = 0.9  # what is left has to fall below so much of itself, else it is noise


@dataclass(frozen=True)
class Rendered:
    """`FittedMaps` with Mitsuba's pictures of them (lights, height, width, 3), and what is left of
    the photographs: the RMS of relative differences."""

    fitted: FittedMaps
    pictures: np.ndarray
    left: float


def refine_through_renderer(numbers, fitted, seen, capture, report=lambda: None):
    """The `Rendered` of the best maps, and how many rounds lead to them from those `fitted`.

    On Ctrl-C `Interrupted` has the `Rendered` so far, if there is one.
    """
    best = None
    try:
        best = rendered(numbers, fitted, seen, capture, report)
        for done in range(ROUNDS):
            corrected = one_round(numbers, best, done == 0, seen, capture, report)
            trial = rendered(numbers, corrected, seen, capture, report)
            if not trial.left < GAIN * best.left:
                return best, done
            best = trial
        return best, ROUNDS
    except KeyboardInterrupt:
        raise Interrupted(best) from None


def one_round(numbers, there, first, seen, capture, report):
    """The `FittedMaps` from those of a `Rendered`, by what the photographs show beyond it: all in
    the `first` round, and then what is more than noise, texel by texel, lest noise is sharpened."""
    fitted = there.fitted
    beyond = gathered(capture, capture.pictures - there.pictures, seen.shape)
    if not first:
        misfit = np.maximum(misfits_of(beyond, fitted.noise, seen), 1)
        beyond *= (1 - 1 / misfit**2)[:, None]  # [Wiener 1949]
    target = replace(seen, radiance=radiances(numbers, fitted.x, seen) + beyond)
    units = units_of(numbers, fitted.about.hessian, seen)  # radiances do not change it
    strength = fitted.noise / (fitted.tau * units) ** 2
    x = search_together(numbers, fitted.x.copy(), target, strength, STEPS, report)
    about = equations(numbers, x, target)
    return replace(fitted, x=x, about=about, strength=strength)


def misfits_of(off, noise, seen):
    """The `misfits` (n,) of radiances that are `off` (k, n, 3)."""
    return misfits((seen.weights * off**2).sum(axis=(0, 2)), noise, seen)


def rendered(numbers, fitted, seen, capture, report=lambda: None):
    """The `Rendered` of `FittedMaps`."""
    maps = Maps.of(numbers, fitted.x, seen.shape, capture.size)
    pictures = pictures_of(maps, capture, report)
    off = differences(capture, pictures)[capture.counted]
    return Rendered(fitted, pictures, float(np.sqrt((off**2).mean())))


def differences(capture, pictures):
    """How pictures differ from the photographs (lights, height, width, 3), relative to these."""
    scale = np.maximum(capture.pictures, 0) + DARK * capture.pictures.mean()
    return (pictures - capture.pictures) / scale


def pictures_of(maps, capture, report=lambda: None):
    """Mitsuba's pictures (lights, height, width, 3) of `Maps`, by the cameras and lights of a
    `Capture`."""
    import mitsuba as mi

    sample = mi.load_dict(sample_dict(maps))
    found = np.empty(capture.pictures.shape, np.float32)
    for k, camera in enumerate(capture.cameras):
        light = {
            "type": "point",
            "position": capture.positions[k].tolist(),
            "intensity": {"type": "rgb", "value": capture.intensities[k].tolist()},
        }
        scene = {
            "type": "scene",
            "integrator": {"type": "direct"},
            "sensor": camera.scene_dict(capture.picture_size) | EVENLY,
            "sample": sample,
            "light": light,
        }
        found[k] = mi.render(mi.load_dict(scene), seed=k, spp=SAMPLES)
        report()
    return found


def left_of(capture, pictures):
    """Name of each photograph → the RMS relative difference of its picture."""
    parts = zip(capture.names, differences(capture, pictures), capture.counted, strict=True)
    return {name: float(np.sqrt((off[counts] ** 2).mean())) for name, off, counts in parts}


def compute_psnr(capture, pictures):
    """Name of each photograph → `psnr` [dB] of its picture, over the pixels that count."""
    parts = zip(capture.names, capture.pictures, pictures, capture.counted, strict=True)
    return {name: psnr(photograph, picture, counts) for name, photograph, picture, counts in parts}
