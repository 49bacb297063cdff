"""Photographs of a made, bumpy and glossy ball under known lights, of which everything is known."""

import numpy as np
from scipy.ndimage import gaussian_filter

import brdfkit as bk
from brdfkit.inverse.photographs import Lights, ObjectCapture
from brdfkit.model import labels

ALPHA, F0 = 0.2, 0.5
IRRADIANCE = np.array([3.0, 2.8, 2.5])


def make_lights(count, seed=1):
    """Distant lights all around, at most 60° from the camera."""
    rng = np.random.default_rng(seed)
    theta = np.arccos(1 - 0.5 * (np.arange(count) + rng.random(count)) / count)
    phi = 2 * np.pi * (0.618 * np.arange(count) % 1)
    across = np.sin(theta)
    directions = np.stack([across * np.cos(phi), across * np.sin(phi), np.cos(theta)], axis=1)
    return Lights(directions, np.tile(IRRADIANCE, (count, 1)))


def make_ball(side, seed=3):
    """The mask, the normals (n, 3) and the weights (n, 3, 2) of a ball."""
    rng = np.random.default_rng(seed)

    def pattern(width, channels=1):
        grid = rng.standard_normal((side, side, channels))
        smooth = gaussian_filter(grid, (width, width, 0), mode="wrap")
        return (smooth - smooth.min()) / np.ptp(smooth)

    y, x = np.mgrid[1 : -1 : side * 1j, -1 : 1 : side * 1j]
    mask = x**2 + y**2 < 0.85
    height = pattern(side / 10)[..., 0]
    by_row, by_column = np.gradient(0.3 * height / np.abs(np.gradient(height)[0]).max())
    z = np.sqrt(np.maximum(1 - x**2 - y**2, 0.01))
    normals = np.stack([x - by_column, y + by_row, z], axis=-1)[mask]
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    glossy = np.repeat(0.05 + 0.05 * pattern(side / 10), 3, axis=2)
    weights = np.stack([0.1 + 0.6 * pattern(side / 15, 3), glossy], axis=-1)[mask]
    return mask, normals, weights


def shade(normals, weights, to_light, irradiance, to_camera):
    """Radiances (lights, n, 3), by the models' `eval` in frames of our own."""
    up = np.where(np.abs(normals[:, 2:]) < 0.9, [[0, 0, 1.0]], [[1.0, 0, 0]])
    t = np.cross(up, normals)
    t /= np.linalg.norm(t, axis=1, keepdims=True)
    frame = np.stack([t, np.cross(normals, t), normals], axis=1)
    ggx = labels.model("ggx")
    lobes = [
        ggx(diffuse_reflectance=d, specular_reflectance=s, alpha_u=ALPHA, f0=F0)
        for d, s in ((1.0, 0.0), (0.0, 1.0))
    ]
    wi = np.einsum("nij,nj->ni", frame, to_camera)
    pictures = []
    for w, power in zip(to_light, irradiance, strict=True):
        wo = np.einsum("nij,nj->ni", frame, w)
        seen = (wi[:, 2] > 1e-3) & (wo[:, 2] > 1e-3)
        values = np.zeros((len(normals), 3))
        for k, lobe in enumerate(lobes):
            values[seen] += weights[seen, :, k] * lobe.eval(wi[seen], wo[seen])
        pictures.append(values * np.maximum(wo[:, 2:], 0) * power)
    return np.array(pictures)


def photograph_ball(side=40, count=12, noise=0.01, lights=None, seed=3, **fields):
    """(`ObjectCapture` with relative noise, true normals, true weights) of a made ball."""
    mask, normals, weights = make_ball(side, seed)
    lights = lights or make_lights(count)
    nothing = np.zeros((len(lights), len(normals), 3), np.float32)
    names = tuple(f"{k:02}.png" for k in range(len(lights)))
    capture = ObjectCapture("ball", nothing, mask, lights, names, normals=normals, **fields)
    to_light, irradiance = lights.illuminate(capture.points)
    clean = shade(normals, weights, to_light, irradiance, capture.to_camera)
    noisy = clean * (1 + noise * np.random.default_rng(seed).standard_normal(clean.shape))
    capture.values[:] = noisy
    return capture, normals, weights


def angles(a, b):
    """Angles [degrees] between unit vectors (n, 3)."""
    return np.degrees(np.arccos(np.clip((a * b).sum(axis=1), -1, 1)))


def fit_ball(capture, **how):
    """The maps of a made ball."""
    return bk.photographs.svbrdf(capture, fixed={"f0": F0}, **how)
