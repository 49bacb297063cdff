"""`TransferFunction`: maps a volume's values to colour and extinction.

At a point with the value v and the gradient magnitude g, the function has RGB and A. They mean

    σ_t = extinction · A        extinction [1/unit of length]; A is 0 to 1
    albedo = RGB                where colour = "albedo": light is scattered, σ_s = σ_t · RGB
    emission = σ_t · RGB        where colour = "emission": radiance that is added per unit of length

With "emission", RGB is the radiance of a layer so thick that it is opaque, like the colour in
volume rendering by compositing. RGB is linear sRGB. A is not an opacity: a layer of thickness d
that transmits the share 1 - a of the light has σ_t = -ln(1 - a) / d (`opacity.py`).

[Lesar 2018, chapter 6] leaves the meaning of RGBA open; functions of value and gradient magnitude
are from [Kniss et al. 2002].
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from os import PathLike
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.arguments import to_number_pair, to_positive_number, to_whole_number
from brdfkit.core.array_types import AnyArray, ArrayLike, FloatArray
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.volumes.transfer.colour_maps import find_bracketing_points, require_rising
from brdfkit.volumes.transfer.conversions import Conversions

COLOURS = "albedo", "emission"  # the meanings of RGB
# `value_unit` of a function whose values are shares of a volume's window, or of its full range
WINDOW_SHARES, RANGE_SHARES = "share of the window", "share of the range"
METRES = {  # the length of each unit [m], by the names that files use
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    **dict.fromkeys(("µm", "μm", "um", "micron", "microns"), 1e-6),
    "nm": 1e-9,
}


@dataclass(frozen=True, eq=False, repr=False)
class TransferFunction(Conversions):
    """A function from a volume's values, or values and gradient magnitudes, to RGBA.

    It is linear between its control points, and constant beyond the first and the last one. Two
    points at one value are a jump. Raises `BrdfkitError` if points are out of order or numbers out
    of range.

    Attributes
    ----------
    values : ndarray
        The values (n,) of the control points, rising, in the data's own unit.
    rgba : ndarray
        RGBA at each value (n, 4), or at each gradient magnitude and value (m, n, 4). RGB, in linear
        sRGB, is 0 to 1 as an albedo, and 0 or more as an emission; A is 0 to 1.
    extinction : float
        The extinction where A is 1 [1/unit of length], in the unit of the volume.
    colour : str
        The meaning of RGB, "albedo" or "emission".
    gradients : ndarray
        The gradient magnitudes (m,), rising [value per unit of length]; None for a function of
        values alone.
    value_unit : str
        The unit of the values, such as "HU", for display.
    length_unit : str
        The unit of length, such as "mm"; `per` converts the function for a volume in another known
        unit. If empty, it is the unit of any volume.
    name : str
        The function's name.

    Examples
    --------
    >>> glass = TransferFunction([0, 255], [[0.9, 0.9, 1, 0], [0.9, 0.9, 1, 1]], extinction=0.2)
    >>> glass(127.5)
    array([0.9, 0.9, 1. , 0.5])
    """

    values: Any
    rgba: Any
    extinction: float = 1.0
    colour: str = "albedo"
    gradients: Any = None
    value_unit: str = ""
    length_unit: str = ""
    name: str = "transfer function"

    def __post_init__(self) -> None:
        if self.colour not in COLOURS:
            raise no_such_error("meaning of RGB", self.colour, COLOURS, self.name)
        values = require_rising(self.values, f"{self.name}: values")
        shape: tuple[int, ...] = (len(values), 4)
        gradients = self.gradients
        if gradients is not None:
            gradients = require_rising(gradients, f"{self.name}: gradients")
            shape = (len(gradients), *shape)
        extinction = to_positive_number(f"{self.name}: extinction", self.extinction)
        checked = {
            "values": values,
            "gradients": gradients,
            "rgba": _check_rgba(self.rgba, shape, self.colour, self.name),
            "extinction": extinction,
        }
        for name, value in checked.items():
            object.__setattr__(self, name, value)

    @property
    def range(self) -> tuple[float, float]:
        """The first and the last value, between which the function changes."""
        return float(self.values[0]), float(self.values[-1])

    @property
    def gradient_range(self) -> tuple[float, float] | None:
        """The first and the last gradient magnitude; None if the function has only values."""
        if self.gradients is None:
            return None
        return float(self.gradients[0]), float(self.gradients[-1])

    def __call__(self, values: ArrayLike, gradients: ArrayLike | None = None) -> FloatArray:
        """Evaluate RGBA (..., 4) at `values`, and at gradient magnitudes if the function has them.

        Raises `BrdfkitError` if the gradients are missing.
        """
        values = np.asarray(values, float)
        low, high, t = find_bracketing_points(values, self.values)
        if self.gradients is None:
            return (1 - t) * self.rgba[low] + t * self.rgba[high]
        if gradients is None:
            raise BrdfkitError(f"{self.name}: depends on gradient magnitudes; give them, too.")
        below, above, s = find_bracketing_points(np.asarray(gradients, float), self.gradients)
        lower = (1 - t) * self.rgba[below, low] + t * self.rgba[below, high]
        upper = (1 - t) * self.rgba[above, low] + t * self.rgba[above, high]
        return (1 - s) * lower + s * upper

    def table(self, n: int = 1024, m: int = 64) -> NDArray[np.float32]:
        """Tabulate RGBA at `n` even steps of values, and at `m` of gradient magnitudes if any.

        The shape is (n, 4) or (m, n, 4). The table includes both ends of the ranges, which are thus
        the centres of a texture's first and last texel. Details narrower than a step are lost.
        """
        values = np.linspace(*self.range, to_whole_number("n", n, 2))
        if self.gradient_range is None:
            return self(values).astype(np.float32)
        gradients = np.linspace(*self.gradient_range, to_whole_number("m", m, 2))
        return self(values, gradients[:, None]).astype(np.float32)

    def over_gradients(self, ramp: ArrayLike) -> TransferFunction:
        """Return the function with A multiplied by a piecewise linear function of gradients.

        `ramp` (m, 2) are its points (gradient magnitude, factor). ``[(0, 0), (50, 1)]`` hides
        uniform regions, and shows regions in which the value changes.
        """
        try:
            points = np.asarray(ramp, float)
        except (TypeError, ValueError, OverflowError):
            points = np.empty(0)
        if points.ndim != 2 or points.shape[1] != 2 or self.gradients is not None:
            raise BrdfkitError(
                f"{self.name}: a ramp needs points (gradient magnitude, factor), (m, 2), and a "
                "function of values alone."
            )
        rgba = np.repeat(self.rgba[None], len(points), axis=0)
        rgba[..., 3] *= points[:, 1:]
        return replace(self, rgba=rgba, gradients=points[:, 0])

    def per(self, unit: str) -> TransferFunction:
        """Convert the function's extinction and gradients to another unit of length.

        Raises `BrdfkitError` if either unit is unknown.
        """
        if unit == self.length_unit:
            return self
        if unit not in METRES or self.length_unit not in METRES:
            raise BrdfkitError(
                f"{self.name}: its extinction is per {self.length_unit or 'unit of length'}, which "
                f"cannot be converted to 1/{unit}: units are {', '.join(METRES)}; set length_unit "
                "to the volume's unit, and the extinction."
            )
        factor = round(METRES[unit] / METRES[self.length_unit], 12)
        gradients = None if self.gradients is None else self.gradients * factor
        extinction = self.extinction * factor
        return replace(self, extinction=extinction, gradients=gradients, length_unit=unit)

    def scaled_to(self, low: float, high: float) -> TransferFunction:
        """Return the function with its values scaled to the range `low` to `high`.

        Gradients are scaled likewise. MRI has no unit, so that presets for it need this:
        ``TransferFunction.load("mri_head").scaled_to(*volume.window)``.
        """
        low, high = to_number_pair("range", (low, high))
        first, last = self.range
        if not low < high:
            raise BrdfkitError(f"{self.name}: the range {low:g} to {high:g} does not rise.")
        scale = (high - low) / (last - first)
        gradients = None if self.gradients is None else self.gradients * scale
        values = low + (self.values - first) * scale
        return replace(self, values=values, gradients=gradients, value_unit="")

    def __repr__(self) -> str:
        low, high = self.range
        unit = f" {self.value_unit}" if self.value_unit else ""
        per = self.length_unit or "unit of length"
        gradients = ""
        if self.gradient_range is not None:
            gradients = " × gradients {:.4g} to {:.4g}".format(*self.gradient_range)
        return (
            f"{self.name}: {low:.6g} to {high:.6g}{unit}{gradients}, RGB is {self.colour}, "
            f"extinction {self.extinction:.4g} per {per}"
        )


TransferLike: TypeAlias = TransferFunction | str | PathLike[str]


def _check_rgba(given: ArrayLike, shape: tuple[int, ...], colour: str, name: str) -> AnyArray:
    """Return RGBA as floats; raise `BrdfkitError` unless it has this `shape` and valid numbers.

    The valid range depends on `colour`, the meaning of RGB; errors name the function, `name`.
    """
    try:
        rgba = np.array(given, float)
    except (TypeError, ValueError):
        rgba = np.empty(0)
    if rgba.shape != shape:
        raise BrdfkitError(
            f"{name}: rgba has the shape {rgba.shape}; it should be {shape}, R, G, B and A for "
            "each point."
        )
    largest = [1, 1, 1, 1] if colour == "albedo" else [np.inf, np.inf, np.inf, 1]
    if not (np.isfinite(rgba).all() and (rgba >= 0).all() and (rgba <= largest).all()):
        reach = "0 to 1" if colour == "albedo" else "at least 0, and A at most 1"
        raise BrdfkitError(
            f"{name}: rgba has a number out of range; as {colour} the numbers should be {reach}."
        )
    return rgba
