"""Fits Lambert's law to photographs of an object, without its shadows and highlights.

A surface with the normal n and the albedo ρ has the value i_k = l_k · b with b = ρ n under the
light l_k, whose length is its intensity [Woodham 1980].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture

MOST_VALUES = 400_000  # of a sample
# Ranks of a pixel's values, as shares of all, between which shadows and highlights are rare
LOWEST_RANK, HIGHEST_RANK = 0.25, 0.85
FEWEST_RANKED = 7  # lights; with fewer all values count


@dataclass(frozen=True, eq=False)
class Sample:
    """Every so many-th pixel of an object, in grey.

    `values` (lights, n): mean of the channels; `counted` (lights, n): which of them are not lost;
    `mask` (height, width): the pixels among all those of the sample; `directions` (lights, 3);
    `intensities` (lights,): irradiances in the middle of the object, means of the channels.
    """

    values: FloatArray
    counted: BoolArray
    mask: BoolArray
    directions: FloatArray
    intensities: FloatArray

    @classmethod
    def take(cls, capture: ObjectCapture, most_pixels: float = np.inf) -> Sample:
        """Return a sample of an object with about `MOST_VALUES` values, or `most_pixels` pixels."""
        most = min(most_pixels, MOST_VALUES / len(capture.values))
        step = int(np.ceil(np.sqrt(max(1.0, capture.mask.sum() / most))))
        grid = np.zeros(capture.mask.shape, bool)
        grid[::step, ::step] = True
        chosen = np.flatnonzero(grid[capture.mask])
        counted = np.ones((len(capture.values), len(chosen)), bool)
        if capture.lost is not None:
            counted &= ~capture.lost[:, chosen].any(axis=2)
        values = capture.values[:, chosen].mean(axis=2, dtype=float)
        # The light of a lamp is taken to be the same everywhere as in the middle of the object
        _, irradiance = capture.lights.illuminate(np.zeros((1, 3)))
        return cls(
            values=values,
            counted=counted,
            mask=capture.mask[::step, ::step],
            directions=capture.lights.directions,
            intensities=irradiance.mean(axis=(1, 2)),
        )

    @property
    def scaled_lights(self) -> FloatArray:
        """The directions of the lights times their intensities (lights, 3)."""
        return self.directions * self.intensities[:, None]


@dataclass(frozen=True, eq=False)
class LambertFit:
    """Lambert's law, fitted to a `Sample`.

    `scaled_normals` (n, 3): albedo times normal; `used` (lights, n): which values were fitted;
    `unexplained`: the standard deviation of the values from the law, as a share of their standard
    deviation from their means over the lights, as a median of the pixels.
    """

    scaled_normals: FloatArray
    used: BoolArray
    unexplained: float


def fit_lambert(values: FloatArray, counted: BoolArray, lights: FloatArray) -> LambertFit:
    """Fit Lambert's law to values (lights, n), of which `counted` may be used.

    `lights` (lights, 3) are directions times intensities. The darkest and the brightest values of
    each pixel are left out.
    """
    used = counted.copy()
    count = len(values)
    if count >= FEWEST_RANKED:
        brightness = values / np.linalg.norm(lights, axis=1, keepdims=True)
        rank = brightness.argsort(axis=0).argsort(axis=0)
        used &= (rank >= LOWEST_RANK * count) & (rank < HIGHEST_RANK * count)
    outer = (lights[:, :, None] * lights[:, None, :]).reshape(count, 9)
    normal = (used.T.astype(float) @ outer).reshape(-1, 3, 3)
    normal += 1e-9 * np.trace(normal, axis1=1, axis2=2)[:, None, None] * np.eye(3) + 1e-12 * np.eye(
        3
    )
    b = np.linalg.solve(normal, ((used * values).T @ lights)[..., None])[..., 0]
    number = np.maximum(used.sum(axis=0), 1)
    residual = (used * (values - lights @ b.T) ** 2).sum(axis=0)
    mean = (used * values).sum(axis=0) / number
    variance = (used * (values - mean) ** 2).sum(axis=0)
    share = np.median(residual[variance > 0] / variance[variance > 0]) if variance.any() else 0.0
    return LambertFit(b, used, float(np.sqrt(share)))
