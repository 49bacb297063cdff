"""Models measured at random directions, with and without noise, for tests of fits."""

import numpy as np

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles


def synthetic(model, n=3000, seed=0):
    """A model measured at random directions in and near the plane of incidence."""
    rng = np.random.default_rng(seed)
    wi = from_angles(rng.uniform(0, 1.5, n), rng.uniform(0, 2 * np.pi, n))
    near = wi * [-1, -1, 1] + rng.normal(0, 0.15, (n, 3))
    far = from_angles(rng.uniform(0, 1.5, n), rng.uniform(0, 2 * np.pi, n))
    wo = np.where((np.arange(n) % 2 == 0)[:, None], near, far)
    wo /= np.linalg.norm(wo, axis=1, keepdims=True)
    wo[:, 2] = np.abs(wo[:, 2])
    values = model.eval(wi, wo)
    channels = ("R", "G", "B") if values.shape[1] == 3 else ("Y",)
    return bk.Measured.from_samples(wi, wo, values, channels=channels, name="synthetic")


def noisy(model, n=400, seed=0, size=0.03):
    """A model measured with noise in proportion to its values."""
    clean = synthetic(model, n, seed)
    noise = np.exp(size * np.random.default_rng(seed).normal(size=clean.values.shape))
    wi, wo = clean.samples.wi, clean.samples.wo
    return bk.Measured.from_samples(wi, wo, clean.values * noise, channels=clean.channels)
