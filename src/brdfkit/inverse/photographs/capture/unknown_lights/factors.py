"""Divides photographs of a matte object into lights and normals, both up to a matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.inverse.photographs.capture.diagnosis.lambert import Sample, fit_lambert

ROUNDS = 60  # of fits with weights that let pixels of another albedo count less
SMALLEST_EIGENVALUE = 0.02  # share of the largest one, for a matrix that should be positive
ZERO = 1e-12


@dataclass(frozen=True, eq=False)
class Factors:
    """Lights and scaled normals of a sample, up to a matrix A: the true ones are L A⁻¹ and A B.

    `lights` (lights, 3): L; `normals` (n, 3): B of each pixel; `mask` (height, width): the n
    pixels; `lit` (n,): which pixels few shadows reach.
    """

    lights: FloatArray
    normals: FloatArray
    mask: BoolArray
    lit: BoolArray


def factorise(sample: Sample) -> Factors:
    """Return the `Factors` of a sample: singular vectors of the pixels that few shadows reach.

    Then Lambert's law is fitted to all pixels by these lights, without shadows and highlights.
    """
    median = np.median(sample.values, axis=0)
    share = np.where(median > 0, sample.values.min(axis=0) / np.maximum(median, ZERO), 0)
    lit: BoolArray = (share >= np.median(share)) & (median > 0)
    u, scale, _ = np.linalg.svd(sample.values[:, lit], full_matrices=False)
    lights = u[:, :3] * scale[:3] / np.sqrt(lit.sum())
    normals = fit_lambert(sample.values, sample.counted, lights).scaled_normals
    dark = np.linalg.norm(normals, axis=1) < ZERO
    normals[dark] = normals[lit].mean(axis=0)
    return Factors(lights, normals, sample.mask, lit & ~dark)


def equalise_albedos(normals: FloatArray) -> FloatArray:
    """Return a matrix C (3, 3) with which most of the vectors C b have about the same length.

    The lengths are |C b|² = bᵀ Q b with Q = Cᵀ C, whose numbers are fitted to bᵀ Q b = 1, with
    weights that let vectors of another length count less [Hayakawa 1994].
    """
    whitening = np.linalg.cholesky(np.linalg.inv(normals.T @ normals / len(normals)))
    x, y, z = (normals @ whitening).T
    equations = np.stack([x * x, y * y, z * z, 2 * x * y, 2 * x * z, 2 * y * z], axis=1)
    weights: FloatArray = np.ones(len(equations))
    q: FloatArray = np.zeros(6)
    for _ in range(ROUNDS):
        q = np.linalg.lstsq(equations * weights[:, None], weights, rcond=None)[0]
        residual = equations @ q - 1
        spread = 1.48 * np.median(np.abs(residual)) + 1e-6
        weights = 1 / (1 + (residual / (2 * spread)) ** 2)
    matrix = np.array([[q[0], q[3], q[4]], [q[3], q[1], q[5]], [q[4], q[5], q[2]]])
    values, vectors = np.linalg.eigh(matrix)
    values = np.maximum(values, SMALLEST_EIGENVALUE * max(values.max(), ZERO))
    root: FloatArray = (vectors * np.sqrt(values)) @ vectors.T @ whitening.T
    return root
