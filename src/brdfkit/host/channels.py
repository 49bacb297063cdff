"""Values per colour channel or wavelength, as the spectrum type of the current variant.

A class here answers `mean(corners, si)`: the weighted mean of rows, given as (row, share), at the
wavelengths of the rays. Rows keep their sign, so that noise about 0 averages out; a mean below 0
counts as 0, as in `Measured.eval`.
"""

import numpy as np

from brdfkit.colours import LUMINANCE, colour_science
from brdfkit.host.arrays import Rows, bracket


def channels(values, wavelengths=None):
    """Rows `values` (n, channels): linear sRGB, achromatic, or, with `wavelengths` [nm], those."""
    import mitsuba as mi

    if wavelengths is not None:
        return Wavelengths(values, wavelengths)
    colours = np.broadcast_to(values, (len(values), 3))
    if mi.is_monochromatic:
        return Luminances(colours)
    return SpectralColours(colours) if mi.is_spectral else Colours(colours)


class Colours:
    """Linear sRGB in an RGB variant."""

    def __init__(self, values):
        self.rows = Rows(values)

    def mean(self, corners, si):
        import drjit as dr
        import mitsuba as mi

        return dr.maximum(sum(share * self.rows.at(row, mi.Color3f) for row, share in corners), 0)


class Luminances(Colours):
    """The luminance of linear sRGB, in a variant with one channel."""

    def mean(self, corners, si):
        import drjit as dr
        import mitsuba as mi

        return mi.Color1f(dr.dot(super().mean(corners, si), mi.Color3f(LUMINANCE.tolist())))


class SpectralColours(Colours):
    """Linear sRGB in a spectral variant: each colour times a basis spectrum.

    Linear, so that the mean of colours is that of their spectra, and exact under D65.
    I. Mallett & C. Yuksel, "Spectral primary decomposition for rendering with sRGB reflectance",
    EGSR 2019.
    """

    def __init__(self, values):
        colour = colour_science()

        super().__init__(values)
        basis = colour.recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
        self.first, self.step = float(basis.shape.start), float(basis.shape.interval)
        self.count, self.basis = len(basis.values), Rows(basis.values)

    def mean(self, corners, si):
        import drjit as dr
        import mitsuba as mi

        rgb, spectrum = super().mean(corners, si), mi.UnpolarizedSpectrum(0)
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
        self.nodes = Rows(np.asarray(wavelengths, float)[order])
        self.values = Rows(values[:, order].ravel())

    def mean(self, corners, si):
        import drjit as dr
        import mitsuba as mi

        corners, spectrum = list(corners), mi.UnpolarizedSpectrum(0)
        for k, wavelength in enumerate(si.wavelengths):
            position = self._position(wavelength)
            *nodes, t = bracket(position, self.count)
            means = [self._mean(corners, node) for node in nodes]
            spectrum[k] = dr.lerp(*means, t)
        return spectrum

    def _mean(self, corners, node):
        """At one of the measured wavelengths."""
        import drjit as dr

        values = (share * self.values.at(row * self.count + node) for row, share in corners)
        return dr.maximum(sum(values), 0)

    def _position(self, wavelength):
        """Where among the nodes, which need not be even: how many of the gaps lie below."""
        import drjit as dr

        position = 0
        for k in range(self.count - 1):
            low, high = self.nodes.at(k), self.nodes.at(k + 1)
            position = position + dr.clip((wavelength - low) / (high - low), 0, 1)
        return position
