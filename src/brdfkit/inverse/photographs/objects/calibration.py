"""Defines `Calibration`, what all pixels of an object share, and fits pixels with it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.jit.double_precision import to_scalar, to_vector
from brdfkit.inverse.photographs.maps.texel_parameters import TexelParameters
from brdfkit.inverse.photographs.objects.equations import Prior, Reflection
from brdfkit.inverse.photographs.objects.fit_pixels import Pixels, fit_pixels
from brdfkit.inverse.photographs.objects.photometric_stereo import estimate_normals
from brdfkit.inverse.photographs.objects.tile import Tile

DARK_OFFSET = 0.05  # δ as a share of the typical ratio of values to irradiance
# Scales of relative residuals, in their order: large ones first, because the robust loss has one
# minimum for large scales, and its start is near the right one of several for small scales
SCALES = 0.2, 0.1, 0.05
STEPS = 4  # steps at each scale
SCALE_OF_NOISE = 2.0  # the last scale is this many standard deviations of the residuals
SMALLEST_SCALE = 0.005
GLOSS_START = 0.05  # weight of each highlight at the start, as a share of the diffuse weight


@dataclass(frozen=True)
class Calibration:
    """What all pixels of an object share.

    parameters : the model, and which of its parameters are searched.
    shapes : the shape parameters by name.
    exposures : factors (k,) of the photographs' irradiances.
    dark_offset : what is added to values before errors are divided by them, per irradiance.
    noise : the standard deviation of relative residuals.
    usual_weights, spreads : the usual weights and their standard deviations (channels, lobes);
        these are infinite for the diffuse lobe.
    """

    parameters: TexelParameters
    shapes: dict[str, float]
    exposures: FloatArray
    dark_offset: float
    noise: float
    usual_weights: FloatArray
    spreads: FloatArray

    @property
    def reflection(self) -> Reflection:
        """The model with the shape parameters, as kernels need it."""
        shapes = {name: to_scalar(value) for name, value in self.shapes.items()}
        return Reflection(self.parameters.model, shapes, self.dark_offset)

    @property
    def scale(self) -> float:
        """The scale of relative residuals of the last search."""
        return max(SCALE_OF_NOISE * self.noise, SMALLEST_SCALE)

    @property
    def brightness(self) -> float:
        """The typical ratio of photographed values to irradiances."""
        return self.dark_offset / DARK_OFFSET

    def make_prior(self, normals: FloatArray | None = None, spread: float = 1.0) -> Prior:
        """Return the prior of the usual weights, and of expected normals (n, 3) if there are any.

        `spread` is the standard deviation [radians] from these. Residuals of a search are divided
        by a scale above the noise, and so are the deviations from what is expected.
        """
        factor = self.scale / self.noise
        weights, spreads = (
            [[to_scalar(value) for value in row] for row in values]
            for values in (self.usual_weights, self.spreads * factor)
        )
        expected = None if normals is None else to_vector(normals)
        return Prior(weights, spreads, expected, spread * factor)


def fit_from_start(tile: Tile, known: Calibration) -> Pixels:
    """Return the fitted pixels of a tile, from photometric stereo by ever smaller scales."""
    normals, albedos = estimate_normals(tile, known.brightness)
    lobes = len(known.parameters.lobes)
    weights = np.repeat(albedos[:, :, None], lobes, axis=2)
    weights[..., 1:] *= GLOSS_START
    pixels = Pixels(normals, weights, np.zeros(0), np.zeros(0))
    for scale in [s for s in SCALES if s > known.scale] or SCALES[:1]:
        pixels = fit_pixels(tile, known.reflection, pixels.normals, pixels.weights, scale, STEPS)
    return pixels
