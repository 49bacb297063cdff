"""`AngleTable`: an isotropic BRDF at the nodes of a grid of angles, linear between them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.directions import from_angles, to_angles
from brdfkit.core.geometry.multilinear import find_bracket, list_corners
from brdfkit.materials.measured.measured_data import Lookup

TURNS = 36  # azimuths of the light over which an anisotropic BRDF is averaged


@dataclass(frozen=True, eq=False)
class AngleTable:
    """A BRDF that is linear in the angles between nodes; it evaluates like a material.

    `name`: the material's name; `theta`: polar angles of the light, and of the viewer (n,) [rad];
    `phi`: azimuths of the viewer from that of the light (m,), from 0 to 2π [rad]; `values`: the
    BRDF [sr⁻¹] (n, n, m, channels) for each light, viewer and azimuth.
    """

    name: str
    theta: FloatArray
    phi: FloatArray
    values: FloatArray

    def eval(self, wi: FloatArray, wo: FloatArray) -> NDArray[np.float64]:
        """Return the BRDF [sr⁻¹] (n, channels) for directions to light and viewer, (n, 3) each."""
        (theta_i, phi_i), (theta_o, phi_o) = to_angles(wi), to_angles(wo)
        angles = theta_i, theta_o, np.mod(phi_o - phi_i, 2 * np.pi)
        brackets = [
            find_bracket(np.interp(angle, nodes, np.arange(len(nodes))), len(nodes))
            for angle, nodes in zip(angles, (self.theta, self.theta, self.phi), strict=True)
        ]
        values = sum(self.values[nodes] * w[:, None] for nodes, w in list_corners(brackets))
        above = (wi[:, 2:] > 0) & (wo[:, 2:] > 0)
        return np.where(above, values, 0)


def tabulate_angles(
    f: Lookup, theta: FloatArray, phi: FloatArray, *, isotropic: bool
) -> FloatArray:
    """Return the values of a BRDF at the nodes of an `AngleTable`.

    Values below 0 become 0. A BRDF that is not isotropic is averaged over azimuths of the light.
    """
    theta_i, theta_o, azimuth = map(np.ravel, np.meshgrid(theta, theta, phi, indexing="ij"))
    turns = [0.0] if isotropic else 2 * np.pi * (np.arange(TURNS) + 0.5) / TURNS
    means = sum(
        np.maximum(f(from_angles(theta_i, turn), from_angles(theta_o, azimuth + turn)), 0)
        for turn in turns
    )
    return np.reshape(means / len(turns), (len(theta), len(theta), len(phi), -1))
