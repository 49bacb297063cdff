"""Evaluates an environment emitter at NumPy's directions, in linear sRGB in any variant."""

from collections.abc import Callable
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, MitsubaObject
from brdfkit.core.jit.padding import pad

WAVELENGTHS = 96  # evenly spaced wavelengths at which an emitter is evaluated in spectral variants


def make_radiance_function(emitter: MitsubaObject) -> Callable[[FloatArray], FloatArray]:
    """Return a function that evaluates an environment emitter in NumPy, in any variant.

    It takes unit vectors (n, 3), and returns the radiance (n, 3) from there in linear sRGB.
    """
    import drjit as dr
    import mitsuba as mi

    def radiance(directions: FloatArray) -> FloatArray:
        si = dr.zeros(mi.SurfaceInteraction3f, len(directions))
        towards = np.ascontiguousarray(-directions.T, np.float32)
        si.wi = mi.Vector3f(*(pad(component) for component in towards))
        if mi.is_spectral:
            value = _integrate_spectrum(emitter, si)
        else:
            value = np.array(mi.unpolarized_spectrum(emitter.eval(si)), float).T
        # A uniform emitter returns one value for all directions, and mono variants one channel
        return np.broadcast_to(value, (len(directions), 3))

    return radiance


def _integrate_spectrum(emitter: MitsubaObject, si: MitsubaObject) -> FloatArray:
    """Integrate an emitter's spectrum at `si` to radiance (n, 3) in linear sRGB."""
    import mitsuba as mi

    first, last = float(mi.MI_CIE_MIN), float(mi.MI_CIE_MAX)
    each = len(si.wavelengths)
    wavelengths = first + (np.arange(WAVELENGTHS) + 0.5) / WAVELENGTHS * (last - first)
    total: Any = 0.0
    for few in wavelengths.reshape(-1, each):
        si.wavelengths = type(si.wavelengths)(*few.tolist())
        value = mi.unpolarized_spectrum(emitter.eval(si))
        total = total + np.array(mi.spectrum_to_srgb(value, si.wavelengths), float).T
    return total * (last - first) / (WAVELENGTHS // each)
