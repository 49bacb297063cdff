"""Turns colours into spectra of reflectance, for targets that hold spectra alone.

A colour is the sum of three spectra, of red, green and blue, times its R, G and B, as in brdfkit's
spectral renderings [Mallett & Yuksel 2019]. They are from 0 to 1 and add up to 1, so that no colour
reflects more light than it should. Under D65 they become the colours again that they stand for.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.colours import compute_rgb_weights, import_colour_package
from brdfkit.model import Model

WAVELENGTHS = tuple(float(nm) for nm in range(400, 701, 20))


@dataclass(frozen=True)
class Spectral:
    """A model whose values are spectra, of its own wavelengths or of its colours.

    It can be written as a spectral material.
    """

    model: Model

    @property
    def name(self) -> str:
        """The name of the model."""
        return self.model.name

    @property
    def wavelengths(self) -> tuple[float, ...]:
        """The wavelengths of the values [nm]."""
        return self.model.wavelengths or WAVELENGTHS

    @property
    def changes(self) -> tuple[str, ...]:
        """In words, that colours became spectra, if they did."""
        words = f"linear sRGB became spectra of {len(WAVELENGTHS)} wavelengths"
        return () if self.model.wavelengths else (words,)

    def eval(self, wi: FloatArray, wo: FloatArray) -> FloatArray:
        """Return the BRDF [sr⁻¹] (n, wavelengths) for directions to light and viewer, (n, 3)."""
        values = self.model.eval(wi, wo)
        if self.model.wavelengths:
            return values
        return np.broadcast_to(values, (len(values), 3)) @ compute_primaries()


@cache
def compute_primaries() -> FloatArray:
    """Compute the spectra of red, green and blue (3, wavelengths).

    >>> compute_primaries().sum(axis=0).round(6).tolist() == [1.0] * len(WAVELENGTHS)
    True
    """
    basis = import_colour_package().recovery.MSDS_BASIS_FUNCTIONS_sRGB_MALLETT2019
    spectra = np.array([np.interp(WAVELENGTHS, basis.wavelengths, s) for s in basis.values.T])
    # So few wavelengths change the colours by 2 %, which is undone
    return np.linalg.solve(spectra @ compute_rgb_weights(WAVELENGTHS, "spectrum"), spectra)
