"""The shape parameters of a texel as numbers that a search may add to.

Of widths that are declared so the logarithms; of widths along two directions, u and v, that turn
about the normal by ψ, three numbers without a seam or a point where a direction is undefined:

    m = (log u + log v) / 2,    (p, q) = (log u - log v) / 2 · (cos 2ψ, sin 2ψ)
"""

from dataclasses import dataclass

import numpy as np

ANGLE = "anisotropy_angle"  # [radians] of u, the larger, from the sample's x, counterclockwise
AROUND = 1e-7  # added to p: at 0 an angle has no derivatives
LARGEST = 2.0  # p and q at most: widths 50 times as large in one direction
UNKNOWN = np.pi / np.sqrt(12)  # the standard error of an angle that is open


@dataclass(frozen=True)
class Shapes:
    """The shape parameters `names` of a `model`, of which the `pair` (u, v), if any, turns."""

    model: type
    names: tuple[str, ...]
    pair: tuple[str, str] | None

    @property
    def alone(self):
        """The names of those that are a number each."""
        return [name for name in self.names if name not in (self.pair or ())]

    @property
    def columns(self):
        """What the numbers are called."""
        return [*self.alone, *((*self.pair, ANGLE) if self.pair else ())]

    def limits(self):
        """The lowest and the highest numbers, a row each."""
        names = [*self.alone, *(self.pair or ())[:1]]
        ends = [self._number(name, np.array(self.model.parameters[name].bounds)) for name in names]
        turning = [(-LARGEST, LARGEST)] * 2 if self.pair else []
        return np.array([*ends, *turning]).reshape(-1, 2).T

    def values(self, numbers, math=np):
        """The parameters by name, and the `ANGLE` of a pair, of `numbers`, an array each.

        `math` : numpy, or drjit for its arrays.
        """
        alone = self.alone
        found = {n: self._value(n, x, math) for n, x in zip(alone, numbers, strict=False)}
        if self.pair:
            middle, p, q = numbers[len(alone) :]
            p = p + AROUND
            half = math.sqrt(p * p + q * q)
            for name, number in zip(self.pair, (middle + half, middle - half), strict=True):
                low, high = self.model.parameters[name].bounds
                value = self._value(name, number, math)
                found[name] = math.minimum(math.maximum(value, low), high)
            arc = np.arctan2 if math is np else math.atan2
            found[ANGLE] = arc(q, p) / 2
        return found

    def numbers(self, values):
        """The numbers, a list of arrays, of parameters by name."""
        found = [self._number(name, values[name]) for name in self.alone]
        if self.pair:
            u, v = (self._number(name, values[name]) for name in self.pair)
            half, angle = (u - v) / 2, 2 * values.get(ANGLE, 0 * u)
            found += [(u + v) / 2, half * np.cos(angle), half * np.sin(angle)]
        return found

    def errors(self, numbers, errors):
        """Standard errors of `values`, by name, of those of the `numbers`, an array each."""
        values, count = self.values(numbers), len(self.alone)
        found = {
            name: self._slope(name, values[name]) * error
            for name, error in zip(self.alone, errors, strict=False)
        }
        if self.pair:
            (_, p, q), (middle, of_p, of_q) = numbers[count:], errors[count:]
            half = np.maximum(np.hypot(p, q), AROUND)
            along = np.hypot(p * of_p, q * of_q) / half
            across = np.hypot(q * of_p, p * of_q) / half
            for name in self.pair:
                found[name] = self._slope(name, values[name]) * np.hypot(middle, along)
            found[ANGLE] = np.minimum(across / (2 * half), UNKNOWN)
        return found

    def _number(self, name, value):
        with np.errstate(divide="ignore"):
            return np.log(value) if self.model.parameters[name].log else value

    def _value(self, name, number, math):
        return math.exp(number) if self.model.parameters[name].log else number

    def _slope(self, name, value):
        """The derivative of a parameter by its number."""
        return value if self.model.parameters[name].log else 1.0
