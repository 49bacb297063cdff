"""Computes the errors of fits to a measured material: of albedos and of pictures of a ball.

The balls are lit by environment maps that come with brdfkit.
"""

from itertools import pairwise

import numpy as np

import brdfkit as bk
from brdfkit.core import catalogue
from brdfkit.core.colours import luminance, to_srgb
from brdfkit.core.geometry.directions import from_angles, to_half_difference
from brdfkit.images.ball import LIGHTS, draw_pixels
from brdfkit.lighting.environments import map_files
from brdfkit.lighting.environments.conventions import parse_convention
from brdfkit.lighting.environments.resampling import label_layout_parts, look_up_map
from brdfkit.materials.measured.coverage import find_largest_angles
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model.samples.measures import compute_measure

MODELS = "ward_duer", "ggx", "ggx+ggx", "abc+student_t"
LOSSES = "cosine", "log", "cbrt"
MAPS = "room", "sky", "studio"
# Number of pixels of each picture
PIXELS = 600
# Number of directions that a pixel draws by the light, and again by the BRDF
DIRECTIONS = 48
# Edges of ranges of the difference angle [degrees] in which the hue of a highlight is measured
HUES = 0, 20, 40, 60
# Angles of incidence [degrees] at which albedos of fits and data are compared
ANGLES = 5, 45, 75
# Further angles of incidence [degrees] at which fits should not reflect more light than arrives
OTHERS = 30, 60, 80, 85, 89


def measure_fits(data):
    """Return the properties of a measured material, and the errors of its fits, for the JSON."""
    judge = Judge(data)
    found = {
        "name": data.name,
        "albedo": judge.albedos.mean(axis=1).tolist(),
        "hues": judge.compute_highlight_hues(),
        "reach": [float(angle) for angle in find_largest_angles(data)],
        "known": data.rgb.albedo.known[: len(ANGLES)].tolist(),
        "negative": float((judge.data.values[judge.data.samples.valid] < 0).mean()),
        "findings": list(bk.audit(data).findings()),
        "fits": {},
    }
    for model in MODELS:
        fits = [bk.fit(data, model, loss=loss) for loss in LOSSES]
        found["fits"][model] = {fit.loss_name: judge(fit) for fit in fits}
    best = max(found["fits"], key=lambda model: found["fits"][model]["cbrt"]["psnr"])
    found["regions"] = judge.split_log_error(bk.fit(data, best))
    return found


class Judge:
    """The albedos and pictures of a measured material, with which its fits are compared."""

    def __init__(self, data):
        self.data = data.rgb
        self.albedos = compute_albedos(self.data, ANGLES)
        self.pictures = [draw_picture(name, self.data) for name in MAPS]

    def __call__(self, fit):
        """Return the errors of a fit, and whether its notes mention them."""
        said = [note for note in fit.notes if note in fit.albedo.warnings()]
        gains = [note for note in said if "more than arrives" in note]
        own = compute_albedos(fit, (*ANGLES, *OTHERS))
        return {
            "albedo": own[: len(ANGLES)].mean(axis=1).tolist(),
            "most": float(own.max()),
            "psnr": float(np.mean([compute_psnr(picture, fit) for picture in self.pictures])),
            "log error": bk.compare(self.data, fit).errors[fit.name]["log"],
            "said": len(said) > len(gains),
            "gain said": bool(gains),
            "searched again": any(n.startswith("by the loss alone") for n in fit.notes),
        }

    def compute_highlight_hues(self):
        """Return the shares (3, channels) of the colour channels in the highlight.

        There is a row for each range of the difference angle between two `HUES`.
        """
        samples = select_samples(self.data, 80.0)
        theta_h, theta_d, _ = np.degrees(to_half_difference(samples.wi, samples.wo))
        light = compute_measure(samples.extents, "angles")[:, None] * np.maximum(samples.values, 0)
        sums = [
            light[(theta_h < 5) & (theta_d >= a) & (theta_d < b)].sum(axis=0)
            for a, b in pairwise(HUES)
        ]
        return [(s / max(s.sum(), 1e-12)).tolist() for s in sums]

    def split_log_error(self, fit):
        """Return the parts of a fit's log error by region of directions.

        A part is the share of the squared error, and the factor by which the fit is too bright
        there in the mean.
        """
        samples = select_samples(self.data, 80.0)
        cosines = (samples.wi[:, 2] * samples.wo[:, 2])[:, None]
        own, its = (
            np.log(np.maximum(values, 0) * cosines + 1e-3)
            for values in (fit.eval(samples.wi, samples.wo), samples.values)
        )
        theta_h, theta_d, _ = np.degrees(to_half_difference(samples.wi, samples.wo))
        lower = np.degrees(np.arccos(np.minimum(samples.wi[:, 2], samples.wo[:, 2])))
        mirror, back = theta_h < 10, (theta_d < 10) & (theta_h >= 10)
        regions = {
            "mirror": mirror,
            "back": back,
            "grazing": ~mirror & ~back & (lower > 65),
            "other": ~mirror & ~back & (lower <= 65),
        }
        weight = compute_measure(samples.extents, "angles")
        squares = weight * ((own - its) ** 2).mean(axis=1)
        return {
            name: [
                float(squares[rows].sum() / squares.sum()),
                float(np.exp(np.average((own - its).mean(axis=1)[rows], weights=weight[rows]))),
            ]
            for name, rows in regions.items()
            if weight[rows].any()
        }


def compute_albedos(brdf, angles):
    """Return the albedos (n, channels) of a BRDF at `angles` of incidence [degrees]."""
    return np.array([bk.albedo(brdf, from_angles(np.radians(a), 0.0)) for a in angles])


def draw_picture(name, data):
    """Return the `Pixels` of a ball of a material, lit by an environment map in grey."""
    LIGHTS.setdefault(f"{name}.exr", load_light(name))
    return draw_pixels((f"{name}.exr",), data.eval, pixels=PIXELS, directions=DIRECTIONS)


def load_light(name):
    """Return the light of an environment map as a function of directions (n, 3) with z up.

    The function returns grey radiances (n,). `name`: name of a map that comes with brdfkit.
    """
    grey = luminance(map_files.read_map(catalogue.find_environment_file(name)))[..., None]
    own = parse_convention("mitsuba")
    parts = label_layout_parts(own.layout, *grey.shape[:2])

    def light(w):
        """Return the grey radiances (n,) from directions `w` (n, 3)."""
        with_y_up = np.stack([w[:, 0], w[:, 2], -w[:, 1]], axis=1)
        return look_up_map(grey, own.layout, with_y_up @ own.frame, parts)[:, 0]

    return light


def compute_psnr(picture, fit):
    """Return the PSNR [dB] of a fit's picture in sRGB, compared with the measured picture.

    The measured picture is exposed so that its brightest hundredth is white.
    """
    shown, own = (to_srgb(values) for values in (picture.evaluate(fit.eval), picture.values))
    squares = ((shown - own) ** 2).mean(axis=1)
    return -10 * np.log10(max(np.average(squares, weights=picture.weights), 1e-10))
