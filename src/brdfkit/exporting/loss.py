"""Measures how far what a target draws is from the material: log error, and ΔE of a ball."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import FloatArray
from brdfkit.images.ball.ball import draw_ball
from brdfkit.images.errors.colour_difference import ciede2000
from brdfkit.materials.converting import PAIRS, draw_direction_pairs

FLOOR = 1e-3  # is added to f cosθ_i cosθ_o, as in the loss "log"
SIDE = 64  # pixels of the ball's picture


class Drawable(Protocol):
    """The interface of what a target draws: of every material, and of tables of a target's own."""

    @property
    def name(self) -> str:
        """The name in the comments of files."""

    def eval(self, wi: FloatArray, wo: FloatArray) -> NDArray[np.float64]:
        """Return the BRDF [sr⁻¹] (n, channels) for directions to light and viewer, (n, 3) each."""


@dataclass(frozen=True)
class Loss:
    """How far what a target draws is from the material.

    `log_error`: RMS difference of ln(f cosθ_i cosθ_o + 0.001) over random pairs of directions, as
    in the loss "log": 0.1 is about 10 %; `delta_e`: the mean colour difference ΔE2000 of the
    pixels of a ball in a studio's light.
    """

    log_error: float
    delta_e: float

    def __str__(self) -> str:
        log_error, delta_e = (round(value, 6) for value in (self.log_error, self.delta_e))
        return f"log error {log_error:.2g}, mean ΔE {delta_e:.2g}"


def measure_loss(material: Drawable, drawn: Drawable) -> Loss:
    """Compare what a target draws with the `material`, both in linear sRGB."""
    if drawn is material:
        return Loss(0.0, 0.0)
    return Loss(measure_log_error(material, drawn), compare_balls(material, drawn))


def measure_log_error(material: Drawable, drawn: Drawable) -> float:
    """Return the RMS difference of ln(f cosθ_i cosθ_o + 0.001) over random pairs of directions."""
    wi, wo = draw_direction_pairs(PAIRS)
    first, other = (thing.eval(wi, wo) for thing in (material, drawn))
    return compute_log_error(first, other, wi, wo)


def compute_log_error(
    first: FloatArray, other: FloatArray, wi: FloatArray, wo: FloatArray
) -> float:
    """Return the RMS difference of ln(f cosθ_i cosθ_o + 0.001) of two BRDFs' values (n, channels).

    `wi`, `wo` (n, 3): their directions.
    """
    cosines = wi[:, 2:] * wo[:, 2:]
    logs = [np.log(np.maximum(values, 0) * cosines + FLOOR) for values in (first, other)]
    return float(np.sqrt(np.mean((logs[1] - logs[0]) ** 2)))


def compare_balls(material: Drawable, drawn: Drawable) -> float:
    """Return the mean colour difference of two materials' balls, over the pixels of the ball."""
    pictures = [draw_ball(thing.eval, SIDE) for thing in (material, drawn)]
    cover = pictures[0][1]
    first, second = (np.broadcast_to(p, (SIDE, SIDE, 3)) for p, _ in pictures)
    return float(np.average(ciede2000(first, second), weights=cover))
