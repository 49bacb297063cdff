"""Decodes neural networks that represent measured BRDFs [Sztrajman et al. 2021] into tables."""

from functools import cache

import numpy as np

from brdfkit.materials.measured import Measured
from brdfkit.model.samples.table import Table

CELLS = 30, 30, 60  # of the tables to which the claims fit models: θ_h, θ_d, φ_d
WEIGHTS = 675  # of a network with layers of 6, 21, 21 and 3 numbers, biases included


def evaluate_network(weights, theta_h, theta_d, phi_d):
    """Return the BRDF (n, 3) [sr⁻¹] of a network at half and difference angles (n,) [rad].

    The network takes the half and the difference vector, has two layers of 21 with ReLU, and its
    result is ln(1 + f).
    """
    half = np.sin(theta_h), 0 * theta_h, np.cos(theta_h)
    difference = np.sin(theta_d) * np.cos(phi_d), np.sin(theta_d) * np.sin(phi_d), np.cos(theta_d)
    x = np.stack([*half, *difference], axis=1)
    k1, b1, k2, b2, k3, b3 = np.split(weights, np.cumsum([126, 21, 441, 21, 63]))
    x = np.maximum(x @ k1.reshape(6, 21) + b1, 0)
    x = np.maximum(x @ k2.reshape(21, 21) + b2, 0)
    return np.maximum(np.expm1(x @ k3.reshape(21, 3) + b3), 0)


def decode_network(weights, shape):
    """Return the table of a network's BRDF, at the centres of shape (θ_h, θ_d, φ_d) cells.

    Cells with a direction below the surface are NaN.
    """
    table = Table(np.full((*shape, 3), np.nan))
    wi, wo = table.directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    angles = (a[above] for a in np.meshgrid(*table.centres, indexing="ij"))
    table.values[above] = evaluate_network(weights, *angles)
    return table


@cache
def load_neural_material(sources, name):
    """Return the neural reconstruction of a material of MERL, as a measured table."""
    with np.load(sources.find_file("nbrdf_derived/merl_nbrdf.npz")) as networks:
        return Measured.from_table(decode_network(networks[name], CELLS).values, name=name)
