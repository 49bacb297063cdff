"""Compares a fit with its measured material by a picture, and by its colour at grazing angles.

Measurements end some degrees above the horizon, and beyond these a fit extrapolates with its
formula. There the colour of a real material approaches grey, because Fresnel reflection at the
surface has no colour. A fit with a colour that is no mixture of the material's own and grey has a
coloured rim.
"""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.colours import LUMINANCE, to_srgb
from brdfkit.images.ball import LIGHTS, draw_pixels
from brdfkit.images.errors.colour_difference import ciede2000
from brdfkit.images.errors.psnr import find_peak
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Samples
from brdfkit.regression.albedo import ISOTROPIC_AZIMUTHS, make_albedo_pixels

Array = NDArray[np.float64]
Brdf = Callable[[Array, Array], Array]  # maps wi, wo (n, 3) to values (n, channels)

ANGLES = 15.0, 30.0, 45.0, 60.0, 75.0  # incidences [degrees] that give the material's own colours
GRAZING = 85.0  # angle of incidence [degrees] at which the colour of a fit is judged
# Number of incident directions in each pixel that are drawn in proportion to the light; as many are
# drawn in proportion to the BRDF. More directions do not distinguish models better
DIRECTIONS = 16
# Largest difference ΔE2000 of a plausible colour from all mixtures of the material's colours with
# grey: fits that look right have at most 3.9, and fits with a coloured rim 5.8 to 18
OTHER = 5.0
MIXTURES = 21  # number of mixtures of each colour with grey
DARKEST = 1 / 255  # least brightness by which an error is divided, for black materials
GAIN = 1.05  # largest plausible albedo: measurements of bright metals reach 1, and fits a bit more


class Appearance:
    """A picture and colours of a measured material, with which its fits are compared.

    `data` is the `Measured`, `samples` are those that are fitted, and directions at or beyond
    `max_angle` [degrees] to the normal are not in the picture. `seed` should not be the one that
    drew the pixels of a `Picture` loss, because fits are judged by other pixels than these.
    """

    def __init__(self, data: Measured, samples: Samples, max_angle: float, seed: int):
        brdf = data.rgb.eval
        self.pixels = draw_pixels(tuple(LIGHTS), brdf, max_angle, seed, directions=DIRECTIONS)
        self.azimuths = (0.0, np.pi / 2) if data.anisotropic else ISOTROPIC_AZIMUTHS
        end = samples.largest_angle
        angles = [angle for angle in ANGLES if angle <= end] or [end]
        self.albedos = make_albedo_pixels(tuple(angles), self.azimuths).evaluate(brdf)

    def compute_picture_error(self, brdf: Brdf) -> float:
        """Return the RMS difference of a BRDF's picture from the measured one, in sRGB values.

        It is divided by the brightness of the brightest measured pixel.
        """
        pixels, shown = self.pixels, to_srgb(self.pixels.values)
        apart = to_srgb(np.nan_to_num(pixels.evaluate(brdf))) - shown
        error = math.sqrt(np.average((apart**2).mean(axis=1), weights=pixels.weights))
        return error / max(find_peak(shown[None]), DARKEST)

    def find_implausibility(self, brdf: Brdf) -> str:
        """Return a clause on an implausible albedo or colour of a BRDF at 85°, or "" for none."""
        (albedo,) = make_albedo_pixels((GRAZING,), self.azimuths).evaluate(brdf)
        if (albedo > GAIN * np.maximum(self.albedos.max(axis=0), 1)).any():
            return f"more light is reflected at {GRAZING:g}° than arrives"
        if len(albedo) == 3 and self._find_colour_difference(albedo) > OTHER:
            return f"the colour at {GRAZING:g}° is not the material's"
        return ""

    def _find_colour_difference(self, colour: Array) -> float:
        """Return ΔE2000 between a colour (3,) and the nearest of the mixtures with grey.

        The mixtures are those of the material's own colours.
        """
        luminance = colour @ LUMINANCE
        own = np.maximum(self.albedos, 0)
        own = own / np.maximum(own @ LUMINANCE, 1e-9)[:, None]
        grey = np.linspace(0, 1, MIXTURES)[:, None, None]
        mixtures = luminance * ((1 - grey) * own + grey)
        return float(ciede2000(mixtures, colour).min())
