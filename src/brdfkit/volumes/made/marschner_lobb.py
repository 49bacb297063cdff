"""Marschner and Lobb's test signal: what reconstruction and gradients lose shows in its rings.

    ρ(x, y, z) = (1 - sin(πz/2) + α (1 + ρ_r(√(x² + y²)))) / (2 (1 + α))
    ρ_r(r) = cos(2π f_M cos(πr/2)),   f_M = 6, α = 0.25

on [-1, 1]³ [Marschner & Lobb 1994]. At 40³ samples, as in the paper, most of its spectrum is below
the Nyquist frequency, though near it.
"""

import numpy as np

from brdfkit.volumes.made._grid import centres, filling_cube
from brdfkit.volumes.volume import Volume

SIZE = 40
BYTES = 13  # that a voxel takes while it is made
FREQUENCY, ALPHA = 6.0, 0.25


def make(size):
    """The signal at the centres of the voxels."""
    to_world = filling_cube(size, 1.0)
    values = value(*centres(size, to_world)).astype(np.float32)
    return Volume(values, to_world, "marschner_lobb")


def value(x, y, z):
    """ρ, at any points."""
    rings = np.cos(2 * np.pi * FREQUENCY * np.cos(np.pi * np.hypot(x, y) / 2))
    return (1 - np.sin(np.pi * z / 2) + ALPHA * (1 + rings)) / (2 * (1 + ALPHA))


def gradient(x, y, z):
    """∇ρ (3, ...), at any points."""
    r = np.maximum(np.hypot(x, y), 1e-12)  # on the axis the slope is 0
    phase = 2 * np.pi * FREQUENCY * np.cos(np.pi * r / 2)
    by_r = np.sin(phase) * np.pi**2 * FREQUENCY * np.sin(np.pi * r / 2)
    scale = 2 * (1 + ALPHA)
    by_z = -np.pi / 2 * np.cos(np.pi * z / 2)
    return np.stack([ALPHA * by_r * x / r, ALPHA * by_r * y / r, by_z + 0 * r]) / scale
