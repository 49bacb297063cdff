"""Synthetic smoke in a ball: turbulent noise from 0 to 1 that fades to 0 at the ball's surface.

A Fourier transform gives white noise Kolmogorov's power spectrum of turbulence, k^(-11/3) at the
wave number k [Kolmogorov 1941]. The noise is seeded, so that each size always has the same smoke.
"""

import numpy as np

from brdfkit.volumes.made._cube_grid import Size, make_cube_transform, voxel_centres
from brdfkit.volumes.volume import Volume

SIZE = 64
BYTES = 62  # memory per voxel that `make` needs
EXPONENT = -11 / 6  # of the wave number k in the amplitude: half of the power's exponent, -11/3


def make(size: Size, seed: int = 0) -> Volume:
    """Make the smoke with `size` (nx, ny, nz) voxels, from random numbers with this `seed`."""
    rng = np.random.default_rng(seed)
    to_world = make_cube_transform(size)
    x, y, z = voxel_centres(size, to_world)
    shape = size[::-1]
    kz, ky = (np.fft.fftfreq(n, 1 / n) for n in shape[:2])
    kx = np.fft.rfftfreq(shape[2], 1 / shape[2])
    k = np.sqrt(kz[:, None, None] ** 2 + ky[:, None] ** 2 + kx**2)  # wave numbers
    spectrum = np.fft.rfftn(rng.standard_normal(shape)) * np.maximum(k, 1) ** EXPONENT
    noise = np.fft.irfftn(spectrum, shape, axes=(0, 1, 2))
    density = 0.5 + 0.35 * (noise - noise.mean()) / (noise.std() or 1)
    fade = np.clip(2 * (1 - np.sqrt(x**2 + y**2 + z**2)), 0, 1)  # 0 at the ball's surface
    values = (np.clip(density, 0, 1) * fade).astype(np.float32)
    return Volume(values, to_world, "smoke")
