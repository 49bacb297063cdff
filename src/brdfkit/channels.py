"""Values per colour channel or wavelength, as the spectrum type of the current variant.

A class here answers `mean(corners, si)`: the weighted mean of rows, given as (row, share), at the
wavelengths of the rays.
"""

import numpy as np

from brdfkit.arrays import Rows, bracket
from brdfkit.colours import colour_science, luminance


def channels(values, wavelengths=None):
    """Rows `values` (n, channels): linear sRGB, achromatic, or, with `wavelengths` [nm], those."""
    import mitsuba as mi

    if wavelengths is not None:
        return Wavelengths(values, wavelengths)
    if mi.is_monochromatic:
        return Luminances(luminance(values)[:, None])
    colours = np.broadcast_to(values, (len(values), 3))
    return SpectralColours(colours) if mi.is_spectral else Colours(colours)


class Colours:
    """Linear sRGB in an RGB variant."""

    def __init__(self, values):
        self.rows = Rows(values)

    def mean(self, corners, si):
        import mitsuba as mi

        return sum(share * self.rows.at(row, mi.Color3f) for row, share in corners)


class Luminances(Colours):
    """In a variant with one channel."""

    def mean(self, corners, si):
        import mitsuba as mi

        return sum(share * self.rows.at(row, mi.Color1f) for row, share in corners)


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

        rgb, spectrum = super().mean(corners, si), mi.Spectrum(0)
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

        corners, spectrum = list(corners), mi.Spectrum(0)
        for k, wavelength in enumerate(si.wavelengths):
            position = self._position(wavelength)
            lower, upper, t = bracket(position, self.count)
            spectrum[k] = sum(
                share
                * dr.lerp(
                    self.values.at(row * self.count + lower),
                    self.values.at(row * self.count + upper),
                    t,
                )
                for row, share in corners
            )
        return spectrum

    def _position(self, wavelength):
        """Where among the nodes, which need not be even: how many of the gaps lie below."""
        import drjit as dr

        position = 0
        for k in range(self.count - 1):
            low, high = self.nodes.at(k), self.nodes.at(k + 1)
            position = position + dr.clip((wavelength - low) / (high - low), 0, 1)
        return position
