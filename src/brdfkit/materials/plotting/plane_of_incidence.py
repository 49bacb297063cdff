"""A BRDF in the plane of incidence: the angles and luminances that `plot` draws."""

import numpy as np

from brdfkit.core.colours import luminance
from brdfkit.core.geometry.directions import from_angles, to_angles
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Table

STEP = 0.1  # degrees between the points of a line
NEAR_THETA, NEAR_PHI = 3, 5  # degrees: samples this close to the plane are drawn in it


def lobe(thing, theta_i):
    """The lobe at incidence `theta_i` [degrees]: angles to the normal and luminances, both (n,).

    The angles [degrees] are negative on the light's side. The luminance [sr⁻¹] is NaN where
    a table was not measured, or where a model has no finite value.
    """
    if is_scattered(thing):
        return _samples_near(thing.samples, theta_i)
    theta_o = np.linspace(-90, 90, round(180 / STEP) + 1)[1:-1]
    wi = np.broadcast_to(from_angles(np.radians(theta_i), np.pi), (len(theta_o), 3))
    wo = from_angles(np.radians(theta_o), 0.0)
    values = luminance(thing.eval(wi, wo))
    known = np.isfinite(values)
    if isinstance(thing, Measured):
        known &= _is_measured(thing.table, wi, wo)
    return theta_o, np.where(known, values, np.nan)


def usual_angles(things):
    """15°, 45° and 75°, or the angles nearest to them at which scattered samples were measured."""
    usual = np.array([15.0, 45.0, 75.0])
    scattered = next((thing for thing in things if is_scattered(thing)), None)
    if scattered is None:
        return usual
    there = to_angles(scattered.samples.wi[_in_plane(scattered.samples)])[0]
    there = np.unique(np.degrees(there).round(1))
    there = there[there < 90]
    if not there.size:
        return usual
    return np.unique([there[np.argmin(np.abs(there - angle))] for angle in usual])


def is_scattered(thing):
    """Whether `thing` is a measured material of scattered samples, which are drawn as dots."""
    return isinstance(thing, Measured) and not thing.is_table


def _samples_near(samples, theta_i):
    """Angles to the normal and luminances of the samples near the plane and near `theta_i`."""
    near = np.abs(np.degrees(to_angles(samples.wi)[0]) - theta_i) <= NEAR_THETA
    near &= _in_plane(samples)
    theta_o = -np.sign(_cos_delta_phi(samples)) * np.degrees(to_angles(samples.wo)[0])
    return theta_o[near], luminance(samples.values[near])


def _in_plane(samples):
    """Which samples are valid and within `NEAR_PHI` of the plane of incidence."""
    beside = np.abs(_cos_delta_phi(samples)) >= np.cos(np.radians(NEAR_PHI))
    return samples.valid & (beside | (samples.wo[:, 2] == 1))


def _cos_delta_phi(samples):
    """cos Δφ of the samples: 1 in the light's azimuth, -1 in the mirror's."""
    return np.cos(to_angles(samples.wo)[1] - to_angles(samples.wi)[1])


def _is_measured(table, wi, wo):
    """Where more than half of a lookup's weight is on measured cells."""
    known = np.isfinite(table.values).all(axis=-1, keepdims=True)
    return Table(known.astype(float), table.phi_d_period).eval(wi, wo)[:, 0] > 0.5
