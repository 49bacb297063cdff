# ruff: noqa: I001, for brdfkit comes first: it chooses the LLVM that Mitsuba loads
"""Draws highlights of round lamps for the page `distance_fields.md`, and computes their errors."""

from math import sqrt

from brdfkit.distance_fields import plane, sphere
from distance_field_gallery.stage import bulb, camera, scene
import mitsuba as mi
import numpy as np

ROUGHNESSES = 0.05, 0.1, 0.2, 0.4  # α of GGX
SIZES = 0.05, 0.1, 0.2  # sizes of the lamp: radius over distance from the ball
EXACT = {"shading": "exact", "samples": 128}
FILM = {"type": "hdrfilm", "width": 96, "height": 64, "pixel_format": "rgb"}
SPP = 16


def highlights():
    """Highlights: `shading="split"`, the default, looks at the middle of a lamp, as if all of it
    were there. That is free of noise, and right where the highlight is wider than the lamp looks.
    On what shines more, large lamps look like small ones. `estimated` has highlights in the
    lamp's shape, of `samples` random directions for each, and noise in soft shadows.
    """
    field = sphere(1).at(0, 0, 1).made_of("ball") | plane()
    lights = {
        "small": bulb([-3, -2.5, 5.5], 0.7, [45, 45, 45]),
        "large": bulb([5, -4, 5], 2, [4, 4, 4]),
    }
    view = camera([0, -6, 3], [0, 0, 0.9], 36)
    shadings = {"split": {}, "estimated": {"shading": "estimated", "samples": 4}, "exact": EXACT}
    return {n: scene(field, {"ball": "car_paint"}, lights, view, **s) for n, s in shadings.items()}


def compute_errors_by_roughness():
    """Return a row for each roughness α: α, and the errors of `split` by the size of the lamp."""
    return [(alpha, *(compute_error(alpha, size) for size in SIZES)) for alpha in ROUGHNESSES]


def compute_error(alpha, size):
    """Return the relative error (mean, root mean square) of `split` for a metal ball on metal."""
    field = sphere(1).at(0, 0, 1) | plane()
    distance = sqrt(2.5**2 + 1 + 2.5**2)
    lamp = {"lamp": bulb([2.5, 1, 3.5], size * distance, [1, 1, 1])}
    metal = {"type": "roughconductor", "distribution": "ggx", "alpha": alpha}
    view = camera([0, -6, 3], [0.3, 0, 0.6], 40) | {"film": FILM}

    def picture(**how):
        loaded = mi.load_dict(scene(field, {}, lamp, view, metal=metal, **how))
        return np.array(mi.render(loaded, spp=SPP))

    split, exact = picture(), picture(**EXACT)
    rms = np.sqrt(np.mean((split - exact) ** 2) / np.mean(exact**2))
    return split.mean() / exact.mean() - 1, rms
