"""The light that a fit reflects, beside that of its data: albedos at a few angles of incidence."""

import math
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.quadrature import directional_albedo, make_ring_rule
from brdfkit.images.ball import Pixels

# The factor between the albedos of a fit and its data beyond which the fit is searched once more,
# and the one beyond which its light is said to be wrong: 1.25, less what a quadrature may be off
HELD, WRONG = 1.2, 1.24
# Beyond this angle [degrees] a model that is too dark is left so: few rise as materials do
STEEP = 60
# More angles of incidence [degrees] at which a fit is only looked at
OTHERS = 60.0, 80.0, 89.0
# No surface reflects more; beyond rounding of the quadrature
ALL = 1.001
# A measurement that reflects more has another unit than 1/sr, and tells nothing of light
OTHER_UNIT = 2.0
# Half the rings of the quadrature, and the points on each
POINTS = 32
# Azimuths of incidence [rad], of an isotropic material and of another one
ONE, FOUR = (0.0,), tuple(np.arange(4) * np.pi / 2)
UP = 0.0, 0.0, 1.0


@cache
def albedo_pixels(theta_i: tuple[float, ...], azimuths: tuple[float, ...] = ONE) -> Pixels:
    """The quadrature by which `Pixels.look` gives the albedos (n, channels) of a BRDF for light
    from angles `theta_i` [degrees] (n,), the mean over `azimuths` [rad]; without values."""
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
    """What a measurement reflects of light from some angles.

    `theta_i`: the angles [degrees] (n,); `values` (n, channels): the albedos; `known` (n,): whether
    the samples tell them; `pixels`: the quadrature that sums a model up to its own albedos, the
    mean over `azimuths` [rad].
    """

    theta_i: tuple[float, ...]
    values: NDArray[np.float64]
    known: NDArray[np.bool_]
    pixels: Pixels
    azimuths: tuple[float, ...]

    @classmethod
    def of(cls, albedo, anisotropic):
        """The light of a `MeasuredAlbedo`."""
        azimuths = FOUR if anisotropic else ONE
        pixels = albedo_pixels(albedo.theta_i, azimuths)
        target = np.minimum(albedo.values, 1)  # what a file may gain, no fit should
        pixels = replace(pixels, values=target)
        return cls(albedo.theta_i, albedo.values, albedo.known, pixels, azimuths)

    @property
    def target(self):
        """The albedos (n, channels) that a fit should have: the measured ones, but at most 1."""
        return self.pixels.values

    @property
    def has_another_unit(self):
        """Whether the measurement reflects so much that its values cannot be in 1/sr."""
        return bool((self.known[:, None] & (self.values > OTHER_UNIT)).any())

    def judge(self, brdf):
        """The `Albedo` of a fit, a BRDF (wi, wo) → (n, channels)."""
        angles = (*self.theta_i, *OTHERS)
        every = [albedo_pixels(angles, (azimuth,)).look(brdf) for azimuth in self.azimuths]
        fit = np.mean(every, axis=0)[: len(self.theta_i)]
        measured = [
            tuple(row.tolist()) if known else None
            for row, known in zip(self.values, self.known, strict=True)
        ]
        peak = self._find_peak(brdf, angles, np.max(every, axis=2))
        return Albedo(self.theta_i, tuple(map(tuple, fit.tolist())), tuple(measured), peak)

    def _find_peak(self, brdf, angles, peaks):
        """The angle at which a BRDF reflects most, and how much that is, of its `peaks` (azimuths,
        angles): summed with more points where it seems to gain light."""
        for azimuth, row in np.argwhere(peaks > ALL):
            wi = from_angles(np.radians(angles[row]), self.azimuths[azimuth])
            peaks[azimuth, row] = directional_albedo(brdf, wi).max()
        row = int(np.argmax(peaks.max(axis=0)))
        return angles[row], float(peaks[:, row].max())

    def look(self, brdf):
        """The albedos (n, channels) of a BRDF (wi, wo) → (n, channels)."""
        return self.pixels.look(brdf)

    def is_right(self, albedos):
        """Whether `albedos` (n, channels) are near the measured ones, and no light is gained."""
        return self.departure(albedos) <= np.log(HELD) and albedos.max() <= ALL

    def counted(self, albedos):
        """The angles (n,) at which a fit of these `albedos` (n, channels) is to come nearer."""
        dark = self._steep() & (self.factors(albedos) < 1)
        return (self.known & ~dark) | (albedos.max(axis=1) > ALL)

    def departure(self, albedos):
        """How far `albedos` (n, channels) are from the measured ones, as the logarithm of the
        largest factor; light that is gained adds its own. A model that is too dark at grazing
        angles is not far."""
        apart = np.log(self.factors(albedos))
        apart = np.where(self._steep(), np.maximum(apart, 0), np.abs(apart))
        most = albedos.max()
        return float(apart.max()) + (float(np.log(most / ALL)) if most > ALL else 0.0)

    def factors(self, albedos):
        """The light of `albedos` (n, channels) over the measured (n,); 1 where that is unknown."""
        measured, own = (np.maximum(a.mean(axis=1), 1e-9) for a in (self.target, albedos))
        return np.where(self.known, own / measured, 1.0)

    def _steep(self):
        return np.array(self.theta_i) > STEEP


@dataclass(frozen=True)
class Albedo:
    """The light that a fit reflects, and its data.

    Attributes
    ----------
    theta_i : tuple of float
        Angles of incidence [degrees].
    fit : tuple of tuple of float
        The directional albedo of the fit at each angle, by channel.
    measured : tuple of tuple of float or None
        That of the data; None where the samples do not tell it.
    peak : tuple of float, optional
        The angle [degrees], of some up to 89°, at which a channel of the fit reflects most, and how
        much that is.
    """

    theta_i: tuple[float, ...]
    fit: tuple[tuple[float, ...], ...]
    measured: tuple[tuple[float, ...] | None, ...]
    peak: tuple[float, float] | None = None

    def warnings(self) -> list[str]:
        """What is wrong with the light of the fit, in sentences."""
        found = []
        most = [max(albedos) for albedos in self.fit]
        pairs = list(zip(self.theta_i, most, strict=True))
        angle, gain = self.peak or max(pairs, key=lambda pair: pair[1])
        if gain > ALL:
            text = f"{gain:.3f}" if gain < 1.01 else format_share(gain)
            found.append(
                f"it reflects {text} of the light at {angle:g}°, more than arrives; a "
                "constraint prevents it: AlbedoAtMost(1), or --albedo-at-most 1"
            )
        means = zip(self.theta_i, *self.means(), strict=True)
        angle, fit, measured = max(means, key=lambda row: factor_between(row[1], min(row[2], 1.0)))
        if factor_between(fit, min(measured, 1.0)) > WRONG:
            found.append(
                f"it reflects {format_share(fit)} of the light at {angle:g}°, where the "
                f"measurement reflects {format_share(measured)}"
            )
        return found

    def means(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """The mean over the channels of the light of the fit, and of its data, at each angle; nan
        where the samples do not tell it."""
        fit = tuple(sum(row) / len(row) for row in self.fit)
        measured = tuple(sum(row) / len(row) if row else math.nan for row in self.measured)
        return fit, measured


def format_share(share: float) -> str:
    """A share of light as text.

    >>> format_share(0.3521), format_share(0.01201), format_share(2e9)
    ('0.35', '0.012', '2e+09')
    """
    if share >= 1000:
        return f"{share:.3g}"
    return f"{share:.2f}" if share >= 0.1 else f"{share:#.2g}"


def factor_between(one: float, other: float) -> float:
    """The factor between two albedos, at least 1, and 1 where one of them is nan."""
    if math.isnan(one + other):
        return 1.0
    low, high = sorted((max(one, 1e-9), max(other, 1e-9)))
    return high / low
