"""Converts values per colour channel or wavelength to the spectrum type of the current variant.

`Colours` and `Wavelengths` have `average_rows(corners, si)`: the mean of stored rows of values,
weighted by the `corners` (row, share), as a spectrum at the wavelengths of the rays `si`. Rows may
be negative, so that noise about 0 averages out; a mean below 0 becomes 0, as in `Measured.eval`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, JitColour, JitFloat, JitInt, MitsubaObject
from brdfkit.core.colours import LUMINANCE, import_colour_package
from brdfkit.mitsuba_bridge.arrays import Nodes, Rows, find_bracket


def make_channels(values: AnyArray, wavelengths: ArrayLike | None = None) -> Colours | Wavelengths:
    """Return the `Colours` of rows `values` (n, 3), linear sRGB, or (n, 1), achromatic.

    With `wavelengths` (channels,) [nm], return the `Wavelengths` of rows (n, channels).
    """
    if wavelengths is not None:
        return Wavelengths(values, wavelengths)
    return Colours(np.broadcast_to(values, (len(values), 3)))


class Colours:
    """Rows of linear sRGB, whose mean becomes a spectrum."""

    def __init__(self, values: AnyArray) -> None:
        self.rows, self.spectrum = Rows(values), make_rgb_spectrum()

    def average_rows(
        self, corners: Iterable[tuple[JitInt, JitFloat]], si: MitsubaObject
    ) -> JitColour:
        import drjit as dr
        import mitsuba as mi

        rgb = sum(share * self.rows.at(row, mi.Color3f) for row, share in corners)
        return self.spectrum(dr.maximum(rgb, 0), si)


def make_rgb_spectrum() -> Callable[[Any, Any], Any]:
    """Return a function (rgb, si) → spectrum of a reflectance for the current variant."""
    import drjit as dr
    import mitsuba as mi

    if mi.is_monochromatic:
        return lambda rgb, si: mi.Color1f(dr.dot(rgb, mi.Color3f(LUMINANCE.tolist())))
    return SmoothSpectrum() if mi.is_spectral else lambda rgb, si: rgb


def make_rgb_emission() -> Callable[[Any, Any], Any]:
    """Return a function (rgb, it) → spectrum of a radiance in linear sRGB, for the current variant.

    (1, 1, 1) has the spectrum of the white point, D65.
    """
    spectrum, light = make_rgb_spectrum(), make_white_light()
    return lambda rgb, it: spectrum(rgb, it) * light(it)


def make_white_light() -> Callable[[Any], Any]:
    """Return a function (interaction) → factor that turns a reflectance's spectrum into light.

    It is the spectrum of D65 in spectral variants, 1 in the others.
    """
    import mitsuba as mi

    if not mi.is_spectral:
        return lambda it: 1
    daylight: Any = mi.Texture.D65(1.0)

    def evaluate_daylight(it: MitsubaObject) -> JitColour:
        si = mi.SurfaceInteraction3f()  # Mitsuba's textures take no other kind of interaction
        si.wavelengths = it.wavelengths
        return mi.unpolarized_spectrum(daylight.eval(si))

    return evaluate_daylight


class SmoothSpectrum:
    """A function (rgb, si) → spectrum of a linear sRGB colour in a spectral variant.

    It is the sum of three basis spectra, times R, G and B. Since it is linear, a mean of colours
    has the mean of their spectra. Under D65 the spectrum has the colour exactly.
    [Mallett & Yuksel 2019]
    """

    def __init__(self) -> None:
        basis = import_colour_package().recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
        self.first, self.step = float(basis.shape.start), float(basis.shape.interval)
        self.count, self.basis = len(basis.values), Rows(basis.values)

    def __call__(self, rgb: JitColour, si: MitsubaObject) -> JitColour:
        import drjit as dr
        import mitsuba as mi

        spectrum = mi.UnpolarizedSpectrum(0)
        for k, wavelength in enumerate(si.wavelengths):
            lower, upper, t = find_bracket((wavelength - self.first) / self.step, self.count)
            first, second = (self.basis.at(node, mi.Color3f) for node in (lower, upper))
            spectrum[k] = dr.dot(rgb, dr.lerp(first, second, t))
        return dr.maximum(spectrum, 0)


class Wavelengths:
    """Rows of values at measured wavelengths, linear between these and constant beyond."""

    def __init__(self, values: AnyArray, wavelengths: ArrayLike) -> None:
        order = np.argsort(wavelengths)
        self.count = len(order)
        self.nodes = Nodes(np.asarray(wavelengths, float)[order])
        self.values = Rows(values[:, order].ravel())

    def average_rows(
        self, corners: Iterable[tuple[JitInt, JitFloat]], si: MitsubaObject
    ) -> JitColour:
        import drjit as dr
        import mitsuba as mi

        corners, spectrum = list(corners), mi.UnpolarizedSpectrum(0)
        for k, wavelength in enumerate(si.wavelengths):
            lower, upper, t = self.nodes.find_bracket(wavelength)
            first, second = (self._average_at_node(corners, node) for node in (lower, upper))
            spectrum[k] = dr.lerp(first, second, t)
        return spectrum

    def _average_at_node(self, corners: Iterable[tuple[JitInt, JitFloat]], node: JitInt) -> Any:
        """Return the mean of the stored values at one of the measured wavelengths, by its index."""
        import drjit as dr

        values = (share * self.values.at(row * self.count + node) for row, share in corners)
        return dr.maximum(sum(values), 0)
