"""The declarations of a model: parameters, which are linear or not, and options."""

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

    `linear` says whether it is a weight, `log` whether it is searched on a logarithmic scale.
    `follows` names the parameter that it equals unless it is given. `width` is p in: lobe width ∝
    parameter^p.
    """

    default: float | None
    bounds: tuple[float, float]
    meaning: str
    linear: bool = False
    log: bool = False
    follows: str | None = None
    width: float = 0.0

    def __post_init__(self) -> None:
        low, high = self.bounds
        if self.linear and (low, high) not in (NOT_NEGATIVE, SIGNED):
            raise BrdfkitError(
                f"{self.meaning!r}: a weight is solved for, at least 0 or of any sign; leave its "
                "bounds out, or give (-math.inf, math.inf)."
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
        """Describe what is wrong with one number or several; None if all are within bounds."""
        low, high = self.bounds
        given = np.asarray(value)
        if np.all(np.isfinite(given) & (given >= low) & (given <= high)):
            large = np.abs(given).max(initial=0) > LARGEST_WEIGHT
            return (
                f"{value} is out of bounds: it should be at most {LARGEST_WEIGHT:g}"
                if large
                else None
            )
        limits = f"at least {low:g}" if math.isinf(high) else f"between {low:g} and {high:g}"
        return f"{value} is out of bounds: it should be {limits}"


def weight(default: float, meaning: str, bounds: tuple[float, float] = NOT_NEGATIVE) -> Any:
    """Declare a linear parameter: the strength of one lobe in each colour channel.

    `bounds` are ``(0, math.inf)``, or ``(-math.inf, math.inf)`` if the weight may be negative.
    """
    return Parameter(default, bounds, meaning, linear=True)


def shape(
    default: float, bounds: tuple[float, float], meaning: str, log: bool = False, width: float = 0.0
) -> Any:
    """Declare a nonlinear parameter within finite `bounds` (low, high).

    `log` is True for a parameter whose order of magnitude matters, such as a width. `width` is p
    in: lobe width ∝ parameter^p. It is 1 for a width, -0.5 for an exponent n, whose lobe is about
    1/√n wide, and 0 for all others. A sum of models uses it to begin with unequal widths.
    """
    return Parameter(default, bounds, meaning, log=log, width=width)


def follows(other: str, parameter: Parameter, meaning: str) -> Any:
    """Declare a shape parameter that equals the one named `other` unless given, for anisotropy."""
    return Parameter(None, parameter.bounds, meaning, log=parameter.log, follows=other)


@dataclass(frozen=True)
class Option:
    """A choice that is not a number to fit: a form of the model, an order, a count of lobes."""

    default: Any
    choices: tuple[Any, ...] | None
    meaning: str

    def read(self, given: Any, what: str) -> Any:
        """Convert a word or a number to a value of the option.

        Raises `BrdfkitError`, which calls the option `what`, for a value that is not allowed.
        """
        value = type(self.default)(given) if _is_convertible(type(self.default), given) else given
        if type(value) is not type(self.default) or (self.choices and value not in self.choices):
            one_of = " or ".join(map(str, self.choices)) if self.choices else "of another kind"
            raise BrdfkitError(f"{what} = {given} should be {one_of}.")
        return value


def option(default: Any, choices: tuple[Any, ...] | None, meaning: str) -> Any:
    """Declare an option with its `choices`; None allows any value of the default's type."""
    return Option(default, choices, meaning)


def _is_convertible(kind: Any, given: Any) -> bool:
    """Return whether `given` is a value of the type `kind`, or a word for one."""
    try:
        return kind(given) == given or str(kind(given)) == given
    except (TypeError, ValueError):
        return False
