"""Draws the outgoing direction of any BRDF from a table of its half vectors.

For a few incidences the table holds the density of half vectors, in proportion to the reflected
light f cosθ_o with the BRDF f, and constant within a cell. Between the incidences the densities are
mixed. At grazing angles a cell of half vectors shrinks with the highlight, while a cell of outgoing
directions would not.

A density p_h of half vectors is the density p_h / (4 wi·h) of the directions to which they reflect
wi.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, JitFloat, JitInt, JitVector
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.multilinear import list_corners, to_flat_index
from brdfkit.core.geometry.vectors import azimuth, cos_theta_d, half_vector, polar_angle, reflect
from brdfkit.mitsuba_bridge.arrays import BELOW_ONE, Rows, find_bracket, find_periodic_bracket


@dataclass(frozen=True, eq=False)
class ReflectedShares:
    """How the light from each incidence is shared out to cells of half vectors.

    `azimuths` and `angles` are the numbers of azimuths and polar angles of the incidences, and
    `cells` those of cells in theta_h and phi_h. `rows` (incidences, n_h) and `columns`
    (incidences, n_h, n_p) are the cumulative shares of a row of cells, theta_h, and of a cell in
    its row. `albedo` is the directional albedo (incidences, channels).
    """

    azimuths: int
    angles: int
    cells: tuple[int, int]
    rows: AnyArray
    columns: AnyArray
    albedo: AnyArray


def integrate_shares(
    f: Callable[..., Any],
    azimuths: int = 1,
    angles: int = 32,
    cells: tuple[int, int] = (90, 32),
    points: int = 2,
) -> ReflectedShares:
    """Integrate a BRDF over cells of half vectors, which takes tenths of a second to seconds.

    `f(wi, wo)` is the BRDF (n, channels) in sr⁻¹ at NumPy direction pairs (n, 3). `azimuths` is 1
    for an isotropic BRDF. The `cells` are square-root spaced in theta_h; phi_h is relative to the
    azimuth of wi. `points` is the number of points along each side of a cell at which f is
    evaluated.
    """
    theta_i = (np.arange(angles) + 0.5) / angles * np.pi / 2
    phi_i = np.arange(azimuths) / azimuths * 2 * np.pi
    light = np.concatenate([_integrate_cells(f, theta_i, phi, cells, points) for phi in phi_i])
    masses = light.mean(axis=-1)
    masses[masses.sum(axis=(1, 2)) == 0] = 1  # if nothing is reflected, any direction will do
    rows, columns = _cumulate_shares(masses.sum(axis=2)), _cumulate_shares(masses)
    return ReflectedShares(azimuths, angles, cells, rows, columns, light.sum(axis=(1, 2)))


class HalfVectorTable:
    """A `Sampling` that draws directions in proportion to a BRDF, in the current variant.

    `shares` are from `integrate_shares`. Cells where the BRDF is 0 are never drawn, so the table
    has to be mixed with cosine samples.
    """

    def __init__(self, shares: ReflectedShares) -> None:
        self.azimuths, self.angles, self.cells = shares.azimuths, shares.angles, shares.cells
        self.rows, self.columns = Rows(shares.rows.ravel()), Rows(shares.columns.ravel())

        # The density per solid angle of the drawn cells, with the rounding of their probabilities
        drawn = _shares_from_sums(shares.rows)[..., None] * _shares_from_sums(shares.columns)
        self.density = Rows((drawn / _cell_solid_angles(self.cells)[:, None]).ravel())
        self.edges = Rows(_compute_edge_versines(self.cells[0]))

    def sample(self, wi: JitVector, u: JitVector) -> JitVector:
        """Draw a direction, possibly below the surface, by the random numbers u.x, u.y and u.z."""
        n_h, n_p = self.cells
        incidence = self._choose_incidence(wi, u.z)
        row, x = _draw_cell(self.rows, incidence * n_h, n_h, u.x)
        column, y = _draw_cell(self.columns, (incidence * n_h + row) * n_p, n_p, u.y)
        # The polar angle is drawn as 1 - cosθ_h, which keeps its digits near the normal
        versine = dr.lerp(self.edges.at(row), self.edges.at(row + 1), x)
        sine = dr.safe_sqrt(versine * (2 - versine))
        sin_phi, cos_phi = dr.sincos(azimuth(wi) + (column + y) / n_p * (2 * dr.pi))
        return reflect(wi, type(wi)(sine * cos_phi, sine * sin_phi, 1 - versine))

    def pdf(self, wi: JitVector, wo: JitVector) -> JitFloat:
        """Return the density, per solid angle, with which `sample` draws `wo`."""
        n_h, n_p = self.cells
        h = half_vector(wi, wo)
        row = _find_cell(dr.sqrt(polar_angle(h) / (dr.pi / 2)), n_h)
        turn = (azimuth(h) - azimuth(wi)) / (2 * dr.pi)
        cell = row * n_p + _find_cell(turn - dr.floor(turn), n_p)
        density = 0
        for incidence, share in self.find_incidences(wi):
            density += share * self.density.at(incidence * (n_h * n_p) + cell)
        return density / (4 * cos_theta_d(wi, wo))

    def find_incidences(self, wi: JitVector) -> list[tuple[JitInt, JitFloat]]:
        """Return (index, share) of the table's incidences around `wi`; the shares add up to 1."""
        brackets = self._find_brackets(wi)
        shape = (self.azimuths, self.angles)[-len(brackets) :]
        return [(to_flat_index(nodes, shape), share) for nodes, share in list_corners(brackets)]

    def _find_brackets(self, wi: JitVector) -> list[tuple[JitInt, JitInt, JitFloat]]:
        """Return the azimuths (if several) and polar angles around `wi`, with weights."""
        theta = find_bracket(polar_angle(wi) / (dr.pi / 2) * self.angles - 0.5, self.angles)
        if self.azimuths == 1:
            return [theta]
        phi = find_periodic_bracket(azimuth(wi) / (2 * dr.pi) * self.azimuths, self.azimuths)
        return [phi, theta]

    def _choose_incidence(self, wi: JitVector, z: JitFloat) -> JitInt:
        """Return the index of an incidence, chosen by its share with a random number `z`.

        The two random numbers for the half vector stay as they are. So equal numbers draw nearly
        equal half vectors at neighbouring incidences, and a picture that uses the same numbers in
        all pixels has no rings.
        """
        incidence = 0
        for lower, upper, t in self._find_brackets(wi):
            up = z < t
            # What is left of z is scaled to 0..1 for the next choice. The divisor is selected
            # first, since scalar variants raise an error for a division by 0
            z = dr.select(up, z, z - t) / dr.select(up, t, 1 - t)
            incidence = incidence * self.angles + dr.select(up, upper, lower)
        return incidence


def _integrate_cells(
    f: Callable[..., Any], theta_i: FloatArray, phi_i: float, cells: tuple[int, int], points: int
) -> AnyArray:
    """Compute the share of the light that each cell of half vectors reflects, ∫ f cosθ_o dω_o.

    It has the shape (incidences, theta_h, phi_h, channels). The incidences have the polar angles
    `theta_i` (incidences,) and one azimuth `phi_i`.
    """
    # Half vectors h on a grid of points in every cell, even in solid angle within the cell
    n_h, n_p = cells
    edges = _compute_edge_versines(n_h)
    inside = (np.arange(points) + 0.5) / points
    cos_theta = 1 - (edges[:-1, None] + np.diff(edges)[:, None] * inside).ravel()
    phi = phi_i + (np.arange(n_p * points) + 0.5) / (n_p * points) * 2 * np.pi
    h = from_angles(np.arccos(cos_theta)[:, None], phi)

    # Outgoing directions: wi reflected about h
    wi = np.broadcast_to(from_angles(theta_i, phi_i)[:, None, None], (len(theta_i), *h.shape))
    cos_d = (wi * h).sum(axis=-1)
    wo = 2 * cos_d[..., None] * h - wi
    above = (wo[..., 2] > 0) & (cos_d > 0)

    # The mean of f cosθ_o dω_o/dω_h over the points of a cell, times the cell's solid angle
    values = np.asarray(f(wi[above], wo[above]))
    light = np.zeros((*above.shape, values.shape[1]))
    light[above] = values * (wo[above][:, 2] * 4 * cos_d[above])[:, None]
    means = light.reshape(len(theta_i), n_h, points, n_p, points, -1).mean(axis=(2, 4))
    return means * _cell_solid_angles(cells)[:, None, None]


def _compute_edge_versines(n: int) -> FloatArray:
    """Return 1 - cosθ_h (n + 1,) at the edges of `n` cells, which are even in √θ_h."""
    return 2 * np.sin((np.arange(n + 1) / n) ** 2 * np.pi / 4) ** 2


def _cell_solid_angles(cells: tuple[int, int]) -> FloatArray:
    """Return the solid angle (n_h,) [sr] of a cell of half vectors in each row of theta_h."""
    return np.diff(_compute_edge_versines(cells[0])) * 2 * np.pi / cells[1]


def _cumulate_shares(masses: AnyArray) -> AnyArray:
    """Return cumulative shares of the `masses` along the last axis, in single precision.

    Where all masses are 0, the shares are equal.
    """
    sums = masses.cumsum(axis=-1)
    even = np.arange(1, masses.shape[-1] + 1) / masses.shape[-1]
    total = sums[..., -1:]
    with np.errstate(invalid="ignore"):
        return np.where(total > 0, sums / total, even).astype(np.float32)


def _shares_from_sums(sums: AnyArray) -> AnyArray:
    """Return the shares (..., n) from their cumulative sums, along the last axis."""
    return np.diff(sums.astype(float), axis=-1, prepend=0)


def _draw_cell(sums: Rows, start: JitInt, n: int, x: JitFloat) -> tuple[JitInt, JitFloat]:
    """Return (cell, place in it in [0, 1]) for a random number `x`, by binary search.

    The cumulative shares of the `n` cells begin at `start` in `sums`.
    """
    x = dr.minimum(x, BELOW_ONE)  # 1 would draw a last cell whose probability is 0
    cell: Any = 0
    low, high = 0, 1  # cumulative shares without the cell, and with it
    for step in 2 ** np.arange(int(n - 1).bit_length())[::-1]:
        there = dr.minimum(cell + int(step), n)
        share = sums.at(start + there - 1)
        beyond = (there < n) & (share <= x)
        cell = dr.select(beyond, there, cell)
        low, high = dr.select(beyond, share, low), dr.select(beyond, high, share)
    return cell, dr.clip((x - low) / (high - low), 0, 1)


def _find_cell(position: JitFloat, n: int) -> JitInt:
    """Return the index of the cell at a `position` in [0, 1] among `n` equal ones."""
    import mitsuba as mi

    return dr.minimum(mi.UInt32(position * n), n - 1)
