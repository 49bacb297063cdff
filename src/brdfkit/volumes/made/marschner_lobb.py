"""Marschner and Lobb's test signal, whose rings show errors of reconstruction and gradients.

    ρ(x, y, z) = (1 - sin(πz/2) + α (1 + ρ_r(√(x² + y²)))) / (2 (1 + α))
    ρ_r(r) = cos(2π f_M cos(πr/2)),   f_M = 6, α = 0.25

on [-1, 1]³ [Marschner & Lobb 1994]. At 40³ samples, as in the paper, most of its spectrum is just
below the Nyquist frequency.
"""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.volumes.made._cube_grid import Size, make_cube_transform, voxel_centres
from brdfkit.volumes.volume import Volume

SIZE = 40
BYTES = 13  # memory per voxel that `make` needs
FREQUENCY, ALPHA = 6.0, 0.25


def make(size: Size) -> Volume:
    """Make the volume of the Marschner-Lobb signal, with `size` (nx, ny, nz) voxels."""
    to_world = make_cube_transform(size)
    values = evaluate_signal(*voxel_centres(size, to_world)).astype(np.float32)
    return Volume(values, to_world, "marschner_lobb")


def evaluate_signal(x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Evaluate the Marschner-Lobb signal ρ at points (x, y, z), whose coordinates broadcast."""
    rings = np.cos(2 * np.pi * FREQUENCY * np.cos(np.pi * np.hypot(x, y) / 2))
    return (1 - np.sin(np.pi * z / 2) + ALPHA * (1 + rings)) / (2 * (1 + ALPHA))
