"""The declarations of a model: linear parameters (weights), nonlinear ones (shapes), options."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import ArrayLike
from brdfkit.core.errors import BrdfkitError

NOT_NEGATIVE, SIGNED = (0.0, math.inf), (-math.inf, math.inf)
LARGEST_WEIGHT = 1e100  # the square of a larger weight may be infinite


@dataclass(frozen=True)
class Parameter:
    """A parameter of a model, with its default, its bounds (low, high) and its meaning.

    `linear`: whether the parameter is a weight, by which a lobe is multiplied.
    `log`: whether a fit searches it on a logarithmic scale.
    `follows`: name of the parameter whose value it takes if it is not given.
    `width`: exponent p with which the lobe's width is proportional to parameterᵖ, 0 if unrelated.
    `turns`: whether the material looks the same as it turns about its normal only at the default.
    """

    default: float | None
    bounds: tuple[float, float]
    meaning: str
    linear: bool = False
    log: bool = False
    follows: str | None = None
    width: float = 0.0
    turns: bool = False

    def __post_init__(self) -> None:
        low, high = self.bounds
        if self.linear and (low, high) != SIGNED and not (low == 0 < high):
            raise BrdfkitError(
                f"{self.meaning!r}: a weight is at least 0 or of any sign; leave out its bounds, "
                "or give (0, LARGEST) or (-math.inf, math.inf)."
            )
        if not self.linear and not -math.inf < low < high < math.inf:
            raise BrdfkitError(
                f"{self.meaning!r}: a fit searches between the bounds {low:g} and {high:g}; give "
                "two finite ones, the lower first."
            )
        if self.log and low <= 0:
            raise BrdfkitError(f"{self.meaning!r}: log=True needs bounds above 0.")
        if self.default is not None and (problem := self.find_problem(self.default)):
            raise BrdfkitError(f"{self.meaning!r}: the default {problem}.")

    def find_problem(self, value: ArrayLike) -> str | None:
        """Describe what is wrong with one number or several; return None if all are allowed."""
        low, high = self.bounds
        numbers = np.asarray(value)
        limits = f"at least {low:g}" if math.isinf(high) else f"between {low:g} and {high:g}"
        if np.all(np.isfinite(numbers) & (numbers >= low) & (numbers <= high)):
            if np.abs(numbers).max(initial=0) <= LARGEST_WEIGHT:
                return None
            limits = f"at most {LARGEST_WEIGHT:g}"
        return f"{value} is out of bounds: it should be {limits}"


def weight(default: float, meaning: str, bounds: tuple[float, float] = NOT_NEGATIVE) -> Any:
    """Declare a linear parameter: the strength of one lobe in each colour channel.

    `bounds` are ``(0, math.inf)``, ``(0, 1)`` for a colour that a format limits to 1, or
    ``(-math.inf, math.inf)`` for a weight that may be negative.
    """
    return Parameter(default, bounds, meaning, linear=True)


def shape(
    default: float, bounds: tuple[float, float], meaning: str, log: bool = False, width: float = 0.0
) -> Any:
    """Declare a nonlinear parameter within finite `bounds` (low, high).

    `log` is True for a parameter whose order of magnitude matters, such as a width. `width` is the
    exponent p with which the lobe's width is proportional to parameterᵖ: 1 for a width, -0.5 for an
    exponent n, whose lobe is about 1/√n wide, 0 for all other parameters. Fits of a sum of equal
    models use it to start from unequal widths.
    """
    return Parameter(default, bounds, meaning, log=log, width=width)


def anisotropy(bounds: tuple[float, float], meaning: str) -> Any:
    """Declare the shape parameter that makes a model anisotropic where it is not 0.

    Fits of isotropic materials leave it at 0, its default.
    """
    return Parameter(0.0, bounds, meaning, turns=True)


def follows(other: str, parameter: Parameter, meaning: str) -> Any:
    """Declare a shape parameter that equals the parameter named `other` unless it is given.

    `parameter` is that other parameter, whose bounds and scale it takes. Anisotropic models declare
    their second width (alpha_v) in this way.
    """
    bounds, log = parameter.bounds, parameter.log
    return Parameter(None, bounds, meaning, log=log, follows=other, turns=True)


@dataclass(frozen=True)
class Option:
    """A choice that is not a number to fit: a form of the model, an order, a number of lobes."""

    default: Any
    choices: tuple[Any, ...] | None
    meaning: str

    def read(self, given: Any, what: str) -> Any:
        """Convert a word or a number to a value of the option.

        Raises `BrdfkitError` for a value that is not allowed; `what` is the option's name in its
        message.
        """
        kind = type(self.default)
        value = kind(given) if _is_convertible(kind, given) else given
        if type(value) is not kind or (self.choices and value not in self.choices):
            one_of = " or ".join(map(str, self.choices)) if self.choices else "of another kind"
            raise BrdfkitError(f"{what} = {given} should be {one_of}.")
        return value


def option(default: Any, choices: tuple[Any, ...] | None, meaning: str) -> Any:
    """Declare an option with its `choices`; None allows all values of the default's type."""
    return Option(default, choices, meaning)


def _is_convertible(kind: Any, given: Any) -> bool:
    """Return whether `given` is a value of the type `kind`, or a text that converts to one."""
    try:
        return kind(given) == given or str(kind(given)) == given
    except (TypeError, ValueError):
        return False
