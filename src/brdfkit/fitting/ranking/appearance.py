"""Compares a fit with the measured material by a picture, and by its colour at grazing angles.

Measurements end some degrees above the horizon, where a fit goes on by its formula. There light is
reflected at the surface more and more, without a colour: what is seen lies between a colour of the
material and grey, in the eye's measure. A fit that is elsewhere has a coloured rim.
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
Brdf = Callable[[Array, Array], Array]  # (wi, wo) → (n, channels)

# Angles of incidence of the material's colours, as far as it was measured; and of a fit's that is
# compared to them [degrees]
ANGLES, GRAZING = (15.0, 30.0, 45.0, 60.0, 75.0), 85.0
# Of each pixel, by the light and as many by the material: more of them tell models apart no better
DIRECTIONS = 16
# So far from all mixtures with grey, of so many for each colour, a colour is another [ΔE2000]: fits
# that look right have up to 3.9, those with a coloured rim 5.8 to 18
OTHER, MIXTURES = 5.0, 21
DARKEST = 1 / 255  # the least brightness of a picture, where a material is black
GAIN = 1.05  # times the light that arrives: fits of bright metals, whose measurements reach 1


class Appearance:
    """The pixels and colours of a measured material, with which its fits are compared.

    `data`: the `Measured`; `samples`: those of it that are fitted; directions at or beyond
    `max_angle` [degrees] to the normal are not in the picture. `seed`: not that of the pixels to
    which a `Picture` fits.
    """

    def __init__(self, data: Measured, samples: Samples, max_angle: float, seed: int):
        brdf = data.rgb.eval
        self.pixels = draw_pixels(tuple(LIGHTS), brdf, max_angle, seed, directions=DIRECTIONS)
        self.azimuths = (0.0, np.pi / 2) if data.anisotropic else ISOTROPIC_AZIMUTHS
        end = samples.largest_angle
        angles = [angle for angle in ANGLES if angle <= end] or [end]
        self.albedos = make_albedo_pixels(tuple(angles), self.azimuths).look(brdf)

    def picture_error(self, brdf: Brdf) -> float:
        """Return the RMS difference of a BRDF's sRGB pixels from the measured ones.

        It is divided by the brightest measured pixel.
        """
        pixels, shown = self.pixels, to_srgb(self.pixels.values)
        apart = to_srgb(np.nan_to_num(pixels.look(brdf))) - shown
        error = math.sqrt(np.average((apart**2).mean(axis=1), weights=pixels.weights))
        return error / max(find_peak(shown[None]), DARKEST)

    def find_doubt(self, brdf: Brdf) -> str:
        """Return a clause on an implausible albedo or colour of a BRDF at 85°, or "" for none."""
        (albedo,) = make_albedo_pixels((GRAZING,), self.azimuths).look(brdf)
        if (albedo > GAIN * np.maximum(self.albedos.max(axis=0), 1)).any():
            return f"more light is reflected at {GRAZING:g}° than arrives"
        if len(albedo) == 3 and self._difference(albedo) > OTHER:
            return f"the colour at {GRAZING:g}° is not the material's"
        return ""

    def _difference(self, colour: Array) -> float:
        """Return the ΔE2000 of a colour (3,) from the nearest mixture of material and grey."""
        luminance = colour @ LUMINANCE
        own = np.maximum(self.albedos, 0)
        own = own / np.maximum(own @ LUMINANCE, 1e-9)[:, None]
        grey = np.linspace(0, 1, MIXTURES)[:, None, None]
        mixtures = luminance * ((1 - grey) * own + grey)
        return float(ciede2000(mixtures, colour).min())
