"""Finds the angles and luminances that `plot` draws: a BRDF in the plane of incidence."""

from collections.abc import Iterable
from typing import Any, TypeGuard

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray, IntArray
from brdfkit.core.colours import luminance
from brdfkit.core.geometry.directions import from_angles, to_angles
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.evidence import compute_interval, evaluate_errors, find_evidence
from brdfkit.model.samples import Samples, Table

ANGLE_STEP = 0.1  # step of the angle of view along a drawn line [degrees]
# Scattered samples are drawn if they lie within NEAR_THETA of the angle of incidence that is drawn,
# and within NEAR_PHI of the plane of incidence [degrees]
NEAR_THETA, NEAR_PHI = 3, 5
DEFAULT_ANGLES = np.array([15.0, 45.0, 75.0])


def compute_lobe(thing: Any, theta_i: float) -> tuple[FloatArray, FloatArray]:
    """Return the angles of view and the BRDF's luminances for light at `theta_i` [degrees].

    The angles to the normal (n,) [degrees] are negative on the light's side. The luminances (n,)
    [sr⁻¹] are NaN where a table was not measured, or where a model has no finite value.
    """
    if is_scattered(thing):
        return _select_samples_near(thing.samples, theta_i)
    theta_o = np.linspace(-90, 90, round(180 / ANGLE_STEP) + 1)[1:-1]
    wi = np.broadcast_to(from_angles(np.radians(theta_i), np.pi), (len(theta_o), 3))
    wo = from_angles(np.radians(theta_o), 0.0)
    values = luminance(thing.eval(wi, wo))
    known = np.isfinite(values)
    if isinstance(thing, Measured):
        known &= _is_measured_at(thing.table, wi, wo)
    return theta_o, np.where(known, values, np.nan)


def compute_certainty(
    data: Measured, theta_i: float, theta_o: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return what a completed material knows at angles of view `theta_o` (n,) [degrees].

    The results are the evidence, and the ends of the 95 % intervals of the luminance, all (n,). The
    errors of channels go together, because all come from the same directions.
    """
    wi = np.broadcast_to(from_angles(np.radians(theta_i), np.pi), (len(theta_o), 3))
    wo = from_angles(np.radians(theta_o), 0.0)
    values, errors = luminance(data.eval(wi, wo)), luminance(evaluate_errors(data, wi, wo))
    low, high = compute_interval(values, errors, wi[:, 2] * wo[:, 2])
    return find_evidence(data, wi, wo), low, high


def is_completed(thing: object) -> TypeGuard[Measured]:
    """Return whether `thing` is a completed material with standard errors."""
    completed = isinstance(thing, Measured) and thing.is_table and thing.evidence is not None
    return completed and getattr(thing, "standard_error", None) is not None


def choose_angles(things: Iterable[Any]) -> FloatArray:
    """Return the angles of incidence [degrees] at which materials are drawn by default.

    They are 15°, 45° and 75°. If a material has scattered samples, they are the nearest angles at
    which the first one of these was measured.
    """
    scattered = next((thing for thing in things if is_scattered(thing)), None)
    if scattered is None:
        return DEFAULT_ANGLES
    measured = to_angles(scattered.samples.wi[_find_samples_in_plane(scattered.samples)])[0]
    measured = np.unique(np.degrees(measured).round(1))
    measured = measured[measured < 90]
    if not measured.size:
        return DEFAULT_ANGLES
    return np.unique([measured[np.argmin(np.abs(measured - angle))] for angle in DEFAULT_ANGLES])


def is_scattered(thing: object) -> bool:
    """Return whether `thing` is a measured material of scattered samples, not of a table."""
    return isinstance(thing, Measured) and not thing.is_table


def _select_samples_near(samples: Samples, theta_i: float) -> tuple[FloatArray, FloatArray]:
    """Return the samples near the plane of incidence and near `theta_i` [degrees].

    They are given by angles to the normal [degrees], negative on the light's side, and luminances.
    """
    near = np.abs(np.degrees(to_angles(samples.wi)[0]) - theta_i) <= NEAR_THETA
    near &= _find_samples_in_plane(samples)
    theta_o = -np.sign(_compute_cos_delta_phi(samples)) * np.degrees(to_angles(samples.wo)[0])
    return theta_o[near], luminance(samples.values[near])


def _find_samples_in_plane(samples: Samples) -> BoolArray:
    """Return a mask (n,) of the valid samples within `NEAR_PHI` of the plane of incidence."""
    beside = np.abs(_compute_cos_delta_phi(samples)) >= np.cos(np.radians(NEAR_PHI))
    return samples.valid & (beside | (samples.wo[:, 2] == 1))


def _compute_cos_delta_phi(samples: Samples) -> FloatArray:
    """Return the cosine (n,) of the azimuth between light and view; -1 in the mirror direction."""
    return np.cos(to_angles(samples.wo)[1] - to_angles(samples.wi)[1])


def _is_measured_at(table: Table, wi: FloatArray, wo: FloatArray) -> BoolArray:
    """Return a mask (n,) of the direction pairs (n, 3) for which a table has measured values.

    Where cells are interpolated, more than half of the weight must lie on measured ones.
    """
    known = np.isfinite(table.values).all(axis=-1, keepdims=True)
    return Table(known.astype(float), table.phi_d_period).eval(wi, wo)[:, 0] > 0.5
