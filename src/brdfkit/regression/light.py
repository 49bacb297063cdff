"""Compares the light that a fit and its data reflect: albedos at a few angles of incidence."""

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

# Beyond the first factor between the albedos of a fit and its data, the fit is searched once more;
# beyond the second one, 1.25 less the error of the quadrature, its light is called wrong
ACCEPTED_FACTOR, WRONG_FACTOR = 1.2, 1.24
# Beyond this angle [degrees] a model may be too dark: few models rise like materials there
STEEP_ANGLE = 60
# Further angles of incidence [degrees] at which only the fit is evaluated
OTHER_ANGLES = 60.0, 80.0, 89.0
# No surface reflects more light, beyond rounding of the quadrature
LARGEST_ALBEDO = 1.001
# A measurement with a larger albedo has another unit than 1/sr, so its albedo means nothing
LARGEST_MEASURED_ALBEDO = 2.0
# Half the rings of the quadrature, and the points on each
POINTS = 32
# Azimuths of incidence [rad]
ISOTROPIC_AZIMUTHS, ANISOTROPIC_AZIMUTHS = (0.0,), tuple(np.arange(4) * np.pi / 2)
UP = 0.0, 0.0, 1.0


@cache
def make_albedo_pixels(
    theta_i: tuple[float, ...], azimuths: tuple[float, ...] = ISOTROPIC_AZIMUTHS
) -> Pixels:
    """Return the quadrature with which `Pixels.look` computes the albedos (n, channels) of a BRDF.

    Light arrives at the angles `theta_i` [degrees] (n,); the albedos are means over `azimuths`
    [rad]. The pixels have no values.
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
class Light:
    """The albedos of a measurement at some angles of incidence, to compare a fit with.

    `theta_i`: the angles [degrees] (n,); `values` (n, channels): the albedos; `known` (n,): whether
    the samples determine them; `pixels`: the quadrature that computes the albedos of a model, means
    over `azimuths` [rad].
    """

    theta_i: tuple[float, ...]
    values: NDArray[np.float64]
    known: NDArray[np.bool_]
    pixels: Pixels
    azimuths: tuple[float, ...]

    @classmethod
    def of(cls, albedo: Any, anisotropic: bool) -> Light:
        """Return the light of a `MeasuredAlbedo`."""
        azimuths = ANISOTROPIC_AZIMUTHS if anisotropic else ISOTROPIC_AZIMUTHS
        pixels = make_albedo_pixels(albedo.theta_i, azimuths)
        target = np.minimum(albedo.values, 1)  # a file may reflect more light than arrives, no fit
        pixels = replace(pixels, values=target)
        return cls(albedo.theta_i, albedo.values, albedo.known, pixels, azimuths)

    @property
    def target(self) -> FloatArray:
        """The albedos (n, channels) that a fit should have: the measured ones, at most 1."""
        return self.pixels.values

    @property
    def has_another_unit(self) -> bool:
        """Whether the measurement reflects so much that its values cannot be in 1/sr."""
        return bool((self.known[:, None] & (self.values > LARGEST_MEASURED_ALBEDO)).any())

    def judge(self, brdf: Callable[[FloatArray, FloatArray], FloatArray]) -> Albedo:
        """Return the `Albedo` of a fit beside these; `brdf`: (wi, wo) → (n, channels)."""
        angles = (*self.theta_i, *OTHER_ANGLES)
        every = [make_albedo_pixels(angles, (azimuth,)).look(brdf) for azimuth in self.azimuths]
        fit = np.mean(every, axis=0)[: len(self.theta_i)]
        measured = [
            tuple(row.tolist()) if known else None
            for row, known in zip(self.values, self.known, strict=True)
        ]
        peak = self._find_peak(brdf, angles, np.max(every, axis=2))
        return Albedo(self.theta_i, tuple(map(tuple, fit.tolist())), tuple(measured), peak)

    def _find_peak(
        self,
        brdf: Callable[[FloatArray, FloatArray], FloatArray],
        angles: tuple[float, ...],
        peaks: FloatArray,
    ) -> tuple[float, float]:
        """Return the angle [degrees] at which a BRDF reflects most light, and its albedo there.

        `peaks` (azimuths, angles): the largest albedos over the channels; they are computed again,
        with more points, where they are above 1.
        """
        for azimuth, row in np.argwhere(peaks > LARGEST_ALBEDO):
            wi = from_angles(np.radians(angles[row]), self.azimuths[azimuth])
            peaks[azimuth, row] = directional_albedo(brdf, wi).max()
        row = int(np.argmax(peaks.max(axis=0)))
        return angles[row], float(peaks[:, row].max())

    def look(self, brdf: Callable[[FloatArray, FloatArray], FloatArray]) -> FloatArray:
        """Return the albedos (n, channels) of a BRDF (wi, wo) → (n, channels)."""
        return self.pixels.look(brdf)

    def is_right(self, albedos: FloatArray) -> bool:
        """Return whether `albedos` (n, channels) are close to the measured ones, and at most 1."""
        near = self.departure(albedos) <= np.log(ACCEPTED_FACTOR)
        return bool(near and albedos.max() <= LARGEST_ALBEDO)

    def find_wrong_angles(self, albedos: FloatArray) -> BoolArray:
        """Return at which angles (n,) a fit with these `albedos` (n, channels) should improve."""
        dark = self._are_steep() & (self.factors(albedos) < 1)
        return (self.known & ~dark) | (albedos.max(axis=1) > LARGEST_ALBEDO)

    def departure(self, albedos: FloatArray) -> float:
        """Return the distance of `albedos` (n, channels) from the measured ones.

        It is the logarithm of the largest factor between them, plus the logarithm of the largest
        albedo if this is above 1. Albedos that are too dark at grazing angles do not count.
        """
        logs = np.log(self.factors(albedos))
        logs = np.where(self._are_steep(), np.maximum(logs, 0), np.abs(logs))
        most = float(albedos.max())
        return float(logs.max()) + (math.log(most / LARGEST_ALBEDO) if most > LARGEST_ALBEDO else 0)

    def factors(self, albedos: FloatArray) -> FloatArray:
        """Return `albedos` (n, channels) over the measured ones, as means (n,); 1 where unknown."""
        measured, own = (np.maximum(a.mean(axis=1), 1e-9) for a in (self.target, albedos))
        return np.where(self.known, own / measured, 1.0)

    def _are_steep(self) -> BoolArray:
        """Return which angles (n,) are beyond `STEEP_ANGLE`."""
        return np.array(self.theta_i) > STEEP_ANGLE


@dataclass(frozen=True)
class Albedo:
    """The albedos of a fit and of its data.

    Attributes
    ----------
    theta_i : tuple of float
        Angles of incidence [degrees].
    fit : tuple of tuple of float
        The directional albedo of the fit at each angle, by channel.
    measured : tuple of tuple of float or None
        The albedo of the data; None where the samples do not determine it.
    peak : tuple of float, optional
        The angle [degrees], of some angles up to 89°, at which a channel of the fit reflects most,
        and its albedo there.
    """

    theta_i: tuple[float, ...]
    fit: tuple[tuple[float, ...], ...]
    measured: tuple[tuple[float, ...] | None, ...]
    peak: tuple[float, float] | None = None

    def warnings(self) -> list[str]:
        """Return sentences on what is wrong with the albedos of the fit."""
        sentences = []
        most = [max(albedos) for albedos in self.fit]
        pairs = list(zip(self.theta_i, most, strict=True))
        angle, gain = self.peak or max(pairs, key=lambda pair: pair[1])
        if gain > LARGEST_ALBEDO:
            text = f"{gain:.3f}" if gain < 1.01 else format_share(gain)
            sentences.append(
                f"it reflects {text} of the light at {angle:g}°, more than arrives; a "
                "constraint prevents it: AlbedoAtMost(1), or --albedo-at-most 1"
            )
        means = zip(self.theta_i, *self.means(), strict=True)
        angle, fit, measured = max(means, key=lambda row: factor_between(row[1], min(row[2], 1.0)))
        if factor_between(fit, min(measured, 1.0)) > WRONG_FACTOR:
            sentences.append(
                f"it reflects {format_share(fit)} of the light at {angle:g}°, where the "
                f"measurement reflects {format_share(measured)}"
            )
        return sentences

    def means(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Return the albedos of the fit and of its data at each angle, averaged over the channels.

        They are nan where the samples do not determine them.
        """
        fit = tuple(sum(row) / len(row) for row in self.fit)
        measured = tuple(sum(row) / len(row) if row else math.nan for row in self.measured)
        return fit, measured


def format_share(share: float) -> str:
    """Return a share of light as text.

    >>> format_share(0.3521), format_share(0.01201), format_share(2e9)
    ('0.35', '0.012', '2e+09')
    """
    if share >= 1000:
        return f"{share:.3g}"
    return f"{share:.2f}" if share >= 0.1 else f"{share:#.2g}"


def factor_between(one: float, other: float) -> float:
    """Return the factor between two albedos, at least 1; it is 1 if one of them is nan."""
    if math.isnan(one + other):
        return 1.0
    low, high = sorted((max(one, 1e-9), max(other, 1e-9)))
    return high / low
