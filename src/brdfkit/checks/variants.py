"""Spectra of Mitsuba's current variant as arrays: RGB, one channel, or fixed wavelengths."""

import numpy as np

from brdfkit.core.colours import LUMINANCE, RGB, import_colour
from brdfkit.materials.measured.spectrum_to_rgb import wavelengths

WAVELENGTHS = (450.0, 520.0, 590.0, 650.0)  # nm, at which spectral variants are checked


def columns(spectrum, n):
    """The channels (channels, n) of a spectrum of the variant, without its polarisation."""
    import mitsuba as mi

    found = np.array(mi.unpolarized_spectrum(spectrum), float)
    return np.broadcast_to(found.reshape(len(found), -1), (len(found), n))


def in_variant(values, material):
    """`values` (n, c) of a `Measured` in the channels of the current variant, (n, channels).

    In a spectral variant a colour is a sum of three basis spectra [Mallett & Yuksel 2019].
    """
    import mitsuba as mi

    if values.shape[1] == 1:
        return np.broadcast_to(values, (len(values), len(WAVELENGTHS) if mi.is_spectral else 1))
    if material.channels != RGB:  # only in a spectral variant: in others, `rendered` is in RGB
        nm = wavelengths(material)
        order = np.argsort(nm)
        return np.stack([np.interp(WAVELENGTHS, nm[order], row) for row in values[:, order]])
    if mi.is_monochromatic:
        return (values @ LUMINANCE)[:, None]
    if not mi.is_spectral:
        return values
    basis = import_colour().recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
    spectra = [np.interp(WAVELENGTHS, basis.wavelengths, column) for column in basis.values.T]
    return values @ np.array(spectra)


def weights_of(bsdf, model):
    """A model's weights (lobes, channels), as the textures of its BSDF give them."""
    import drjit as dr
    import mitsuba as mi

    si = dr.zeros(mi.SurfaceInteraction3f, 1)
    if mi.is_spectral:
        si.wavelengths = WAVELENGTHS
    return np.stack([columns(bsdf.eval_attribute(n, si), 1)[:, 0] for n in model.weights()])
