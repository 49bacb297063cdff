"""`MeasuredPoints`: the valid samples of a measurement, found quickly by their angles."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray
from brdfkit.core.geometry.directions import to_angles
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.albedos import make_measured_test
from brdfkit.model.samples import Samples

# How far scattered samples may be from the incidence, and from the plane of the views, to be drawn
SCATTER_REACH = 3.0, 5.0  # degrees
CELLS = 0.6, 1.2  # the same of a table, in its cells of theta_d and phi_d
MOST_POINTS = 400  # that are drawn of one incidence
_KEPT: WeakKeyDictionary[Measured, MeasuredPoints] = WeakKeyDictionary()
_TESTS: WeakKeyDictionary[Measured, Callable[[FloatArray, FloatArray], BoolArray]] = (
    WeakKeyDictionary()
)


@dataclass(frozen=True, eq=False)
class MeasuredPoints:
    """The valid samples of a measurement in the order of their angle of incidence.

    `theta_i`, `theta_o`: angles to the normal [degrees]; `azimuth`: azimuth of the view from the
    mirror's side of the plane of incidence, within ±180 [degrees]; `phi_i`: azimuth of the light
    [degrees]; `rows`: their indices in `samples`; all (n,). `anisotropic`: whether `phi_i` counts.
    """

    samples: Samples
    theta_i: FloatArray
    theta_o: FloatArray
    azimuth: FloatArray
    phi_i: FloatArray
    rows: AnyArray
    reach: tuple[float, float]
    anisotropic: bool

    @classmethod
    def of(cls, data: Measured) -> MeasuredPoints:
        """Return the points of a measurement, which are kept as long as it is."""
        if data not in _KEPT:
            _KEPT[data] = cls._sort(data)
        return _KEPT[data]

    @classmethod
    def _sort(cls, data: Measured) -> MeasuredPoints:
        samples = data.samples
        rows = np.flatnonzero(samples.valid)
        (theta_i, phi_i), (theta_o, phi_o) = (
            [np.degrees(a) for a in to_angles(w[rows])] for w in (samples.wi, samples.wo)
        )
        order = np.argsort(theta_i)
        azimuth = wrap(phi_o - phi_i - 180)
        light, view, across, turn = (
            a[order].astype(np.float32) for a in (theta_i, theta_o, azimuth, phi_i)
        )
        reach = SCATTER_REACH
        if data.is_table:
            steps = (
                90 / data.table.shape[-2],
                np.degrees(data.table.phi_d_period) / data.table.shape[-1],
            )
            reach = CELLS[0] * steps[0], CELLS[1] * steps[1]
        return cls(samples, light, view, across, turn, rows[order], reach, data.anisotropic)

    def find_near(
        self, theta_i: float, phi_i: float, phi_o: float
    ) -> tuple[FloatArray, FloatArray]:
        """Return the samples near an incidence and a plane of views [degrees].

        They are given by their angles of view (n,), negative on the light's side, and their values
        (n, channels).
        """
        near, across = self.reach
        first, last = np.searchsorted(self.theta_i, [theta_i - near, theta_i + near])
        theta_o, azimuth = self.theta_o[first:last], self.azimuth[first:last]
        ahead = self._is_near(azimuth, phi_o, across)
        behind = self._is_near(azimuth, phi_o + 180, across)
        # At normal incidence or view an azimuth means nothing
        steep = (theta_o < near) | (self.theta_i[first:last] < near)
        shown = ahead | behind | ((theta_o < near) if theta_i > near else steep)
        if self.anisotropic:
            shown &= self._is_near(self.phi_i[first:last], phi_i, across)
        found = np.flatnonzero(shown)
        found = found[:: -(-len(found) // MOST_POINTS) or 1]
        side = np.where(behind[found] & ~ahead[found], -1.0, 1.0)
        return side * theta_o[found], self.samples.values[self.rows[first:last][found]]

    def _is_near(self, azimuth: FloatArray, wanted: float, reach: float) -> BoolArray:
        """Return the mask of azimuths near the wanted one [degrees]; mirrored if isotropic."""
        near = np.abs(wrap(azimuth - wanted)) <= reach
        if not self.anisotropic:
            near |= np.abs(wrap(azimuth + wanted)) <= reach
        return near


def wrap(degrees: AnyArray) -> AnyArray:
    """Return angles within ±180°."""
    return (degrees + 180) % 360 - 180


def is_known(material: Any, wi: FloatArray, wo: FloatArray) -> BoolArray:
    """Return the mask (n,) of pairs of directions (n, 3) that were measured; all of a model."""
    if not isinstance(material, Measured):
        return np.ones(len(wi), bool)
    if material not in _TESTS:
        _TESTS[material] = make_measured_test(material)
    known = np.zeros(len(wi), bool)
    above = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    known[above] = _TESTS[material](wi[above], wo[above])
    return known
