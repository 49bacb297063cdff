"""`Reach`: what an instrument reaches, and the pairs of directions that it could measure.

A pair is given by three angles [degrees]: θi of the light and θo of the detector to the normal, and
the azimuth φ between them, 180 in the mirror direction. An isotropic material is the same on both
sides of the plane of incidence, so φ is between 0 and 180.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Self, TypedDict

import numpy as np

from brdfkit.core.arguments import to_dictionary, to_number, wrong_value_error
from brdfkit.core.array_types import AnyArray, BoolArray, FloatArray
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.geometry.directions import (
    from_angles,
    from_half_difference,
    normalize,
    to_angles,
)

LARGEST_ANGLE = 85.0  # nearer to the horizon, a prior knows nothing [degrees]
LEAST_STEP = 0.001  # [degrees]
CANDIDATES = 6_000  # of more pairs on the grid of the arms, about so many are drawn
ROUNDS = 30  # of draws, of `CANDIDATES` pairs each


class Reach(TypedDict, total=False):
    """What an instrument reaches; every entry may be left out. All angles are in degrees.

    `max_theta_i`, `max_theta_o`: largest angle to the normal of the light and of the detector, 75.
    `separation`: least angle between light and detector, where one does not shade the other, 5.
    `step`: step of the arms, 0.5. `in_plane`: whether the arms stay in one plane, False. `theta_i`:
    the angles of a light that has only a few places.
    """

    max_theta_i: float
    max_theta_o: float
    separation: float
    step: float
    in_plane: bool
    theta_i: Sequence[float]


@dataclass(frozen=True)
class Arms:
    """A checked `Reach`, with defaults for the entries that were left out."""

    max_theta_i: float = 75.0
    max_theta_o: float = 75.0
    separation: float = 5.0
    step: float = 0.5
    in_plane: bool = False
    theta_i: tuple[float, ...] = ()

    @classmethod
    def from_reach(cls, reach: Mapping[str, Any] | None) -> Self:
        """Return the arms of a user's `reach`; raise `BrdfkitError` for what cannot be."""
        given = to_dictionary("reach", reach)
        for name in given:
            if name not in cls.__annotations__:
                raise no_such_error("entry", name, cls.__annotations__, "reach")
        limits = {"max_theta_i": LARGEST_ANGLE, "max_theta_o": LARGEST_ANGLE, "step": 45.0}
        for name in limits.keys() & given.keys():
            least: Any = {"least": LEAST_STEP} if name == "step" else {"above": 0}
            given[name] = to_number(f"reach: {name}", given[name], most=limits[name], **least)
        if "separation" in given:
            given["separation"] = to_number("reach: separation", given["separation"], 0, 90)
        if not isinstance(given.get("in_plane", False), bool):
            raise wrong_value_error("reach: in_plane", given["in_plane"], "True or False")
        if "theta_i" in given:
            places = to_places(given["theta_i"])
            most = given.setdefault("max_theta_i", max(places))
            if max(places) > most:
                raise BrdfkitError(
                    f"reach: theta_i = {max(places):g} is larger than max_theta_i = {most:g}; "
                    "leave one of them out."
                )
            given["theta_i"] = places
        return cls(**given)

    def describe(self) -> str:
        """Return the reach in words."""
        light = f"light to {self.max_theta_i:g}°"
        if self.theta_i:
            light = f"light at {', '.join(f'{angle:g}' for angle in self.theta_i)}°"
        plane = ", in the plane of incidence" if self.in_plane else ""
        return (
            f"{light}, detector to {self.max_theta_o:g}°, at least {self.separation:g}° apart, in "
            f"steps of {self.step:g}°{plane}"
        )

    def list_candidates(self, seed: int) -> FloatArray:
        """Return angles (n, 3) [degrees] of pairs that the instrument reaches, each once.

        They are all pairs on the grid of the arms, or `CANDIDATES` of them, drawn evenly in the
        cells of a prior with a `seed`.
        """
        axes = [
            self.theta_i or np.arange(0, self.max_theta_i + 1e-9, self.step),
            np.arange(0, self.max_theta_o + 1e-9, self.step),
            np.array([0.0, 180.0]) if self.in_plane else 180 - np.arange(0, 180.01, self.step),
        ]
        if np.prod([len(axis) for axis in axes]) <= CANDIDATES:
            grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
            found = self._select(grid)
        else:
            found = self._draw(np.random.default_rng(seed))
        if not len(found):
            raise BrdfkitError(
                f"The instrument reaches no pair of directions ({self.describe()}); give larger "
                "angles, or a smaller step or separation."
            )
        return found

    def _draw(self, rng: np.random.Generator) -> FloatArray:
        """Draw about `CANDIDATES` pairs, or fewer if many rounds find no more."""
        found = np.empty((0, 3))
        for _ in range(ROUNDS):
            more = self._select(self._to_grid(self._draw_pairs(rng)))
            found = np.concatenate([found, more])
            # Keep the order of the draws: sorted pairs, cut off, would lack large angles
            _, first = np.unique(found, axis=0, return_index=True)
            found = found[np.sort(first)]
            if len(found) >= CANDIDATES:
                break
        return found[:CANDIDATES]

    def _draw_pairs(self, rng: np.random.Generator) -> FloatArray:
        """Draw angles (n, 3) [degrees] of pairs, evenly in the square root of θh and in θd."""
        h, d, p = rng.random((3, CANDIDATES))
        theta_h = np.radians(max(self.max_theta_i, self.max_theta_o)) * h**2
        turn = np.pi * (p < 0.5) if self.in_plane else 2 * np.pi * p
        if self.theta_i:
            wi = from_angles(np.radians(rng.choice(self.theta_i, CANDIDATES)), 0.0)
            half = from_angles(theta_h, turn)
            wo = normalize(2 * np.sum(wi * half, axis=1, keepdims=True) * half - wi)
        else:
            theta_d = np.radians((self.max_theta_i + self.max_theta_o) / 2) * d
            wi, wo = from_half_difference(theta_h, theta_d, turn)
        (theta_i, phi_i), (theta_o, phi_o) = to_angles(wi), to_angles(wo)
        return np.degrees(np.stack([theta_i, theta_o, phi_o - phi_i], axis=1))

    def _to_grid(self, angles: AnyArray) -> FloatArray:
        """Return the points of the arms' grid next to `angles` (n, 3) [degrees]."""
        step = self.step
        theta_i, theta_o = (np.round(column / step) * step for column in angles[:, :2].T)
        if self.theta_i:
            places = np.array(self.theta_i)
            theta_i = places[np.argmin(np.abs(angles[:, :1] - places), axis=1)]
        # The azimuth to the mirror direction, on either side of the plane of incidence
        beside = np.abs((angles[:, 2] + 360) % 360 - 180)
        beside = np.round(beside / 180) * 180 if self.in_plane else np.round(beside / step) * step
        return np.stack([theta_i, theta_o, 180 - beside], axis=1)

    def _select(self, angles: AnyArray) -> FloatArray:
        """Return those of `angles` (n, 3) [degrees] that the instrument reaches, each once."""
        angles = np.round(angles, 9)
        angles[(angles[:, :2] == 0).any(axis=1), 2] = 180  # at the normal, φ has no meaning
        reached = angles[self.contains(angles)]
        _, first = np.unique(reached, axis=0, return_index=True)
        return np.asarray(reached[np.sort(first)])

    def contains(self, angles: AnyArray) -> BoolArray:
        """Return a mask (n,) of the pairs, `angles` (n, 3) [degrees], within the arms' limits."""
        theta_i, theta_o, phi = angles.T
        wi, wo = to_directions(angles)
        apart = np.degrees(np.arccos(np.clip(np.sum(wi * wo, axis=1), -1, 1)))
        inside = (theta_i <= self.max_theta_i) & (theta_o <= self.max_theta_o) & (phi >= 0)
        return np.asarray(inside & (apart >= self.separation - 1e-6))


def to_directions(angles: AnyArray) -> tuple[FloatArray, FloatArray]:
    """Return the directions wi, wo (n, 3) of `angles` (n, 3) [degrees], wi at the azimuth 0."""
    theta_i, theta_o, phi = np.radians(angles).T
    return from_angles(theta_i, 0.0), from_angles(theta_o, phi)


def to_places(value: Any) -> tuple[float, ...]:
    """Return a user's list of angles θi [degrees], sorted; a single number is a list of one."""
    several = value if isinstance(value, Sequence | np.ndarray) else [value]
    if isinstance(value, str) or not len(several):
        raise wrong_value_error("reach: theta_i", value, "a list of angles in degrees")
    return tuple(sorted({to_number("reach: theta_i", v, 0, LARGEST_ANGLE) for v in several}))
