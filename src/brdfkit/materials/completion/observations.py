"""Observations: measured values as logarithms, and what noise and wrong directions add to them.

A value that an instrument measured differs from the BRDF at the stated pair of directions by noise,
by directions that are off by an angle δ, and because its apertures average over a cone. Noise and
wrong directions are variances of the logarithm; the cone is part of the model of the measurement.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, IntArray
from brdfkit.core.geometry.directions import normalize
from brdfkit.materials.completion.prior_cells import (
    compute_cosine,
    find_nodes,
    from_logarithm,
    to_logarithm,
)
from brdfkit.materials.measured.evidence import OFFSET

TURNS = 8  # random turns of both directions, of which the variance is taken
LEAST_SHARE = 0.1  # of f c in f c + e: noise of dark values is no smaller than this share of it
CONE_POINTS = 6  # points of a cone, beside its axis
SEED = 0


@dataclass(frozen=True, eq=False)
class Lookup:
    """Pairs of directions, and how they depend on the cells of a prior.

    `cosine` (n,): c. `nodes`, `shares` (n, 8): the cells around each pair, and their shares.
    """

    cosine: FloatArray
    nodes: IntArray
    shares: FloatArray

    @classmethod
    def at(cls, wi: AnyArray, wo: AnyArray) -> "Lookup":
        """Return the lookup of direction pairs (n, 3)."""
        return cls(compute_cosine(wi, wo), *find_nodes(wi, wo))

    def interpolate(self, values: AnyArray) -> FloatArray:
        """Return values of the cells (CELLS, ...) at the pairs (n, ...)."""
        result = np.zeros((len(self.nodes), *values.shape[1:]))
        for nodes, share in zip(self.nodes.T, self.shares.T, strict=True):
            result += share.reshape(-1, *(1,) * (values.ndim - 1)) * values[nodes]
        return result


@dataclass(frozen=True, eq=False)
class Observations:
    """Measured values of a material's channels.

    `logarithm` (n, channels): ln(f c + e). `variance` (n, channels): the variance of its noise.
    `lookup`: the stated directions. `turned`: lookups of wrong directions, empty if δ is 0.
    `cone`: lookups of the directions over which the instrument averages, the stated one alone if
    its apertures are small.
    """

    logarithm: FloatArray
    variance: FloatArray
    lookup: Lookup
    turned: tuple[Lookup, ...]
    cone: tuple[Lookup, ...]

    def __len__(self) -> int:
        return len(self.logarithm)

    @property
    def depends_on_material(self) -> bool:
        """Whether its model depends on the material, so that a solution takes several rounds."""
        return bool(self.turned) or len(self.cone) > 1

    def compute_turned_variance(self, logarithm: AnyArray) -> FloatArray:
        """Return the variance (n,) by wrong directions of a material's `logarithm` (CELLS,)."""
        if not self.turned:
            return np.zeros(len(self))
        stated = self.lookup.interpolate(logarithm)
        shifts = []
        for turned in self.turned:
            values = from_logarithm(turned.interpolate(logarithm), turned.cosine)
            shifts.append(to_logarithm(values, self.lookup.cosine) - stated)
        return np.mean(np.square(shifts), axis=0)

    def predict(self, logarithm: AnyArray) -> tuple[FloatArray, list[FloatArray]]:
        """Return what would be measured of a material of the given `logarithm` (CELLS,).

        Also returns the derivative (n,) by the logarithm at each direction of the cone.
        """
        logs = [part.interpolate(logarithm) for part in self.cone]
        if len(logs) == 1:
            return logs[0], [np.ones(len(self))]
        values = [from_logarithm(y, part.cosine) for y, part in zip(logs, self.cone, strict=True)]
        measured = to_logarithm(np.mean(values, axis=0), self.lookup.cosine)
        scale = self.lookup.cosine / np.exp(measured) / len(self.cone)
        slopes: list[FloatArray] = [
            scale * np.exp(y) / part.cosine for y, part in zip(logs, self.cone, strict=True)
        ]
        return measured, slopes


def observe(
    wi: AnyArray,
    wo: AnyArray,
    values: AnyArray,
    noise: AnyArray | float,
    alignment: float = 0.0,
    aperture: float = 0.0,
) -> Observations:
    """Return the `Observations` of BRDF `values` (n, channels) [sr⁻¹] at direction pairs (n, 3).

    `noise` is the relative standard deviation, a number or (n, channels); `alignment` δ the angle
    [rad] by which directions are off, and `aperture` the half angle [rad] of the cone over which a
    value is a mean.
    """
    lookup = Lookup.at(wi, wo)
    logarithm = to_logarithm(values.T, lookup.cosine).T
    # A relative error of f is a smaller one of f c + e where f c is not much larger than e
    share = 1 - OFFSET / np.exp(logarithm)
    variance = (np.asarray(noise) * np.maximum(share, LEAST_SHARE)) ** 2
    variance = np.broadcast_to(np.maximum(variance, 1e-6), logarithm.shape)
    turned = tuple(turn_pairs(wi, wo, alignment))
    cone = [lookup]
    for k in range(CONE_POINTS * (aperture > 0)):
        azimuth = np.full(len(wo), 2 * pi * k / CONE_POINTS)
        # A disc of radius a has the variance of its centre and six points at 0.764 a
        cone.append(Lookup.at(wi, turn(wo, 0.764 * aperture, azimuth)))
    return Observations(logarithm, variance, lookup, turned, tuple(cone))


def turn_pairs(wi: AnyArray, wo: AnyArray, angle: float) -> Iterator[Lookup]:
    """Yield `TURNS` lookups of pairs (n, 3) that are off by an `angle` [rad], none if it is 0.

    Each direction is turned towards a random azimuth of its own.
    """
    rng = np.random.default_rng(SEED)
    for _ in range(TURNS * (angle > 0)):
        yield Lookup.at(*(turn(w, angle, rng.uniform(0, 2 * pi, len(w))) for w in (wi, wo)))


def turn(w: AnyArray, angle: float, azimuth: AnyArray) -> FloatArray:
    """Return directions (n, 3) turned by an `angle` [rad] towards an `azimuth` (n,) about each.

    They stay above the surface.
    """
    side = normalize(np.cross(w, np.where(np.abs(w[:, :1]) < 0.9, [1.0, 0, 0], [0, 1.0, 0])))
    other = np.cross(w, side)
    azimuth = azimuth[:, None]
    moved = np.cos(angle) * w + np.sin(angle) * (np.cos(azimuth) * side + np.sin(azimuth) * other)
    moved[:, 2] = np.maximum(moved[:, 2], 1e-3)
    return normalize(moved)
