"""Converts the shape parameters of a texel to numbers that a least-squares search can step along.

A parameter that is declared logarithmic is searched by its logarithm. An anisotropic lobe has
two widths u and v, whose directions are turned about the normal by an angle ψ. They become three
numbers m, p and q. These stay continuous where ψ jumps, or is undefined because u = v:

    m = (log u + log v) / 2,    (p, q) = (log u - log v) / 2 · (cos 2ψ, sin 2ψ)
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.model import Model

# The map with the angle [radians] from the sample's x axis to the direction of the width u
ANGLE = "anisotropy_angle"
P_OFFSET = 1e-7  # added to the number p, because the angle ψ has no derivatives at p = q = 0
LARGEST_P = 2.0  # largest |p| and |q|; there, one width is about 50 times the other
# standard deviation of an angle that is random between 0 and π
UNKNOWN_ANGLE_ERROR = np.pi / np.sqrt(12)


@dataclass(frozen=True)
class ShapeParameters:
    """The searched shape parameters of a BRDF model, and their conversion to searched numbers.

    model : the model's class.
    names : the names of the parameters that are searched.
    pair : the names of two lobe widths (u, v) whose directions turn about the normal, or None.
    """

    model: type[Model]
    names: tuple[str, ...]
    pair: tuple[str, str] | None

    @property
    def single_names(self) -> list[str]:
        """The names of the parameters that one number represents, without the pair of widths."""
        return [name for name in self.names if name not in (self.pair or ())]

    @property
    def number_names(self) -> list[str]:
        """A name for each searched number; the last three belong to the pair of widths."""
        return [*self.single_names, *((*self.pair, ANGLE) if self.pair else ())]

    def find_limits(self) -> FloatArray:
        """Return the lowest and the highest value of each searched number, as two rows."""
        names = [*self.single_names, *(self.pair or ())[:1]]
        ends = [
            self._convert_to_search_number(n, np.array(self.model.parameters[n].bounds))
            for n in names
        ]
        turning = [(-LARGEST_P, LARGEST_P)] * 2 if self.pair else []
        return np.array([*ends, *turning]).reshape(-1, 2).T

    def to_parameter_values(self, numbers: Any, math: Any = np) -> dict[str, Any]:
        """Return the values of the parameters, by name, from the searched numbers.

        A pair of widths also has its `ANGLE`. `numbers` holds an array for each searched number,
        and `math` is the module of these arrays, numpy or drjit.
        """
        single = self.single_names
        values = {
            n: self._convert_to_parameter_value(n, x, math)
            for n, x in zip(single, numbers, strict=False)
        }
        if self.pair:
            middle, p, q = numbers[len(single) :]
            p = p + P_OFFSET
            half = math.sqrt(p * p + q * q)
            for name, number in zip(self.pair, (middle + half, middle - half), strict=True):
                low, high = self.model.parameters[name].bounds
                value = self._convert_to_parameter_value(name, number, math)
                values[name] = math.minimum(math.maximum(value, low), high)
            arc = np.arctan2 if math is np else math.atan2
            values[ANGLE] = arc(q, p) / 2
        return values

    def to_search_numbers(self, values: Mapping[str, Any]) -> list[AnyArray]:
        """Return an array for each searched number, from the parameters' `values` by name."""
        numbers = [self._convert_to_search_number(name, values[name]) for name in self.single_names]
        if self.pair:
            u, v = (self._convert_to_search_number(name, values[name]) for name in self.pair)
            half, angle = (u - v) / 2, 2 * values.get(ANGLE, 0 * u)
            numbers += [(u + v) / 2, half * np.cos(angle), half * np.sin(angle)]
        return numbers

    def propagate_errors(self, numbers: FloatArray, errors: FloatArray) -> dict[str, FloatArray]:
        """Return the standard errors of the parameters by name, from those of the searched numbers.

        Both arguments are (numbers, n), for n texels.
        """
        values, count = self.to_parameter_values(numbers), len(self.single_names)
        by_name = {
            name: self._differentiate(name, values[name]) * error
            for name, error in zip(self.single_names, errors, strict=False)
        }
        if self.pair:
            (_, p, q), (error_m, error_p, error_q) = numbers[count:], errors[count:]
            half = np.maximum(np.hypot(p, q), P_OFFSET)
            along = np.hypot(p * error_p, q * error_q) / half
            across = np.hypot(q * error_p, p * error_q) / half
            for name in self.pair:
                by_name[name] = self._differentiate(name, values[name]) * np.hypot(error_m, along)
            by_name[ANGLE] = np.minimum(across / (2 * half), UNKNOWN_ANGLE_ERROR)
        return by_name

    def _convert_to_search_number(self, name: str, value: AnyArray) -> AnyArray:
        """Return the number that a search uses for a value of the parameter `name`.

        It is the logarithm of the value if the parameter is logarithmic, else the value itself.
        """
        with np.errstate(divide="ignore"):
            return np.log(value) if self.model.parameters[name].log else value

    def _convert_to_parameter_value(self, name: str, number: Any, math: Any) -> Any:
        """Return the value of the parameter `name` for the number that a search uses."""
        return math.exp(number) if self.model.parameters[name].log else number

    def _differentiate(self, name: str, value: AnyArray) -> Any:
        """Return how fast the parameter `name` grows with its searched number, at this `value`."""
        return value if self.model.parameters[name].log else 1.0
