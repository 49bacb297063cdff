"""Converts the shape parameters of a texel to numbers that a least-squares search can step along.

A parameter that is declared logarithmic is searched by its logarithm. Two widths u and v whose
directions turn about the normal by an angle ψ become three numbers, which have no seam and no point
where a direction is undefined:

    m = (log u + log v) / 2,    (p, q) = (log u - log v) / 2 · (cos 2ψ, sin 2ψ)
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.model import Model

ANGLE = "anisotropy_angle"  # [radians] from the sample's x to the direction of u, counterclockwise
P_OFFSET = 1e-7  # added to p, because an angle has no derivatives at p = q = 0
LARGEST_P = 2.0  # also of q: one width is then about 50 times the other
UNKNOWN_ANGLE_ERROR = np.pi / np.sqrt(12)  # standard deviation of a random direction [radians]


@dataclass(frozen=True)
class ShapeParameters:
    """The shape parameters `names` of a `model` that are searched.

    `pair` holds the names of two widths (u, v) whose directions turn about the normal, or is None.
    """

    model: type[Model]
    names: tuple[str, ...]
    pair: tuple[str, str] | None

    @property
    def single(self) -> list[str]:
        """The names of the parameters that are one number each."""
        return [name for name in self.names if name not in (self.pair or ())]

    @property
    def number_names(self) -> list[str]:
        """A name for each number; the last three are those of the pair."""
        return [*self.single, *((*self.pair, ANGLE) if self.pair else ())]

    def limits(self) -> FloatArray:
        """Return the lowest and the highest numbers as two rows."""
        names = [*self.single, *(self.pair or ())[:1]]
        ends = [self._to_number(n, np.array(self.model.parameters[n].bounds)) for n in names]
        turning = [(-LARGEST_P, LARGEST_P)] * 2 if self.pair else []
        return np.array([*ends, *turning]).reshape(-1, 2).T

    def to_values(self, numbers: Any, math: Any = np) -> dict[str, Any]:
        """Return the parameters by name, with the `ANGLE` of a pair, at numbers, an array each.

        `math` is the module for the arrays: numpy or drjit.
        """
        single = self.single
        values = {n: self._to_value(n, x, math) for n, x in zip(single, numbers, strict=False)}
        if self.pair:
            middle, p, q = numbers[len(single) :]
            p = p + P_OFFSET
            half = math.sqrt(p * p + q * q)
            for name, number in zip(self.pair, (middle + half, middle - half), strict=True):
                low, high = self.model.parameters[name].bounds
                value = self._to_value(name, number, math)
                values[name] = math.minimum(math.maximum(value, low), high)
            arc = np.arctan2 if math is np else math.atan2
            values[ANGLE] = arc(q, p) / 2
        return values

    def to_numbers(self, values: Mapping[str, Any]) -> list[AnyArray]:
        """Return the numbers, an array each, at parameters by name; inverts `to_values`."""
        numbers = [self._to_number(name, values[name]) for name in self.single]
        if self.pair:
            u, v = (self._to_number(name, values[name]) for name in self.pair)
            half, angle = (u - v) / 2, 2 * values.get(ANGLE, 0 * u)
            numbers += [(u + v) / 2, half * np.cos(angle), half * np.sin(angle)]
        return numbers

    def propagate_errors(self, numbers: FloatArray, errors: FloatArray) -> dict[str, FloatArray]:
        """Return the standard errors of the parameters by name, given those of the numbers.

        Both arguments are (numbers, n), for n texels.
        """
        values, count = self.to_values(numbers), len(self.single)
        by_name = {
            name: self._slope(name, values[name]) * error
            for name, error in zip(self.single, errors, strict=False)
        }
        if self.pair:
            (_, p, q), (error_m, error_p, error_q) = numbers[count:], errors[count:]
            half = np.maximum(np.hypot(p, q), P_OFFSET)
            along = np.hypot(p * error_p, q * error_q) / half
            across = np.hypot(q * error_p, p * error_q) / half
            for name in self.pair:
                by_name[name] = self._slope(name, values[name]) * np.hypot(error_m, along)
            by_name[ANGLE] = np.minimum(across / (2 * half), UNKNOWN_ANGLE_ERROR)
        return by_name

    def _to_number(self, name: str, value: AnyArray) -> AnyArray:
        """Return the number for a value of the parameter `name`."""
        with np.errstate(divide="ignore"):
            return np.log(value) if self.model.parameters[name].log else value

    def _to_value(self, name: str, number: Any, math: Any) -> Any:
        """Return the value of the parameter `name` for a number."""
        return math.exp(number) if self.model.parameters[name].log else number

    def _slope(self, name: str, value: AnyArray) -> Any:
        """Return the derivative of the parameter `name` by its number, at a value."""
        return value if self.model.parameters[name].log else 1.0
