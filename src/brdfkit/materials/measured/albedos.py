"""The albedo of a measurement: what it reflects of the light that comes from an angle."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.geometry.directions import from_angles
from brdfkit.model.samples.coordinates import coordinates, sample_coordinates
from brdfkit.model.samples.measures import REACH
from brdfkit.regression.light import FOUR, ONE, OTHER_UNIT

# Angles of incidence [degrees] at which fits and measurements are compared, and a grazing one, at
# which no measurement is trusted, but no fit should gain light
ANGLES, GRAZING = (5.0, 45.0, 75.0), 85.0
# Half vectors of the quadrature: polar angles, spaced as in a table, and azimuths
N_THETA, N_PHI = 60, 24
# The share of the light that must leave near measured directions for the albedo to be known
KNOWN = 0.75
# Where a larger share of the samples is not positive, noise decides: the logarithms, between which
# is interpolated, are too low
NOISY = 0.02


@dataclass(frozen=True, eq=False)
class MeasuredAlbedo:
    """The directional albedo of a measurement.

    `theta_i`: angles of incidence [degrees] (n,); `values` (n, channels): the mean over azimuths of
    incidence; `known` (n,): whether the samples tell it, or else it is mostly extrapolated. The
    last angle is `GRAZING`, and never known.
    """

    theta_i: tuple[float, ...]
    values: NDArray[np.float64]
    known: NDArray[np.bool_]

    @property
    def has_another_unit(self) -> bool:
        """Whether so much light is reflected that the values cannot be in 1/sr."""
        return bool((self.known[:, None] & (self.values > OTHER_UNIT)).any())

    @property
    def means(self) -> tuple[float, ...]:
        """The mean over the channels at `ANGLES`; nan where the samples do not tell it."""
        means = np.where(self.known, self.values.mean(axis=1), np.nan)
        return tuple(means[: len(ANGLES)].tolist())


def albedo_at(data, wi):
    """The albedo (channels,) of a `Measured` for light from `wi` (3,).

    The integral is over half vectors, dωo = 4 (wi·h) dωh, spaced as in a table. Few are enough
    there, whereas `brdfkit.albedo`, which takes any BRDF, refines for seconds. The sum is divided
    by that of f = 1/π, so that a Lambertian surface gets exactly its reflectance.
    """
    wo, weight = hemisphere(wi)
    values = data.eval(np.broadcast_to(wi, wo.shape), wo)
    return weight @ values * np.pi / weight.sum()


def hemisphere(wi):
    """Directions (n, 3) above the surface and their weights cos θo dωo, up to a factor."""
    # half vectors; dense around the normal
    x = (np.arange(N_THETA) + 0.5) / N_THETA
    theta, phi = x**2 * np.pi / 2, (np.arange(N_PHI) + 0.5) / N_PHI * 2 * np.pi
    h = from_angles(*np.meshgrid(theta, phi, indexing="ij")).reshape(-1, 3)
    d_omega = np.repeat(x * np.sin(theta), N_PHI)

    # the directions that they reflect `wi` to
    cosine = h @ wi
    wo = 2 * cosine[:, None] * h - wi
    above = (cosine > 0) & (wo[:, 2] > 0)
    return wo[above], (cosine * d_omega * wo[:, 2])[above]


def measured_albedo(data):
    """The `MeasuredAlbedo` of a `Measured` at `ANGLES` and `GRAZING`."""
    azimuths = FOUR if data.anisotropic else ONE
    angles, is_near, values, known = (*ANGLES, GRAZING), _nearness(data), [], []
    for angle in angles:
        directions = [from_angles(np.radians(angle), phi) for phi in azimuths]
        values.append(np.mean([albedo_at(data, wi) for wi in directions], axis=0))
        share = np.mean([_known_share(is_near, wi) for wi in directions])
        known.append(angle < GRAZING and share >= KNOWN and not _is_noisy(data))
    return MeasuredAlbedo(angles, np.array(values), np.array(known))


def _is_noisy(data):
    """Whether many of scattered samples are not positive."""
    if data.is_table:
        return False
    means = data.samples.values[data.samples.valid].mean(axis=1)
    return bool((means <= 0).mean() > NOISY)


def _known_share(is_near, wi):
    """The share of a matt surface's light from `wi` that leaves towards measured directions."""
    wo, weight = hemisphere(wi)
    return weight @ is_near(np.broadcast_to(wi, wo.shape), wo) / weight.sum()


def _nearness(data):
    """A function of direction pairs: whether a valid sample, or a measured cell, is near each."""
    from scipy.spatial import cKDTree

    if data.is_table:
        known = np.isfinite(data.table.values).all(axis=-1)
        return lambda wi, wo: known[data.table.cells_of(wi, wo)]
    samples = data.samples.at(data.samples.valid)
    tree = cKDTree(sample_coordinates(samples.wi, samples.wo, data.anisotropic))

    def is_near(wi, wo):
        points = coordinates(wi, wo, data.anisotropic)
        return tree.query(points, distance_upper_bound=REACH)[0] <= REACH

    return is_near
