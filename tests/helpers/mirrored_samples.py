"""Samples in the convention of some instruments: φo is counted from the mirror's side."""

import itertools

import numpy as np

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles

ANGLES = [*itertools.product((20, 40, 60), range(0, 76, 10), range(0, 360, 45))]


def mirrored_samples():
    """Return 192 samples of a model, whose highlight is towards the light."""
    theta_i, theta_o, phi_o = np.radians(ANGLES).T
    wi, wo = from_angles(theta_i, 0 * theta_i), from_angles(theta_o, phi_o)
    model = bk.models()["ggx"](alpha_u=0.2, diffuse_reflectance=0.2, specular_reflectance=0.5)
    values = np.repeat(model.eval(wi, wo)[:, :1], 3, axis=1)
    return bk.Measured.from_samples(wi, wo * [-1, -1, 1], values, name="mirrored")
