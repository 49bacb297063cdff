"""Computes the directional albedo of a measurement: the share of light that it reflects.

Fits are compared with measurements by their albedo, and a large albedo reveals a wrong unit.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured.evidence import GUESSED, find_evidence
from brdfkit.materials.measured.measured_data import MeasuredData
from brdfkit.model.samples.coordinates import compute_coordinates, compute_sample_coordinates
from brdfkit.model.samples.measures import REACH
from brdfkit.regression.albedo import (
    ANISOTROPIC_AZIMUTHS,
    ISOTROPIC_AZIMUTHS,
    LARGEST_MEASURED_ALBEDO,
)

# Angles of incidence [degrees]: at ANGLES the albedos of fits and measurements are compared; at
# GRAZING measurements are not trusted, but fits are tested for reflecting too much light
ANGLES, GRAZING = (5.0, 45.0, 75.0), 85.0
# Numbers of polar angles and azimuths of half vectors in the quadrature
N_THETA, N_PHI = 60, 24
# An albedo counts as measured if at least this share of the light leaves near measured directions
LEAST_KNOWN_SHARE = 0.75
# If a larger share of the samples is 0 or negative, their albedo is not trusted: the interpolation
# takes logarithms, so that noise around 0 makes the albedo too low
LARGEST_NEGATIVE_SHARE = 0.02


@dataclass(frozen=True, eq=False)
class MeasuredAlbedo:
    """The directional albedo of a measurement at a few angles of incidence.

    `theta_i`: angles of incidence [degrees], (n,); `values`: albedo, a mean over azimuths of
    incidence, (n, channels); `known`: whether it is mostly measured rather than extrapolated, (n,),
    always False at the last angle, `GRAZING`.
    """

    theta_i: tuple[float, ...]
    values: NDArray[np.float64]
    known: NDArray[np.bool_]

    @property
    def has_another_unit(self) -> bool:
        """Whether the albedo is so large that the measured values cannot be a BRDF in sr⁻¹."""
        return bool((self.known[:, None] & (self.values > LARGEST_MEASURED_ALBEDO)).any())

    @property
    def means(self) -> tuple[float, ...]:
        """The albedo at 5°, 45° and 75°, averaged over the channels; NaN where it is not known."""
        means = np.where(self.known, self.values.mean(axis=1), np.nan)
        return tuple(means[: len(ANGLES)].tolist())


def compute_directional_albedo(data: Any, wi: FloatArray, finer: int = 1) -> FloatArray:
    """Return the directional albedo (channels,) of a `Measured` for light from `wi` (3,).

    It is integrated over half vectors h, where dωo = 4 (wi·h) dωh, by a coarse quadrature. This
    suffices for measured data, whereas `brdfkit.albedo` refines its quadrature for seconds. The
    result is scaled so that a Lambertian surface gets exactly its reflectance. With `finer`, there
    are so many times as many angles and azimuths.
    """
    wo, weight = make_outgoing_quadrature(wi, finer)
    values = data.eval(np.broadcast_to(wi, wo.shape), wo)
    return weight @ values * np.pi / weight.sum()


def make_outgoing_quadrature(wi: FloatArray, finer: int = 1) -> tuple[FloatArray, FloatArray]:
    """Return the nodes and weights of a quadrature over the directions wo for light from `wi` (3,).

    The nodes (n, 3) are directions above the surface, dense around the mirror direction. The
    weights (n,) are cos θo dωo, up to a factor.
    """
    # Place half vectors, dense around the normal
    x, turns = ((np.arange(n * finer) + 0.5) / (n * finer) for n in (N_THETA, N_PHI))
    theta, phi = x**2 * np.pi / 2, turns * 2 * np.pi
    h = from_angles(*np.meshgrid(theta, phi, indexing="ij")).reshape(-1, 3)
    d_omega = np.repeat(x * np.sin(theta), len(phi))

    # Reflect `wi` about the half vectors
    cosine = h @ wi
    wo = 2 * cosine[:, None] * h - wi
    above = (cosine > 0) & (wo[:, 2] > 0)
    return wo[above], (cosine * d_omega * wo[:, 2])[above]


def compute_measured_albedo(data: MeasuredData) -> MeasuredAlbedo:
    """Compute the directional albedo of a `Measured` at incidences of 5°, 45°, 75° and 85°."""
    azimuths = ANISOTROPIC_AZIMUTHS if data.anisotropic else ISOTROPIC_AZIMUTHS
    angles, is_near, values, known = (*ANGLES, GRAZING), make_measured_test(data), [], []
    for angle in angles:
        directions = [from_angles(np.radians(angle), phi) for phi in azimuths]
        values.append(np.mean([compute_directional_albedo(data, wi) for wi in directions], axis=0))
        share = np.mean([_compute_known_share(is_near, wi) for wi in directions])
        known.append(angle < GRAZING and share >= LEAST_KNOWN_SHARE and not _is_noisy(data))
    return MeasuredAlbedo(angles, np.array(values), np.array(known))


def _is_noisy(data: MeasuredData) -> bool:
    """Return whether noise makes many scattered samples 0 or negative, which lowers the albedo."""
    if data.is_table:
        return False
    means = data.samples.values[data.samples.valid].mean(axis=1)
    return bool((means <= 0).mean() > LARGEST_NEGATIVE_SHARE)


def _compute_known_share(
    is_near: Callable[[FloatArray, FloatArray], BoolArray], wi: FloatArray
) -> float:
    """Return the share of the light from `wi` that a matt surface reflects to measured directions.

    `is_near` tells which directions, given as wi and wo (n, 3), count as measured.
    """
    wo, weight = make_outgoing_quadrature(wi)
    return float(weight @ is_near(np.broadcast_to(wi, wo.shape), wo) / weight.sum())


def make_measured_test(data: MeasuredData) -> Callable[[FloatArray, FloatArray], BoolArray]:
    """Return a function of wi and wo (n, 3) that tells which pairs lie near a valid sample.

    For a table it tells which pairs lie in a valid cell, in a completed one which are no guesses.
    """
    if data.evidence is not None and data._table is not None:
        return lambda wi, wo: find_evidence(data, wi, wo) != GUESSED
    if data._table is not None:
        table = data._table
        known = np.asarray(np.isfinite(table.values).all(axis=-1))
        return lambda wi, wo: known[table.find_cells(wi, wo)]
    from scipy.spatial import cKDTree

    samples, anisotropic = data.samples.at(data.samples.valid), data.anisotropic
    tree = cKDTree(compute_sample_coordinates(samples.wi, samples.wo, anisotropic))

    def is_near(wi: FloatArray, wo: FloatArray) -> BoolArray:
        points = compute_coordinates(wi, wo, anisotropic)
        return tree.query(points, distance_upper_bound=REACH)[0] <= REACH

    return is_near
