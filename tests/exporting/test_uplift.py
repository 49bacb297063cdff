"""Spectra of colours: possible reflectances, which become the colours again."""

import numpy as np
from six_fits import make_fit

from brdfkit.core.colours import compute_rgb_weights
from brdfkit.exporting.uplift import WAVELENGTHS, Spectral, compute_primaries
from brdfkit.materials.converting import draw_direction_pairs


def test_spectra_become_their_colours():
    spectra = compute_primaries()
    assert spectra.min() >= 0
    np.testing.assert_allclose(spectra.sum(axis=0), 1, atol=1e-6)
    weights = compute_rgb_weights(WAVELENGTHS, "spectrum")
    np.testing.assert_allclose(spectra @ weights, np.eye(3), atol=1e-12)
    model, pairs = make_fit("coat"), draw_direction_pairs(100)
    values = Spectral(model).eval(*pairs)
    np.testing.assert_allclose(values @ weights, model.eval(*pairs), rtol=1e-9)
