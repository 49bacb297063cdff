"""A table of BRDF values over half and difference angles, interpolated linearly along each axis.

The cells are those of the MERL database [Matusik et al. 2003]. The axis theta_h, the angle of the
half vector to the normal, is divided evenly in √theta_h, so that cells are small where highlights
are; the axes of the difference angles theta_d and phi_d are divided evenly. An anisotropic table
has the azimuth phi_h of the half vector as its first axis, divided evenly over the full circle. The
value of a cell belongs to its centre.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_half_difference, half_azimuth, to_half_difference
from brdfkit.core.geometry.multilinear import (
    find_bracket,
    find_periodic_bracket,
    list_corners,
    to_flat_index,
)

LARGEST = 1e30  # [sr⁻¹] largest value to be rendered, since single precision ends at 3e38


@dataclass(frozen=True, eq=False)
class Table:
    """A table of BRDF values over the half and difference angles, and their interpolation.

    `values`: the BRDF ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d, channels) in sr⁻¹, NaN in unknown
    cells. `phi_d_period`: range of phi_d [rad], π for a reciprocal table, otherwise 2π.

    >>> Table(np.full((9, 9, 18, 1), 1 / np.pi)).eval([[0, 0, 1.0]], [[0, 0, 1.0]])
    array([[0.31830989]])
    """

    values: AnyArray
    phi_d_period: float = np.pi

    @property
    def anisotropic(self) -> bool:
        """Whether the BRDF depends on the azimuth phi_h of the half vector."""
        return self.values.ndim == 5

    @property
    def shape(self) -> tuple[int, ...]:
        """The numbers of cells along the axes, ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d)."""
        return self.values.shape[:-1]

    @cached_property
    def centres(self) -> tuple[FloatArray, ...]:
        """The centres of the cells along each axis, ([phi_h,] theta_h, theta_d, phi_d) [rad]."""
        n_h, n_d, n_p = self.shape[-3:]
        centres = (
            ((np.arange(n_h) + 0.5) / n_h) ** 2 * np.pi / 2,
            (np.arange(n_d) + 0.5) / n_d * np.pi / 2,
            (np.arange(n_p) + 0.5) / n_p * self.phi_d_period,
        )
        if not self.anisotropic:
            return centres
        n_a = self.shape[0]
        return (np.arange(n_a) + 0.5) / n_a * 2 * np.pi, *centres

    @property
    def extents(self) -> FloatArray:
        """The amounts (n_theta_h, n_theta_d, 2) of angles and of solid angle in a cell.

        They are the extents of the cell by the two measures of `measures.py`, and do not depend on
        its azimuths.
        """
        n_h, n_d, n_p = self.shape[-3:]
        azimuths = n_p * (self.shape[0] if self.anisotropic else 1)
        theta_h, theta_d = (
            np.pi / 2 * edges
            for edges in ((np.arange(n_h + 1) / n_h) ** 2, np.arange(n_d + 1) / n_d)
        )
        angles = np.outer(np.diff(theta_h), np.diff(theta_d))
        # The solid angle: ∫ sinθ_h dθ_h times ∫ sinθ_d cosθ_d dθ_d between a cell's edges
        solid = np.outer(-np.diff(np.cos(theta_h)), np.diff(np.sin(theta_d) ** 2) / 2)
        return np.stack([angles, solid], axis=-1) * 2 * np.pi / azimuths

    def directions(self) -> tuple[FloatArray, FloatArray]:
        """Return the directions (wi, wo) at the centres of all cells, each (*shape, 3).

        Some of them are below the surface.
        """
        *phi_h, theta_h, theta_d, phi_d = np.meshgrid(*self.centres, indexing="ij")
        return from_half_difference(theta_h, theta_d, phi_d, *phi_h)

    def find_cells(self, wi: ArrayLike, wo: ArrayLike) -> tuple[IntArray, ...]:
        """Find the cells of direction pairs (n, 3); return one array of indices (n,) per axis."""
        theta_h, theta_d, phi_d = to_half_difference(wi, wo)
        places = [
            np.sqrt(theta_h / (np.pi / 2)),
            theta_d / (np.pi / 2),
            phi_d / self.phi_d_period % 1,
        ]
        if self.anisotropic:
            places.insert(0, half_azimuth(wi, wo) / (2 * np.pi))
        pairs = zip(places, self.shape, strict=True)
        return tuple(np.minimum((place * n).astype(int), n - 1) for place, n in pairs)

    @cached_property
    def filled_values(self) -> AnyArray:
        """The values, where each unknown cell has the value of the nearest known cell.

        Distances are counted in cells. Both azimuths are periodic.
        """
        unknown = np.isnan(self.values).any(axis=-1)
        if not unknown.any():
            return self.values
        from scipy.ndimage import distance_transform_edt

        # Extend periodic axes at both ends, so far that the nearest known cell is within the
        # extended table even across the end
        farthest = int(np.ceil(distance_transform_edt(unknown).max()))
        azimuths = (0, 3) if self.anisotropic else (2,)
        added = [min(farthest, n // 2) * (k in azimuths) for k, n in enumerate(self.shape)]
        wrapped = np.pad(unknown, [(a, a) for a in added], mode="wrap")
        # Indices of the nearest known cell along each axis, converted to the original table
        nearest = distance_transform_edt(wrapped, return_distances=False, return_indices=True)
        own = tuple(slice(a, a + n) for a, n in zip(added, self.shape, strict=True))
        cells = [(i[own] - a) % n for i, a, n in zip(nearest, added, self.shape, strict=True)]
        return self.values[tuple(cells)]

    def mix_channels(self, weights: AnyArray) -> Table:
        """Return a table whose channels are the present channels times `weights` (present, new)."""
        return replace(self, values=self.values @ weights)

    def scene_dict(self) -> dict[str, Any]:
        """Return the table as a BSDF for `mitsuba.load_dict`; the caller adds wavelengths.

        Raises `BrdfkitError` for values that are too large for single precision.
        """
        import mitsuba as mi

        values = self.filled_values
        largest = max(values.max(), -values.min())
        if not largest < LARGEST:
            raise BrdfkitError(
                f"A measured value of {largest:.3g} 1/sr is too large to be rendered (the limit "
                f"is {LARGEST:g}); check the data."
            )
        return {
            "type": "measured_table",
            "table": mi.TensorXf(np.ascontiguousarray(values, np.float32)),
            "phi_d_period": float(self.phi_d_period),
        }

    def eval(self, wi: ArrayLike, wo: ArrayLike) -> AnyArray:
        """Interpolate the BRDF (n, channels) in sr⁻¹ at direction pairs (n, 3), linearly per axis.

        Beyond the outermost centres of theta_h and theta_d it is constant; it is periodic in the
        azimuths, and 0 below the surface.
        """
        wi, wo = np.asarray(wi, float), np.asarray(wo, float)
        theta_h, theta_d, phi_d = to_half_difference(wi, wo)
        n_h, n_d, n_p = self.shape[-3:]
        axes = [
            find_bracket(np.sqrt(theta_h / (np.pi / 2)) * n_h - 0.5, n_h),
            find_bracket(theta_d / (np.pi / 2) * n_d - 0.5, n_d),
            find_periodic_bracket(phi_d / self.phi_d_period * n_p - 0.5, n_p),
        ]
        if self.anisotropic:
            n_a = self.shape[0]
            phi_h = half_azimuth(wi, wo)
            axes.insert(0, find_periodic_bracket(phi_h / (2 * np.pi) * n_a - 0.5, n_a))

        # np.take with flat indices is several times as fast as indexing along every axis
        values = self.filled_values.reshape(-1, self.values.shape[-1])
        result = np.zeros((*theta_h.shape, values.shape[-1]))
        for nodes, share in list_corners(axes):
            result += share[..., None] * values.take(to_flat_index(nodes, self.shape), axis=0)
        above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
        return np.where(above[..., None], result, 0.0)

    __call__ = eval  # so that a table can be called as the function of a `Measured`
