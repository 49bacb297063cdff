"""Reads files of ASAM OpenMATERIAL 3D: a material, and the table of its BRDF."""

import json

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from brdfkit.core.colours import compute_rgb_weights
from brdfkit.core.geometry.directions import to_angles


def find_table(material):
    """Return the path of the one table that a material names."""
    (name,) = json.loads(material.read_text())["materialProperties"]["brdfUris"]
    return material.with_name(name)


def evaluate(table, wi, wo):
    """Return the BRDF (n, 3) in sr⁻¹, linear between the rows, whose spectra become linear sRGB."""
    brdf = json.loads(table.read_text())["brdf"]
    rows = np.array(brdf["lookupTable"])
    assert rows[:, :4].tolist() == sorted(rows[:, :4].tolist())
    axes = [np.unique(column) for column in rows[:, :4].T]
    np.testing.assert_array_equal(axes[0], brdf["wavelengths"])
    values = RegularGridInterpolator(axes, rows[:, 4].reshape([len(axis) for axis in axes]))
    (theta_i, phi_i), (theta_o, phi_o) = to_angles(wi), to_angles(wo)
    angles = theta_i, theta_o, np.mod(phi_o - phi_i, 2 * np.pi)
    # Points beyond the last node have its value
    angles = [np.clip(x, *axis[[0, -1]]) for x, axis in zip(angles, axes[1:], strict=True)]
    places = [np.column_stack([np.full(len(wi), nm), *angles]) for nm in axes[0]]
    spectra = np.stack([values(place) for place in places], axis=1)
    return spectra @ compute_rgb_weights(axes[0] * 1e9, table.name)
