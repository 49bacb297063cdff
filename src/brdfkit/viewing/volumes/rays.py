"""`Rays`: samples of a volume along rays through its picture, and their opacities, in NumPy."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray, IntArray
from brdfkit.viewing.camera import Camera
from brdfkit.viewing.volumes.live_volume import LiveVolume

BINS = 128  # of the range of values; labels have one each
LARGEST_LABEL_COUNT = 256
LARGEST_STEP_COUNT = 192  # along a ray


@dataclass(frozen=True, eq=False)
class Rays:
    """Samples in the middles of equal parts of rays within the visible part of a volume's box.

    `values` and `gradients` (n, steps) are shares, 0 to 1, as in tables of a `LiveVolume`.
    `length` (n,) is that of the parts of a ray, 0 if it misses the box. `voxels` (n, steps, 3) are
    the nearest voxels (i, j, k). Values are counted in a
    number of `bins`, whose middles spread evenly over the shares.
    """

    values: FloatArray
    gradients: FloatArray
    length: FloatArray
    voxels: IntArray
    bins: int

    def select(self, mask: BoolArray) -> Rays:
        """Return the rays of a mask (n,)."""
        return replace(
            self,
            values=self.values[mask],
            gradients=self.gradients[mask],
            length=self.length[mask],
            voxels=self.voxels[mask],
        )

    def depths(self, table: AnyArray, extinction: float) -> FloatArray:
        """Return the optical depth (n, steps) of each sample.

        `table` is RGBA over values (m, 4), or over gradient magnitudes and values (k, m, 4).
        """
        a = table[..., 3] if table.ndim == 3 else table[None, :, 3]
        row = np.rint(self.gradients * (a.shape[0] - 1)).astype(int)
        column = np.rint(self.values * (a.shape[1] - 1)).astype(int)
        return extinction * a[row, column] * self.length[:, None]

    def sum_by_value(self, amounts: FloatArray) -> FloatArray:
        """Return the sum of amounts (n, steps) over all samples, by value (bins,)."""
        bins = np.rint(self.values * (self.bins - 1)).astype(int)
        return np.bincount(bins.ravel(), amounts.ravel(), self.bins).astype(float)

    def mean_contributions(self, depths: FloatArray) -> FloatArray:
        """Return what each value contributes to the mean opacity of the rays, (bins,)."""
        return self.sum_by_value(-_transmit(depths) * np.expm1(-depths)) / len(depths)

    def mean_slopes(self, depths: FloatArray, extinction: float) -> FloatArray:
        """Return the derivatives (bins,) of the mean opacity of the rays with respect to A."""
        return self._slope_by_value(np.exp(-depths.sum(axis=1, keepdims=True)), extinction)

    def mean_own_slopes(self, depths: FloatArray, extinction: float) -> FloatArray:
        """Return the derivatives (bins,) of what each value adds in front of all that is behind."""
        return self._slope_by_value(_transmit(depths), extinction)

    def _slope_by_value(self, transmittance: FloatArray, extinction: float) -> FloatArray:
        slopes = extinction * self.length[:, None] * transmittance
        return self.sum_by_value(np.broadcast_to(slopes, self.values.shape)) / len(slopes)


def _transmit(depths: FloatArray) -> FloatArray:
    """Return the transmittance in front of each sample (n, steps)."""
    return np.exp(depths - np.cumsum(depths, axis=1))


def cast_rays(
    live: LiveVolume,
    camera: Camera,
    places: FloatArray,
    aspect: float,
    clip: FloatArray,
    steps: int | None = None,
) -> Rays:
    """Sample a volume along the rays through `places` (n, 2), 0 to 1 from the top left.

    `aspect` is the picture's width over its height. `clip` (2, 3) has the corners of the visible
    part in the unit cube. A ray has `steps` samples, by default one for each voxel along the
    longest axis, up to `LARGEST_STEP_COUNT`.
    """
    from scipy.ndimage import map_coordinates

    volume = live.volume
    origin, direction = camera.cast_ray(places[:, 0], places[:, 1], aspect)
    to_cube = np.linalg.inv(volume.cube_to_world)
    o, d = to_cube[:3, :3] @ origin + to_cube[:3, 3], direction @ to_cube[:3, :3].T
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b = (clip[0] - o) / d, (clip[1] - o) / d
    near = np.maximum(np.nanmax(np.minimum(a, b), axis=1), 0)
    steps = steps or min(max(volume.size), LARGEST_STEP_COUNT)
    length = np.maximum(np.nanmin(np.maximum(a, b), axis=1) - near, 0) / steps
    t = near[:, None] + (np.arange(steps) + 0.5) * length[:, None]
    indices = (o + t[..., None] * d[:, None]) * volume.size - 0.5
    at = np.moveaxis(indices[..., ::-1], -1, 0)

    def look_up(voxels: AnyArray, order: int) -> FloatArray:
        return map_coordinates(voxels, at, np.float32, order, "nearest", prefilter=False)

    values = live.to_shares(look_up(volume.values, 0 if volume.labels else 1))
    gradients = np.clip(look_up(volume.gradient_magnitude, 0) / live.steepest, 0, 1)
    voxels = np.clip(np.rint(indices), 0, np.array(volume.size) - 1).astype(int)
    return Rays(values, gradients, length, voxels, len(list_values(live)))


def list_values(live: LiveVolume) -> FloatArray:
    """Return the volume's values (bins,) in the middles of the bins, rising."""
    if live.labels is None:
        return np.linspace(live.low, live.high, BINS)
    if len(live.labels) <= LARGEST_LABEL_COUNT:
        return live.labels.astype(float)
    return np.interp(
        np.linspace(0, len(live.labels) - 1, BINS), range(len(live.labels)), live.labels
    )
