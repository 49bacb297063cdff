"""The directional albedo of a measurement: the share of light from one direction that it reflects.

Fits and measurements are compared by it, and an albedo above 1 reveals a wrong unit.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured.measured_data import MeasuredData
from brdfkit.model.samples.coordinates import compute_coordinates, compute_sample_coordinates
from brdfkit.model.samples.measures import REACH
from brdfkit.regression.albedo import (
    ANISOTROPIC_AZIMUTHS,
    ISOTROPIC_AZIMUTHS,
    LARGEST_MEASURED_ALBEDO,
)

# Angles of incidence [degrees] at which fits and measurements are compared, and a grazing angle at
# which no measurement is trusted, but no fit should reflect more light than arrives
ANGLES, GRAZING = (5.0, 45.0, 75.0), 85.0
# Numbers of half vectors in the quadrature: polar angles, spaced as in a table, and azimuths
N_THETA, N_PHI = 60, 24
# The share of the light that must leave near measured directions for the albedo to be known
LEAST_KNOWN_SHARE = 0.75
# Where a larger share of the samples is not positive, noise makes the albedo too low, because the
# lookup interpolates logarithms
LARGEST_NEGATIVE_SHARE = 0.02


@dataclass(frozen=True, eq=False)
class MeasuredAlbedo:
    """The directional albedo of a measurement.

    `theta_i`: angles of incidence [degrees] (n,); `values` (n, channels): the mean over azimuths of
    incidence; `known` (n,): False where the albedo is mostly extrapolated. The last angle is
    `GRAZING`, and its albedo is never known.
    """

    theta_i: tuple[float, ...]
    values: NDArray[np.float64]
    known: NDArray[np.bool_]

    @property
    def has_another_unit(self) -> bool:
        """Whether the albedo is so large that the values cannot be in 1/sr."""
        return bool((self.known[:, None] & (self.values > LARGEST_MEASURED_ALBEDO)).any())

    @property
    def means(self) -> tuple[float, ...]:
        """The mean over the channels at `ANGLES`; nan where it is not known."""
        means = np.where(self.known, self.values.mean(axis=1), np.nan)
        return tuple(means[: len(ANGLES)].tolist())


def albedo_at(data: Any, wi: FloatArray) -> FloatArray:
    """Return the albedo (channels,) of a `Measured` for light from `wi` (3,).

    The integral is over half vectors, dωo = 4 (wi·h) dωh, spaced as in a table. A few of them
    suffice, whereas `brdfkit.albedo`, which takes any BRDF, refines its quadrature for seconds. The
    sum is divided by the sum for f = 1/π, so that a Lambertian surface gets exactly its
    reflectance.
    """
    wo, weight = place_directions(wi)
    values = data.eval(np.broadcast_to(wi, wo.shape), wo)
    return weight @ values * np.pi / weight.sum()


def place_directions(wi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return directions wo (n, 3) above the surface, dense around the mirror direction of `wi`.

    The second result is their weights cos θo dωo (n,), up to a factor.
    """
    # Half vectors, dense around the normal
    x = (np.arange(N_THETA) + 0.5) / N_THETA
    theta, phi = x**2 * np.pi / 2, (np.arange(N_PHI) + 0.5) / N_PHI * 2 * np.pi
    h = from_angles(*np.meshgrid(theta, phi, indexing="ij")).reshape(-1, 3)
    d_omega = np.repeat(x * np.sin(theta), N_PHI)

    # The directions to which they reflect `wi`
    cosine = h @ wi
    wo = 2 * cosine[:, None] * h - wi
    above = (cosine > 0) & (wo[:, 2] > 0)
    return wo[above], (cosine * d_omega * wo[:, 2])[above]


def compute_measured_albedo(data: MeasuredData) -> MeasuredAlbedo:
    """Return the `MeasuredAlbedo` of a `Measured` at `ANGLES` and `GRAZING`."""
    azimuths = ANISOTROPIC_AZIMUTHS if data.anisotropic else ISOTROPIC_AZIMUTHS
    angles, is_near, values, known = (*ANGLES, GRAZING), _make_nearness_test(data), [], []
    for angle in angles:
        directions = [from_angles(np.radians(angle), phi) for phi in azimuths]
        values.append(np.mean([albedo_at(data, wi) for wi in directions], axis=0))
        share = np.mean([_compute_known_share(is_near, wi) for wi in directions])
        known.append(angle < GRAZING and share >= LEAST_KNOWN_SHARE and not _is_noisy(data))
    return MeasuredAlbedo(angles, np.array(values), np.array(known))


def _is_noisy(data: MeasuredData) -> bool:
    """Return whether many of scattered samples are not positive."""
    if data.is_table:
        return False
    means = data.samples.values[data.samples.valid].mean(axis=1)
    return bool((means <= 0).mean() > LARGEST_NEGATIVE_SHARE)


def _compute_known_share(
    is_near: Callable[[FloatArray, FloatArray], BoolArray], wi: FloatArray
) -> float:
    """Return the share of a matt surface's light from `wi` that leaves to measured directions."""
    wo, weight = place_directions(wi)
    return float(weight @ is_near(np.broadcast_to(wi, wo.shape), wo) / weight.sum())


def _make_nearness_test(data: MeasuredData) -> Callable[[FloatArray, FloatArray], BoolArray]:
    """Return a function that tells which direction pairs are near a valid sample or cell."""
    from scipy.spatial import cKDTree

    if data._table is not None:
        table = data._table
        known = np.asarray(np.isfinite(table.values).all(axis=-1))
        return lambda wi, wo: known[table.find_cells(wi, wo)]
    samples = data.samples.at(data.samples.valid)
    tree = cKDTree(compute_sample_coordinates(samples.wi, samples.wo, data.anisotropic))

    def is_near(wi: FloatArray, wo: FloatArray) -> BoolArray:
        points = compute_coordinates(wi, wo, data.anisotropic)
        return tree.query(points, distance_upper_bound=REACH)[0] <= REACH

    return is_near
