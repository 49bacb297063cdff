"""Draws the outgoing direction of any BRDF, from a table of its half vectors.

For a few incidences the table holds the distribution of half vectors that f cosθ_o has, even
within a cell; between the incidences the distributions are mixed. Cells of half vectors shrink with
the highlight at grazing angles, which those of an image of outgoing directions do not.

A density p_h of half vectors is p_h / (4 wi·h) of the directions that they mirror wi to.
"""

import drjit as dr
import numpy as np

from brdfkit.geometry.directions import from_angles
from brdfkit.geometry.multilinear import corners, flat_index
from brdfkit.geometry.vectors import angle, azimuth, cos_theta_d, half_vector, reflect
from brdfkit.host.arrays import Rows, bracket, periodic_bracket


class Tabulated:
    """A `Sampling` of the BRDF `f(wi, wo)` → (n, channels) in sr⁻¹, NumPy, in the current variant.

    `azimuths` (1: isotropic), `angles`: how many of each the incidences have; `cells`: of theta_h,
    square-root spaced, and of phi_h as seen from wi; `points`: along each side of a cell, where f
    is asked. Nothing is drawn from a cell where f is 0 all over: mix it with cosine samples.
    """

    def __init__(self, f, azimuths=1, angles=32, cells=(90, 32), points=2):
        self.azimuths, self.angles, self.cells = azimuths, angles, cells
        theta = (np.arange(angles) + 0.5) / angles * np.pi / 2
        azimuth = np.arange(azimuths) / azimuths * 2 * np.pi
        light = np.concatenate([_reflected(f, theta, phi, cells, points) for phi in azimuth])
        # Directional albedo (incidences, channels)
        self.albedo = light.sum(axis=(1, 2))

        masses = light.mean(axis=-1)
        masses[masses.sum(axis=(1, 2)) == 0] = 1
        rows = _cumulated(masses.sum(axis=2))
        columns = _cumulated(masses)
        self.rows, self.columns = Rows(rows.ravel()), Rows(columns.ravel())
        # The rounded sums are what is drawn by
        drawn = _differences(rows)[..., None] * _differences(columns)
        self.density = Rows((drawn / _solid_angles(cells)[:, None]).ravel())
        self.edges = Rows(_versines(cells[0]))

    def sample(self, wi, u):
        """A direction, possibly below the surface, for a point `u`, of which x and y count."""
        n_h, n_p = self.cells
        incidence, x, y = self._chosen(wi, u)
        row, x = _drawn(self.rows, incidence * n_h, n_h, x)
        column, y = _drawn(self.columns, (incidence * n_h + row) * n_p, n_p, y)
        # 1 - cosθ_h keeps its digits about the normal
        versine = dr.lerp(self.edges.at(row), self.edges.at(row + 1), x)
        sine = dr.safe_sqrt(versine * (2 - versine))
        sin_phi, cos_phi = dr.sincos(azimuth(wi) + (column + y) / n_p * (2 * dr.pi))
        return reflect(wi, type(wi)(sine * cos_phi, sine * sin_phi, 1 - versine))

    def pdf(self, wi, wo):
        """Density of `wo` per solid angle."""
        n_h, n_p = self.cells
        h = half_vector(wi, wo)
        row = _cell(dr.sqrt(angle(h) / (dr.pi / 2)), n_h)
        turn = (azimuth(h) - azimuth(wi)) / (2 * dr.pi)
        cell = row * n_p + _cell(turn - dr.floor(turn), n_p)
        density = 0
        for incidence, share in self.mixed(wi):
            density += share * self.density.at(incidence * (n_h * n_p) + cell)
        return density / (4 * cos_theta_d(wi, wo))

    def _brackets(self, wi):
        """(lower, upper, share of the upper) among the azimuths, if any, and among the angles."""
        theta = bracket(angle(wi) / (dr.pi / 2) * self.angles - 0.5, self.angles)
        if self.azimuths == 1:
            return [theta]
        phi = periodic_bracket(azimuth(wi) / (2 * dr.pi) * self.azimuths, self.azimuths)
        return [phi, theta]

    def mixed(self, wi):
        """(incidence, its share) of those around `wi`."""
        brackets = self._brackets(wi)
        shape = (self.azimuths, self.angles)[-len(brackets) :]
        return [(flat_index(nodes, shape), share) for nodes, share in corners(brackets)]

    def _chosen(self, wi, u):
        """One of them by its share, and what is left of the random numbers."""
        incidence, left = 0, [u.x, u.y]
        for k, (lower, upper, t) in enumerate(self._brackets(wi)):
            up = left[k] < t
            # one division, by what is not 0: a scalar variant would raise at the other branch
            left[k] = dr.select(up, left[k], left[k] - t) / dr.select(up, t, 1 - t)
            incidence = incidence * self.angles + dr.select(up, upper, lower)
        return incidence, *left


def _reflected(f, theta_i, phi_i, cells, points):
    """f cosθ_o dω_o (incidences, theta_h, phi_h, channels) in every cell of half vectors."""
    n_h, n_p = cells
    edges = _versines(n_h)
    inside = (np.arange(points) + 0.5) / points
    cos_theta = 1 - (edges[:-1, None] + np.diff(edges)[:, None] * inside).ravel()
    phi = phi_i + (np.arange(n_p * points) + 0.5) / (n_p * points) * 2 * np.pi
    h = from_angles(np.arccos(cos_theta)[:, None], phi)
    wi = np.broadcast_to(from_angles(theta_i, phi_i)[:, None, None], (len(theta_i), *h.shape))
    cos_d = (wi * h).sum(axis=-1)
    wo = 2 * cos_d[..., None] * h - wi
    above = (wo[..., 2] > 0) & (cos_d > 0)
    values = np.asarray(f(wi[above], wo[above]))
    light = np.zeros((*above.shape, values.shape[1]))
    light[above] = values * (wo[above][:, 2] * 4 * cos_d[above])[:, None]
    means = light.reshape(len(theta_i), n_h, points, n_p, points, -1).mean(axis=(2, 4))
    return means * _solid_angles(cells)[:, None, None]


def _versines(n):
    """1 - cosθ_h at the edges (n + 1,) of the cells."""
    return 2 * np.sin((np.arange(n + 1) / n) ** 2 * np.pi / 4) ** 2


def _solid_angles(cells):
    """[sr] of a cell in each row (n_h,)."""
    return np.diff(_versines(cells[0])) * 2 * np.pi / cells[1]


def _cumulated(masses):
    """Cumulative shares along the last axis, in the plugin's precision; even where all are 0."""
    sums = masses.cumsum(axis=-1)
    even = np.arange(1, masses.shape[-1] + 1) / masses.shape[-1]
    total = sums[..., -1:]
    with np.errstate(invalid="ignore"):
        return np.where(total > 0, sums / total, even).astype(np.float32)


def _differences(sums):
    return np.diff(sums.astype(float), axis=-1, prepend=0)


def _drawn(sums, start, n, x):
    """The cell whose cumulative share `x` falls into, among `n` from `start`, and where in it."""
    cell, low, high = 0, 0, 1  # shares up to the cell, and with it
    for step in 2 ** np.arange(int(n - 1).bit_length())[::-1]:
        there = dr.minimum(cell + int(step), n)
        share = sums.at(start + there - 1)
        beyond = (there < n) & (share <= x)
        cell = dr.select(beyond, there, cell)
        low, high = dr.select(beyond, share, low), dr.select(beyond, high, share)
    return cell, dr.clip((x - low) / (high - low), 0, 1)


def _cell(position, n):
    import mitsuba as mi

    return dr.minimum(mi.UInt32(position * n), n - 1)
