"""Values per colour channel or wavelength, as the spectrum type of the current variant.

A class here has `mean(corners, si)`: the mean of stored rows of values, weighted by the `corners`
(row, share), as a spectrum at the wavelengths of the rays `si`. Rows may be negative, so that noise
about 0 averages out; a mean below 0 becomes 0, as in `Measured.eval`.
"""

import numpy as np

from brdfkit.core.colours import LUMINANCE, import_colour
from brdfkit.mitsuba_bridge.arrays import Nodes, Rows, find_bracket


def make_channels(values, wavelengths=None):
    """The `Colours` of rows `values` (n, 3), linear sRGB, or (n, 1), achromatic.

    With `wavelengths` (channels,) [nm], the `Wavelengths` of rows (n, channels).
    """
    if wavelengths is not None:
        return Wavelengths(values, wavelengths)
    return Colours(np.broadcast_to(values, (len(values), 3)))


class Colours:
    """Rows of linear sRGB."""

    def __init__(self, values):
        self.rows, self.spectrum = Rows(values), make_rgb_spectrum()

    def mean(self, corners, si):
        import drjit as dr
        import mitsuba as mi

        rgb = sum(share * self.rows.at(row, mi.Color3f) for row, share in corners)
        return self.spectrum(dr.maximum(rgb, 0), si)


def make_rgb_spectrum():
    """A function (rgb, si) → spectrum of a reflectance in linear sRGB, in the current variant."""
    import drjit as dr
    import mitsuba as mi

    if mi.is_monochromatic:
        return lambda rgb, si: mi.Color1f(dr.dot(rgb, mi.Color3f(LUMINANCE.tolist())))
    return SmoothSpectrum() if mi.is_spectral else lambda rgb, si: rgb


def make_rgb_emission():
    """A function (rgb, it) → spectrum of a radiance in linear sRGB, in the current variant.

    (1, 1, 1) has the spectrum of the white point, D65.
    """
    spectrum, light = make_rgb_spectrum(), make_white_light()
    return lambda rgb, it: spectrum(rgb, it) * light(it)


def make_white_light():
    """A function (interaction) → the factor by which the spectrum of a reflectance becomes light.

    It is the spectrum of D65 in spectral variants, 1 in the others.
    """
    import mitsuba as mi

    if not mi.is_spectral:
        return lambda it: 1
    daylight = mi.Texture.D65(1.0)

    def spectrum(it):
        si = mi.SurfaceInteraction3f()  # a texture takes no other interaction
        si.wavelengths = it.wavelengths
        return mi.unpolarized_spectrum(daylight.eval(si))

    return spectrum


class SmoothSpectrum:
    """A function (rgb, si) → spectrum of a linear sRGB colour in a spectral variant.

    It is the sum of three basis spectra, times R, G and B: linear, so that a mean of colours has
    the mean of their spectra, and exact under D65. [Mallett & Yuksel 2019]
    """

    def __init__(self):
        basis = import_colour().recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
        self.first, self.step = float(basis.shape.start), float(basis.shape.interval)
        self.count, self.basis = len(basis.values), Rows(basis.values)

    def __call__(self, rgb, si):
        import drjit as dr
        import mitsuba as mi

        spectrum = mi.UnpolarizedSpectrum(0)
        for k, wavelength in enumerate(si.wavelengths):
            lower, upper, t = find_bracket((wavelength - self.first) / self.step, self.count)
            basis = [self.basis.at(node, mi.Color3f) for node in (lower, upper)]
            spectrum[k] = dr.dot(rgb, dr.lerp(*basis, t))
        return dr.maximum(spectrum, 0)


class Wavelengths:
    """Rows of values at measured wavelengths, linear between these, constant beyond."""

    def __init__(self, values, wavelengths):
        order = np.argsort(wavelengths)
        self.count = len(order)
        self.nodes = Nodes(np.asarray(wavelengths, float)[order])
        self.values = Rows(values[:, order].ravel())

    def mean(self, corners, si):
        import drjit as dr
        import mitsuba as mi

        corners, spectrum = list(corners), mi.UnpolarizedSpectrum(0)
        for k, wavelength in enumerate(si.wavelengths):
            *nodes, t = self.nodes.find_bracket(wavelength)
            means = [self._mean(corners, node) for node in nodes]
            spectrum[k] = dr.lerp(*means, t)
        return spectrum

    def _mean(self, corners, node):
        """The mean at the measured wavelength of index `node`."""
        import drjit as dr

        values = (share * self.values.at(row * self.count + node) for row, share in corners)
        return dr.maximum(sum(values), 0)
