"""Compares the directional albedos of a fit with those of its data, at a few angles of incidence.

A fit minimises a loss of single values, and may still reflect too much or too little light in
total. The comparison finds such fits: a second search corrects them, and warnings describe them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.quadrature import directional_albedo, make_ring_rule
from brdfkit.images.ball import Pixels

# A fit is searched once more if its albedo differs from the data's by more than this factor
ACCEPTED_FACTOR = 1.2
# An albedo gets a warning if it differs from the measured one by more than this factor: 1.25, less
# the numerical error of the albedos
WRONG_FACTOR = 1.24
# Beyond this angle of incidence [degrees] a fit may be too dark, as most models are there
GRAZING_ANGLE = 60
# Angles of incidence [degrees] at which the fit is also checked for an albedo above 1
OTHER_ANGLES = 60.0, 80.0, 89.0
# Largest possible albedo of a fit: 1, because no surface reflects more light than arrives, plus the
# numerical error of the albedo
LARGEST_ALBEDO = 1.001
# A measurement with a larger albedo has another unit than 1/sr, so its albedo means nothing
LARGEST_MEASURED_ALBEDO = 2.0
# Number of outgoing directions on each of the rings over which an albedo is summed; there are twice
# as many rings
POINTS = 32
# Azimuths of incidence [rad] over which the albedo of a model is averaged
ISOTROPIC_AZIMUTHS, ANISOTROPIC_AZIMUTHS = (0.0,), tuple(np.arange(4) * np.pi / 2)
UP = 0.0, 0.0, 1.0


@cache
def make_albedo_pixels(
    theta_i: tuple[float, ...], azimuths: tuple[float, ...] = ISOTROPIC_AZIMUTHS
) -> Pixels:
    """Return a quadrature for directional albedos, as `Pixels` without measured values.

    `Pixels.evaluate` applies it to a BRDF and returns the albedos (n, channels) at the n angles of
    incidence `theta_i` [degrees], averaged over the `azimuths` [rad] of incidence.
    """
    rules = [
        [(wi, *make_ring_rule(wi, POINTS)) for wi in from_angles(np.radians(theta), azimuths)]
        for theta in theta_i
    ]
    pairs = max(sum(len(weight) for *_, weight in rule) for rule in rules)
    wi, wo = (np.tile(UP, (len(rules), pairs, 1)) for _ in range(2))
    shares = np.zeros((len(rules), pairs))
    for row, rule in enumerate(rules):
        incident = [np.broadcast_to(w, directions.shape) for w, directions, _ in rule]
        directions, weights = ([part[k] for part in rule] for k in (1, 2))
        count = sum(map(len, weights))
        wi[row, :count], wo[row, :count] = np.concatenate(incident), np.concatenate(directions)
        shares[row, :count] = np.concatenate(weights) / len(azimuths)
    flat = wi.reshape(-1, 3), wo.reshape(-1, 3), shares.ravel()
    return Pixels(*flat, np.zeros((len(rules), 0)), np.ones(len(rules)), pairs)


@dataclass(frozen=True, eq=False)
class TargetAlbedo:
    """The albedos of a measurement at some angles of incidence, which a fit should have, too.

    `theta_i`: the n angles of incidence [degrees]; `values`: the measured albedos (n, channels);
    `known`: whether the samples determine the albedo at each angle (n,); `pixels`: the quadrature
    for the albedos of a model; `azimuths`: azimuths of incidence [rad] over which it averages.
    """

    theta_i: tuple[float, ...]
    values: NDArray[np.float64]
    known: NDArray[np.bool_]
    pixels: Pixels
    azimuths: tuple[float, ...]

    @classmethod
    def from_measured(cls, albedo: Any, anisotropic: bool) -> TargetAlbedo:
        """Return the target for fits to a material, from its `MeasuredAlbedo`.

        `anisotropic`: whether to average over several azimuths of incidence.
        """
        azimuths = ANISOTROPIC_AZIMUTHS if anisotropic else ISOTROPIC_AZIMUTHS
        pixels = make_albedo_pixels(albedo.theta_i, azimuths)
        target = np.minimum(albedo.values, 1)  # measured albedos may be above 1; a fit's should not
        pixels = replace(pixels, values=target)
        return cls(albedo.theta_i, albedo.values, albedo.known, pixels, azimuths)

    @property
    def limited_values(self) -> FloatArray:
        """The albedos (n, channels) that a fit should have: the measured albedos, cut off at 1."""
        return self.pixels.values

    @property
    def has_another_unit(self) -> bool:
        """Whether the measured albedo is so large that the values cannot be a BRDF in sr⁻¹."""
        return bool((self.known[:, None] & (self.values > LARGEST_MEASURED_ALBEDO)).any())

    def compare_with_fit(self, brdf: Callable[[FloatArray, FloatArray], FloatArray]) -> Albedo:
        """Return an `Albedo` with the albedos of a fit next to the measured ones.

        `brdf`: the BRDF of the fit, a function of directions wi and wo (n, 3) to values
        (n, channels).
        """
        angles = (*self.theta_i, *OTHER_ANGLES)
        every = [make_albedo_pixels(angles, (azimuth,)).evaluate(brdf) for azimuth in self.azimuths]
        fit = np.mean(every, axis=0)[: len(self.theta_i)]
        measured = [
            tuple(row.tolist()) if known else None
            for row, known in zip(self.values, self.known, strict=True)
        ]
        peak = self._refine_largest_albedo(brdf, angles, np.max(every, axis=2))
        return Albedo(self.theta_i, tuple(map(tuple, fit.tolist())), tuple(measured), peak)

    def find_largest_albedo(
        self, brdf: Callable[[FloatArray, FloatArray], FloatArray]
    ) -> tuple[float, float]:
        """Return the largest albedo of a BRDF up to 89°, behind its angle of incidence [degrees].

        `brdf`: a function of directions wi and wo (n, 3) to values (n, channels).
        """
        angles = (*self.theta_i, *OTHER_ANGLES)
        every = [make_albedo_pixels(angles, (azimuth,)).evaluate(brdf) for azimuth in self.azimuths]
        return self._refine_largest_albedo(brdf, angles, np.max(every, axis=2))

    def _refine_largest_albedo(
        self,
        brdf: Callable[[FloatArray, FloatArray], FloatArray],
        angles: tuple[float, ...],
        peaks: FloatArray,
    ) -> tuple[float, float]:
        """Return the angle of incidence [degrees] with the largest albedo, and this albedo.

        `peaks`: the albedos of the brightest channel (azimuths, angles). Those above 1 are computed
        again by a finer quadrature, because they might only be errors of the coarse one.
        """
        for azimuth, row in np.argwhere(peaks > LARGEST_ALBEDO):
            wi = from_angles(np.radians(angles[row]), self.azimuths[azimuth])
            peaks[azimuth, row] = directional_albedo(brdf, wi).max()
        row = int(np.argmax(peaks.max(axis=0)))
        return angles[row], float(peaks[:, row].max())

    def compute_albedos(self, brdf: Callable[[FloatArray, FloatArray], FloatArray]) -> FloatArray:
        """Return the albedos (n, channels) of a model; `brdf(wi, wo)`: its values (n, channels)."""
        return self.pixels.evaluate(brdf)

    def accepts_albedos(self, albedos: FloatArray) -> bool:
        """Return whether `albedos` (n, channels) are near the measured albedos and at most 1."""
        near = self.compute_albedo_distance(albedos) <= np.log(ACCEPTED_FACTOR)
        return bool(near and albedos.max() <= LARGEST_ALBEDO)

    def find_wrong_angles(self, albedos: FloatArray) -> BoolArray:
        """Return for each angle (n,) whether a second search should correct the albedo of a fit.

        These are all angles where the measured albedo is known, and those where one of the fit's
        `albedos` (n, channels) is above 1. Grazing angles where the fit is too dark are left out.
        """
        dark = self._find_grazing_angles() & (self.compute_albedo_ratios(albedos) < 1)
        return (self.known & ~dark) | (albedos.max(axis=1) > LARGEST_ALBEDO)

    def compute_albedo_distance(self, albedos: FloatArray) -> float:
        """Return how far `albedos` (n, channels) are from the measured albedos, as one number.

        The number is the logarithm of the largest factor between both, plus the logarithm of the
        largest albedo if this is above 1. Grazing angles where the fit is too dark do not count.
        """
        logs = np.log(self.compute_albedo_ratios(albedos))
        logs = np.where(self._find_grazing_angles(), np.maximum(logs, 0), np.abs(logs))
        most = float(albedos.max())
        return float(logs.max()) + (math.log(most / LARGEST_ALBEDO) if most > LARGEST_ALBEDO else 0)

    def compute_albedo_ratios(self, albedos: FloatArray) -> FloatArray:
        """Return the ratios (n,) of `albedos` (n, channels) to the measured albedos.

        Both are averaged over the channels. A ratio is 1 where the measured albedo is unknown.
        """
        measured, own = (np.maximum(a.mean(axis=1), 1e-9) for a in (self.limited_values, albedos))
        return np.where(self.known, own / measured, 1.0)

    def _find_grazing_angles(self) -> BoolArray:
        """Return for each angle of incidence (n,) whether it is grazing, beyond `GRAZING_ANGLE`."""
        return np.array(self.theta_i) > GRAZING_ANGLE


@dataclass(frozen=True)
class Albedo:
    """The directional albedos of a fit, next to those of the data that were fitted.

    Attributes
    ----------
    theta_i : tuple of float
        Angles of incidence [degrees].
    fit : tuple of tuple of float
        The directional albedo of the fit at each angle, by channel.
    measured : tuple of tuple of float or None
        The albedo of the data; None where the samples do not determine it.
    peak : tuple of float, optional
        The angle of incidence [degrees] at which the fit has its largest albedo, among a few angles
        up to 89°, and this albedo in its brightest channel.
    """

    theta_i: tuple[float, ...]
    fit: tuple[tuple[float, ...], ...]
    measured: tuple[tuple[float, ...] | None, ...]
    peak: tuple[float, float] | None = None

    def warnings(self) -> list[str]:
        """Return a sentence on each fault: an albedo above 1, or far from the measured one."""
        sentences = []
        most = [max(albedos) for albedos in self.fit]
        pairs = list(zip(self.theta_i, most, strict=True))
        angle, gain = self.peak or max(pairs, key=lambda pair: pair[1])
        if gain > LARGEST_ALBEDO:
            text = f"{gain:.3f}" if gain < 1.01 else format_light_share(gain)
            sentences.append(
                f"it reflects {text} of the light at {angle:g}°, more than arrives; a "
                "constraint prevents it: AlbedoAtMost(1), or --albedo-at-most 1"
            )
        means = zip(self.theta_i, *self.average_channels(), strict=True)
        angle, fit, measured = max(
            means, key=lambda row: compute_factor_between(row[1], min(row[2], 1.0))
        )
        if compute_factor_between(fit, min(measured, 1.0)) > WRONG_FACTOR:
            sentences.append(
                f"it reflects {format_light_share(fit)} of the light at {angle:g}°, where the "
                f"measurement reflects {format_light_share(measured)}"
            )
        return sentences

    def average_channels(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the albedos of the fit and of its data at each angle, averaged over the channels.

        An albedo of the data is NaN where the samples do not determine it.
        """
        fit = tuple(sum(row) / len(row) for row in self.fit)
        measured = tuple(sum(row) / len(row) if row else math.nan for row in self.measured)
        return fit, measured


def format_light_share(share: float) -> str:
    """Return an albedo, a share of the incident light, as text with two digits.

    >>> format_light_share(0.3521), format_light_share(0.01201), format_light_share(2e9)
    ('0.35', '0.012', '2e+09')
    """
    if share >= 1000:
        return f"{share:.3g}"
    return f"{share:.2f}" if share >= 0.1 else f"{share:#.2g}"


def compute_factor_between(one: float, other: float) -> float:
    """Return the larger of two albedos over the smaller one, or 1 if one of them is NaN."""
    if math.isnan(one + other):
        return 1.0
    low, high = sorted((max(one, 1e-9), max(other, 1e-9)))
    return high / low
