"""Converts spectra between arrays and Mitsuba's current variant: RGB, mono, or wavelengths."""

import numpy as np

from brdfkit.core.array_types import FloatArray, JitColour, MitsubaObject
from brdfkit.core.colours import LUMINANCE, RGB, import_colour_package
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.spectrum_to_rgb import wavelengths
from brdfkit.model import Model

WAVELENGTHS = (450.0, 520.0, 590.0, 650.0)  # wavelengths [nm] of the checks in spectral variants


def stack_channels(spectrum: JitColour, n: int) -> FloatArray:
    """Convert `n` spectra of Mitsuba to an array (channels, n), without polarisation."""
    import mitsuba as mi

    channels = np.array(mi.unpolarized_spectrum(spectrum), float)
    return np.broadcast_to(channels.reshape(len(channels), -1), (len(channels), n))


def convert_to_variant_channels(values: FloatArray, material: Measured) -> FloatArray:
    """Convert values (n, c) of a measured material to the channels of the current variant.

    Returns an array (n, channels). In a spectral variant a colour becomes a sum of three basis
    spectra [Mallett & Yuksel 2019].
    """
    import mitsuba as mi

    if values.shape[1] == 1:
        return np.broadcast_to(values, (len(values), len(WAVELENGTHS) if mi.is_spectral else 1))
    if material.channels != RGB:  # it has wavelengths, in a spectral variant
        nm = wavelengths(material)
        order = np.argsort(nm)
        return np.stack([np.interp(WAVELENGTHS, nm[order], row) for row in values[:, order]])
    if mi.is_monochromatic:
        return (values @ LUMINANCE)[:, None]
    if not mi.is_spectral:
        return values
    basis = import_colour_package().recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
    spectra = [np.interp(WAVELENGTHS, basis.wavelengths, column) for column in basis.values.T]
    return values @ np.array(spectra)


def read_weights(bsdf: MitsubaObject, model: Model) -> FloatArray:
    """Read the weights (lobes, channels) of a model from the textures of its Mitsuba BSDF."""
    import drjit as dr
    import mitsuba as mi

    si: MitsubaObject = dr.zeros(mi.SurfaceInteraction3f, 1)
    if mi.is_spectral:
        si.wavelengths = WAVELENGTHS
    return np.stack([stack_channels(bsdf.eval_attribute(n, si), 1)[:, 0] for n in model.weights()])
