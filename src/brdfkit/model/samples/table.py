"""A table over half/difference coordinates, with the cells of MERL and multilinear interpolation.

The cells are those of [Matusik et al. 2003]. The axis theta_h is square-root spaced, so that cells
are small where highlights are; theta_d and phi_d are evenly spaced. An anisotropic table has the
azimuth phi_h of the half vector as its first axis, evenly spaced over the full circle. A cell's
value belongs to the cell's centre.
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

LARGEST = 1e30  # [sr⁻¹] that is rendered; single precision ends at 3e38


@dataclass(frozen=True, eq=False)
class Table:
    """A table of BRDF values ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d, channels) in sr⁻¹.

    Unknown cells are NaN. `phi_d_period` is π for a reciprocal table, which needs half of the
    azimuths phi_d, else 2π.

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
        """The numbers of cells ([n_phi_h,] n_theta_h, n_theta_d, n_phi_d)."""
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
        """The shares (n_theta_h, n_theta_d, 2) of both measures that a cell stands for.

        They do not depend on the azimuths.
        """
        n_h, n_d, n_p = self.shape[-3:]
        azimuths = n_p * (self.shape[0] if self.anisotropic else 1)
        theta_h, theta_d = (
            np.pi / 2 * edges
            for edges in ((np.arange(n_h + 1) / n_h) ** 2, np.arange(n_d + 1) / n_d)
        )
        angles = np.outer(np.diff(theta_h), np.diff(theta_d))
        # ∫ sinθ_h dθ_h, and ∫ sinθ_d cosθ_d dθ_d
        solid = np.outer(-np.diff(np.cos(theta_h)), np.diff(np.sin(theta_d) ** 2) / 2)
        return np.stack([angles, solid], axis=-1) * 2 * np.pi / azimuths

    def directions(self) -> tuple[FloatArray, FloatArray]:
        """Return (wi, wo) at the centre of every cell, each (*shape, 3), also below the surface."""
        *phi_h, theta_h, theta_d, phi_d = np.meshgrid(*self.centres, indexing="ij")
        return from_half_difference(theta_h, theta_d, phi_d, *phi_h)

    def find_cells(self, wi: ArrayLike, wo: ArrayLike) -> tuple[IntArray, ...]:
        """Return the cells of direction pairs (n, 3), as an array of indices (n,) for each axis."""
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
        """The values with each unknown cell filled from the nearest known one, counted in cells.

        Both azimuths are periodic, phi_d with its own period.
        """
        unknown = np.isnan(self.values).any(axis=-1)
        if not unknown.any():
            return self.values
        from scipy.ndimage import distance_transform_edt

        # Periodic axes are extended at both ends by as many cells as may hold the nearest one
        farthest = int(np.ceil(distance_transform_edt(unknown).max()))
        azimuths = (0, 3) if self.anisotropic else (2,)
        added = [min(farthest, n // 2) * (k in azimuths) for k, n in enumerate(self.shape)]
        wrapped = np.pad(unknown, [(a, a) for a in added], mode="wrap")
        # Index along each axis of the nearest known cell, back in the table that is not extended
        nearest = distance_transform_edt(wrapped, return_distances=False, return_indices=True)
        own = tuple(slice(a, a + n) for a, n in zip(added, self.shape, strict=True))
        cells = [(i[own] - a) % n for i, a, n in zip(nearest, added, self.shape, strict=True)]
        return self.values[tuple(cells)]

    def mix_channels(self, weights: AnyArray) -> Table:
        """Return a table in new channels, the old ones times `weights` (old, new)."""
        return replace(self, values=self.values @ weights)

    def scene_dict(self) -> dict[str, Any]:
        """Return the dictionary for `mitsuba.load_dict`; the caller adds wavelengths.

        Raises `BrdfkitError` for values that are too large for single precision.
        """
        import mitsuba as mi

        values = self.filled_values
        largest = max(values.max(), -values.min())
        if not largest < LARGEST:
            raise BrdfkitError(
                f"A measured value of {largest:.3g} 1/sr is too large to be rendered; above "
                f"{LARGEST:g} it is no BRDF: mend the data."
            )
        return {
            "type": "measured_table",
            "table": mi.TensorXf(np.ascontiguousarray(values, np.float32)),
            "phi_d_period": float(self.phi_d_period),
        }

    def eval(self, wi: ArrayLike, wo: ArrayLike) -> AnyArray:
        """Compute the BRDF (n, channels) in sr⁻¹ at direction pairs (n, 3), multilinearly.

        It is clamped at the ends of theta_h and theta_d, periodic in the azimuths, and 0 below the
        surface.
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

        # np.take with flat indices is several times as fast as an index on each axis
        values = self.filled_values.reshape(-1, self.values.shape[-1])
        result = np.zeros((*theta_h.shape, values.shape[-1]))
        for nodes, share in list_corners(axes):
            result += share[..., None] * values.take(to_flat_index(nodes, self.shape), axis=0)
        above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
        return np.where(above[..., None], result, 0.0)

    __call__ = eval  # a table can be the lookup function of a `Measured`
