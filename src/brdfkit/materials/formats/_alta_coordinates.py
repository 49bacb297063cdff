"""The coordinates of ALTA's files, by the names that ``PARAM_IN`` gives them."""

import numpy as np

from brdfkit.core.geometry.directions import from_angles, from_half_difference
from brdfkit.materials.formats._source import SPHERICAL

QUARTER, FULL = np.pi / 2, 2 * np.pi


# Functions from coordinates [rad] to (wi, wo), the light and the view


def _from_projection(theta_l, x, y):
    return from_angles(theta_l, 0), from_angles(np.hypot(x, y), np.arctan2(y, x))


def _from_spherical(theta_l, phi_l, theta_v, phi_v):
    return from_angles(theta_l, phi_l), from_angles(theta_v, phi_v)


def _from_half_difference(theta_h, phi_h, theta_d, phi_d):
    view, light = from_half_difference(theta_h, theta_d, phi_d, phi_h)
    return light, view


# By name: the limits of the coordinates [rad], and the function
PARAM_IN = {
    "SPHERICAL_TL_PL_TV_PV": (SPHERICAL, _from_spherical),
    "ISOTROPIC_TL_TV_PROJ_DPHI": ((QUARTER,) * 3, _from_projection),
    "ISOTROPIC_TV_TL_DPHI": (
        (QUARTER, QUARTER, FULL),
        lambda theta_v, theta_l, phi: _from_spherical(theta_l, phi, theta_v, 0),
    ),
    "RUSIN_TH_PH_TD_PD": (SPHERICAL, _from_half_difference),
    "RUSIN_TH_TD_PD": (
        (QUARTER, QUARTER, FULL),
        lambda theta_h, theta_d, phi_d: _from_half_difference(theta_h, 0, theta_d, phi_d),
    ),
}
