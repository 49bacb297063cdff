"""Finds the cells of a measured table around a direction pair in Mitsuba, as `Table.eval` does."""

from collections.abc import Iterator

import drjit as dr

from brdfkit.core.array_types import JitFloat, JitInt, JitVector
from brdfkit.core.geometry import multilinear
from brdfkit.core.geometry.vectors import azimuth, half_vector, polar_angle
from brdfkit.mitsuba_bridge.arrays import find_bracket, find_periodic_bracket
from brdfkit.model.samples import Table


def find_corners(table: Table, wi: JitVector, wo: JitVector) -> Iterator[tuple[JitInt, JitFloat]]:
    """Yield (index, share) of the cells around a direction pair, to interpolate in a table."""
    theta_h, theta_d, phi_d, phi_h = to_half_difference(wi, wo)
    n_h, n_d, n_p = table.shape[-3:]
    axes = [
        find_bracket(dr.sqrt(theta_h / (dr.pi / 2)) * n_h - 0.5, n_h),
        find_bracket(theta_d / (dr.pi / 2) * n_d - 0.5, n_d),
        find_periodic_bracket(phi_d / table.phi_d_period * n_p - 0.5, n_p),
    ]
    if table.anisotropic:
        n_a = table.shape[0]
        axes.insert(0, find_periodic_bracket(phi_h / (2 * dr.pi) * n_a - 0.5, n_a))
    for cells, share in multilinear.list_corners(axes):
        yield multilinear.to_flat_index(cells, table.shape), share


def to_half_difference(
    wi: JitVector, wo: JitVector
) -> tuple[JitFloat, JitFloat, JitFloat, JitFloat]:
    """Return the angles (theta_h, theta_d, phi_d, phi_h) [rad] of half and difference vector."""
    h = half_vector(wi, wo)
    sin_h = dr.safe_sqrt(h.x * h.x + h.y * h.y)
    # The difference vector is wi in the frame of the half vector h. If h is the normal, its azimuth
    # may be any number
    off = sin_h > 1e-7
    inverse = 1 / dr.select(off, sin_h, 1)
    cos_p, sin_p = dr.select(off, h.x * inverse, 1), h.y * inverse
    x, y = cos_p * wi.x + sin_p * wi.y, cos_p * wi.y - sin_p * wi.x
    d = type(wi)(h.z * x - sin_h * wi.z, y, sin_h * x + h.z * wi.z)
    return polar_angle(h), polar_angle(d), azimuth(d), azimuth(h)
