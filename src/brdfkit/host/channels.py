"""Values per colour channel or wavelength, as the spectrum type of the current variant.

A class here answers `mean(corners, si)`: the weighted mean of rows, given as (row, share), at the
wavelengths of the rays. Rows keep their sign, so that noise about 0 averages out; a mean below 0
counts as 0, as in `Measured.eval`.
"""

import numpy as np

from brdfkit.colours import LUMINANCE, colour_science
from brdfkit.host.arrays import Nodes, Rows, bracket


def channels(values, wavelengths=None):
    """Rows `values` (n, channels): linear sRGB, achromatic, or, with `wavelengths` [nm], those."""
    if wavelengths is not None:
        return Wavelengths(values, wavelengths)
    return Colours(np.broadcast_to(values, (len(values), 3)))


class Colours:
    """Linear sRGB."""

    def __init__(self, values):
        self.rows, self.spectrum = Rows(values), spectrum_of_rgb()

    def mean(self, corners, si):
        import drjit as dr
        import mitsuba as mi

        rgb = sum(share * self.rows.at(row, mi.Color3f) for row, share in corners)
        return self.spectrum(dr.maximum(rgb, 0), si)


def spectrum_of_rgb():
    """A function (rgb, si) → the variant's spectrum of a reflectance in linear sRGB."""
    import drjit as dr
    import mitsuba as mi

    if mi.is_monochromatic:
        return lambda rgb, si: mi.Color1f(dr.dot(rgb, mi.Color3f(LUMINANCE.tolist())))
    return Smooth() if mi.is_spectral else lambda rgb, si: rgb


def emission_of_rgb():
    """The same of a radiance: that of 1, 1, 1 is the white point's."""
    spectrum, light = spectrum_of_rgb(), white()
    return lambda rgb, it: spectrum(rgb, it) * light(it)


def white():
    """A function of an interaction → the spectrum that a colour of light is multiplied by: D65's
    in spectral variants, 1 in the others."""
    import mitsuba as mi

    if not mi.is_spectral:
        return lambda it: 1
    daylight = mi.Texture.D65(1.0)

    def spectrum(it):
        si = mi.SurfaceInteraction3f()  # a texture takes no other interaction
        si.wavelengths = it.wavelengths
        return mi.unpolarized_spectrum(daylight.eval(si))

    return spectrum


class Smooth:
    """Linear sRGB in a spectral variant: each colour times a basis spectrum.

    Linear, so that the mean of colours is that of their spectra, and exact under D65.
    [Mallett & Yuksel 2019]
    """

    def __init__(self):
        basis = colour_science().recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
        self.first, self.step = float(basis.shape.start), float(basis.shape.interval)
        self.count, self.basis = len(basis.values), Rows(basis.values)

    def __call__(self, rgb, si):
        import drjit as dr
        import mitsuba as mi

        spectrum = mi.UnpolarizedSpectrum(0)
        for k, wavelength in enumerate(si.wavelengths):
            lower, upper, t = bracket((wavelength - self.first) / self.step, self.count)
            basis = [self.basis.at(node, mi.Color3f) for node in (lower, upper)]
            spectrum[k] = dr.dot(rgb, dr.lerp(*basis, t))
        return dr.maximum(spectrum, 0)


class Wavelengths:
    """Measured wavelengths in a spectral variant: linear between them, constant beyond."""

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
            *nodes, t = self.nodes.bracket(wavelength)
            means = [self._mean(corners, node) for node in nodes]
            spectrum[k] = dr.lerp(*means, t)
        return spectrum

    def _mean(self, corners, node):
        """At one of the measured wavelengths."""
        import drjit as dr

        values = (share * self.values.at(row * self.count + node) for row, share in corners)
        return dr.maximum(sum(values), 0)
