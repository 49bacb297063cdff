"""The radiance of an environment emitter of Mitsuba's by direction, as NumPy arrays."""

import numpy as np

from brdfkit.core.jit.padding import pad

WAVELENGTHS = 96  # at which a spectral variant is asked, evenly


def radiance_of(emitter):
    """A function of unit vectors (n, 3) → radiance (n, 3) in linear sRGB, from those directions."""
    import drjit as dr
    import mitsuba as mi

    def radiance(directions):
        si = dr.zeros(mi.SurfaceInteraction3f, len(directions))
        towards = np.ascontiguousarray(-directions.T, np.float32)
        si.wi = mi.Vector3f(*(pad(component) for component in towards))
        if mi.is_spectral:
            value = _through_the_spectrum(emitter, si)
        else:
            value = np.array(mi.unpolarized_spectrum(emitter.eval(si)), float).T
        return np.broadcast_to(value, (len(directions), 3))  # even light has one value, grey one

    return radiance


def _through_the_spectrum(emitter, si):
    """Radiance (n, 3) in linear sRGB, of an emitter's spectrum at the interactions `si`."""
    import mitsuba as mi

    first, last = float(mi.MI_CIE_MIN), float(mi.MI_CIE_MAX)
    each = len(si.wavelengths)
    wavelengths = first + (np.arange(WAVELENGTHS) + 0.5) / WAVELENGTHS * (last - first)
    total = 0.0
    for few in wavelengths.reshape(-1, each):
        si.wavelengths = type(si.wavelengths)(*few.tolist())
        value = mi.unpolarized_spectrum(emitter.eval(si))
        total = total + np.array(mi.spectrum_to_srgb(value, si.wavelengths), float).T
    return total * (last - first) / (WAVELENGTHS // each)
