"""Smoke: noise of many sizes within a ball, from 0 at its surface to 1.

White noise is smoothed to a spectrum of k^(-11/3), Kolmogorov's of turbulence [Kolmogorov 1941],
by the Fourier transform; seeded, so that a size has one smoke.
"""

import numpy as np

from brdfkit.volumes.made._grid import centres, filling_cube
from brdfkit.volumes.volume import Volume

SIZE = 64
BYTES = 62  # that a voxel takes while it is made
EXPONENT = -11 / 6  # of the amplitude: half of that of the power


def make(size, seed=0):
    """The smoke."""
    rng = np.random.default_rng(seed)
    to_world = filling_cube(size, 1.0)
    x, y, z = centres(size, to_world)
    shape = size[::-1]
    kz, ky = (np.fft.fftfreq(n, 1 / n) for n in shape[:2])
    kx = np.fft.rfftfreq(shape[2], 1 / shape[2])
    k = np.sqrt(kz[:, None, None] ** 2 + ky[:, None] ** 2 + kx**2)  # waves in the box
    spectrum = np.fft.rfftn(rng.standard_normal(shape)) * np.maximum(k, 1) ** EXPONENT
    noise = np.fft.irfftn(spectrum, shape, axes=(0, 1, 2))
    density = 0.5 + 0.35 * (noise - noise.mean()) / (noise.std() or 1)
    fade = np.clip(2 * (1 - np.sqrt(x**2 + y**2 + z**2)), 0, 1)  # to 0 at the radius 1
    values = (np.clip(density, 0, 1) * fade).astype(np.float32)
    return Volume(values, to_world, "smoke")
