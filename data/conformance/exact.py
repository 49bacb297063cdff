"""Exact pictures of volumes: integrals along rays, piece by piece, in NumPy and SciPy alone.

A volume is the trilinear interpolant of its voxels, of labels the nearest; beyond the outermost
centres it stays as it is there, up to the faces of the outermost voxels, where it ends. Along a ray
that is a cubic between the planes through the centres. It is cut there, at its extrema, and where
it meets a corner of the transfer function, so that on each piece all is smooth. Gauss's nodes
integrate such a piece to 1e-9; `make.py` says how that was checked.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import map_coordinates

NODES = 8  # on each piece
HALVINGS = 55  # of a piece, to find where it meets a corner


@dataclass
class Grid:
    """Voxels (nz, ny, nx) in the box from `low`, with a `spacing` along x, y, z."""

    voxels: np.ndarray
    low: np.ndarray
    spacing: np.ndarray
    labels: bool = False

    @property
    def size(self):
        return np.array(self.voxels.shape[::-1])

    def __call__(self, points):
        """The values (...) at points (..., 3) within the box."""
        at = (points - self.low) / self.spacing - 0.5  # 0 is the first centre
        order = 0 if self.labels else 1
        at = np.moveaxis(at[..., ::-1], -1, 0)
        return map_coordinates(self.voxels.astype(float), at, order=order, mode="nearest")


@dataclass
class Rays:
    """Origins (n, 3) and one direction (3,) for all of them."""

    o: np.ndarray
    d: np.ndarray

    def __call__(self, t):
        """Points (n, m, 3) at distances (n, m)."""
        return self.o[:, None] + t[..., None] * self.d


def emission_absorption(grid, rays, optics, levels, behind, nodes=NODES):
    """Radiance (n, 3) and transmittance (n,): ∫ σ RGB T ds + T `behind`.

    `optics`: points → σ_t (...), RGB (..., 3); smooth between the `levels` of the grid's values.
    """
    t = pieces(grid, rays, levels)
    x, w, integral = quadrature(nodes)
    length = np.diff(t, axis=1)
    at = t[:, :-1, None] + length[..., None] * x
    sigma, rgb = optics(rays(at.reshape(len(t), -1)))
    sigma = sigma.reshape(at.shape) * length[..., None]
    rgb = rgb.reshape(*at.shape, 3)
    depth = sigma @ w  # of a piece; before it:
    before = np.cumsum(depth, axis=1) - depth
    light = sigma * np.exp(-(sigma @ integral.T) - before[..., None]) * w
    transmittance = np.exp(-depth.sum(axis=1))
    return (light[..., None] * rgb).sum(axis=(1, 2)) + transmittance[
        :, None
    ] * behind, transmittance


def largest(grid, rays):
    """The largest value (n,) along each ray, NaN beside the box."""
    t = pieces(grid, rays, [])
    values = grid(rays(t)).max(axis=1)
    return np.where(t[:, -1] > t[:, 0], values, np.nan)


def first_above(grid, rays, level):
    """The distance (n,) at which the value first rises above a level, NaN if it does not."""
    t = pieces(grid, rays, [level])
    middles = (t[:, 1:] + t[:, :-1]) / 2
    above = (grid(rays(middles)) > level) & (np.diff(t, axis=1) > 0)
    first = np.take_along_axis(t, above.argmax(axis=1)[:, None], 1)[:, 0]
    return np.where(above.any(axis=1), first, np.nan)


def pieces(grid, rays, levels):
    """Distances (n, m), rising, between which the value is smooth, monotone and between levels.

    Some are equal, of pieces that are not there; all are, of a ray beside the box.
    """
    near, far = box(grid, rays)
    planes = [near[:, None], far[:, None]]
    for axis in range(3):
        if rays.d[axis]:
            shift = 0 if grid.labels else 0.5
            at = grid.low[axis] + (np.arange(grid.size[axis]) + shift) * grid.spacing[axis]
            planes.append((at - rays.o[:, axis, None]) / rays.d[axis])
    t = within(near, far, planes)
    if grid.labels:
        return t
    t = within(near, far, [t, *extrema(grid, rays, t)])
    return within(near, far, [t, *(crossing(grid, rays, t, level) for level in levels)])


def box(grid, rays):
    """Where rays enter and leave the box; 0 and 0 where they miss it."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = (
            np.stack([grid.low, grid.low + grid.size * grid.spacing]) - rays.o[:, None]
        ) / rays.d
    near, far = np.nanmax(ends.min(axis=1), axis=1), np.nanmin(ends.max(axis=1), axis=1)
    return np.where(near < far, near, 0), np.where(near < far, far, 0)


def within(near, far, places):
    """All places (n, m) of some arrays, sorted, and moved to the ends if they lie beyond."""
    return np.sort(np.clip(np.concatenate(places, axis=1), near[:, None], far[:, None]), axis=1)


def extrema(grid, rays, t):
    """The extrema of the cubic on each piece, two arrays (n, m - 1); other places without one."""
    s = np.array([0.125, 0.375, 0.625, 0.875])
    low, length = t[:, :-1], np.diff(t, axis=1)
    values = grid(rays((low[..., None] + length[..., None] * s).reshape(len(t), -1)))
    _, c, b, a = np.moveaxis(
        values.reshape(*low.shape, 4) @ np.linalg.inv(np.vander(s, increasing=True)).T, -1, 0
    )
    # 3 a s² + 2 b s + c = 0, without a difference of equal numbers
    with np.errstate(all="ignore"):
        q = -(b + np.where(b < 0, -1, 1) * np.sqrt(b * b - 3 * a * c))
        roots = q / (3 * a), c / q
    return [low + length * np.clip(np.nan_to_num(s), 0, 1) for s in roots]


def crossing(grid, rays, t, level):
    """Where each monotone piece meets a level (n, m - 1); one of its ends if it does not."""
    low, high = t[:, :-1].copy(), t[:, 1:].copy()
    rises = grid(rays(high)) > level
    for _ in range(HALVINGS):
        middle = (low + high) / 2
        beyond = (grid(rays(middle)) > level) == rises
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    return low


def quadrature(n):
    """Gauss's nodes and weights on 0 to 1; a matrix from values at them to integrals up to them."""
    x, w = np.polynomial.legendre.leggauss(n)
    p = np.polynomial.legendre.legvander(x, n)
    # f is Σ (2 k + 1) / 2 (f, P_k) P_k; ∫ P_k from -1 is (P_k+1 - P_k-1) / (2 k + 1), P_-1 = -1
    below = np.column_stack([-np.ones(n), p[:, : n - 1]])
    integral = (p[:, 1:] - below) @ (p[:, :n] * w[:, None]).T / 2
    return (x + 1) / 2, w / 2, integral / 2
