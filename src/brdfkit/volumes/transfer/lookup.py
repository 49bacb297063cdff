"""`TransferLookup`: a transfer function as a texture for renderers, differentiable throughout."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, JitColour, JitFloat, JitMask, JitVector
from brdfkit.volumes.transfer.preintegration import Preintegration
from brdfkit.volumes.transfer.transfer_function import TransferFunction

MIN_STEPS = 2**12  # of a table over values; a jump of the function is one step wide
MAX_STEPS = 2**15  # or up to twice as many


@dataclass(init=False, eq=False)  # `dr.freeze` finds the arrays of a dataclass
class TransferLookup:
    """A `TransferFunction` in the memory of Mitsuba's current variant.

    `function` is its source. `table` is a `mi.TensorXf` of RGBA (n, 4) at even steps of the values,
    or (m, n, 4) at even steps of gradient magnitudes as well. Optimisers may change it; its numbers
    should stay ≥ 0, and A ≤ 1. `extinction` is a `mi.Float`, σ_t where A is 1 [1/unit of length].
    `axes` are (low, scale, first) for values, and for gradient magnitudes. `texture` is the table
    as a `mi.Texture1f` or `mi.Texture2f`. `integrals` are its `Preintegration`, None for a function
    of gradient magnitudes.
    """

    function: TransferFunction
    table: Any
    extinction: Any
    axes: list[Any]
    texture: Any
    integrals: Any

    def __init__(self, function: TransferFunction) -> None:
        import mitsuba as mi

        self.function, n = function, 1 + choose_steps(function.values)
        self.table = mi.TensorXf(function.table(n))
        self.extinction = mi.Float(function.extinction)
        ranges: list[Any] = [function.range, function.gradient_range]
        sizes = self.table.shape[-2::-1]  # n, and m if the function depends on gradients
        # The ends of the range are centres of texels: (place - low) · scale + first
        self.axes = [
            (mi.Float(low), mi.Float((size - 1) / size / (high - low)), 0.5 / size)
            for (low, high), size in zip(ranges[: len(sizes)], sizes, strict=True)
        ]
        dr.make_opaque(self.table, self.extinction, self.axes)
        self.update()

    def update(self) -> None:
        """Update what depends on `table` and `extinction`, after they were assigned."""
        import mitsuba as mi

        kind: Any = mi.Texture1f if len(self.axes) == 1 else mi.Texture2f
        self.texture = kind(self.table, use_accel=False, wrap_mode=dr.WrapMode.Clamp)
        self.integrals = Preintegration(self.table) if len(self.axes) == 1 else None

    def __call__(
        self, places: Sequence[JitFloat], active: JitMask = True
    ) -> tuple[JitColour, JitFloat]:
        """Return RGB in linear sRGB, and A, at `places`, [value] or [value, ‖∇V‖]."""
        import mitsuba as mi

        at = [
            (x - low) * scale + first
            for x, (low, scale, first) in zip(places, self.axes, strict=True)
        ]
        point: Any = mi.Point1f if len(at) == 1 else mi.Point2f
        r, g, b, a = self.texture.eval(point(*at), active)
        return mi.Color3f(r, g, b), a

    def integrals_at(self, value: JitFloat) -> tuple[JitFloat, JitVector, JitVector]:
        """Return the integrals up to a value, an end for `mean_between`."""
        low, scale, _ = self.axes[0]
        return self.integrals.at((value - low) * scale * (self.integrals.steps + 1))

    def mean_between(self, front: Any, back: Any) -> tuple[JitColour, JitFloat]:
        """Return the means of A RGB and of A between two values, as `integrals_at` gives them."""
        import mitsuba as mi

        r, g, b, a = self.integrals.mean(front, back)
        return mi.Color3f(r, g, b), a

    def table_over_values(self) -> AnyArray:
        """Return the table (n, 4), for each value the largest over all gradient magnitudes."""
        table = np.array(self.table)
        return table if table.ndim == 2 else table.max(axis=0)

    def to_rows(self, values: AnyArray) -> AnyArray:
        """Return the places of `values` in the table: 0 is its first row, n - 1 its last one."""
        low, high = self.function.range
        return np.clip((values - low) / (high - low), 0, 1) * (self.table.shape[-2] - 1)


def choose_steps(values: FloatArray) -> int:
    """Return the number of even steps, `MIN_STEPS` or more, that best meet rising `values` (k,).

    Corners of a function, and labels, then lie on rows of its table. Values that are closer to each
    other get more steps, up to a limit beyond which a warning says that they share a row.

    >>> choose_steps(np.array([0.0, 7.0, 29.0]))
    4118
    """
    places = (values - values[0]) / (values[-1] - values[0])
    gaps = np.diff(places)
    gap = gaps[gaps > 0].min()
    if gap < 0.5 / MAX_STEPS:
        warnings.warn(
            f"values of the transfer function are {gap:.1g} of its range apart; what is between "
            f"them is not seen below {0.5 / MAX_STEPS:.1g}: number labels anew, or cut the range.",
            stacklevel=2,
        )
    least = int(np.clip(np.ceil(1 / gap), MIN_STEPS, MAX_STEPS))
    if np.ptp(gaps) == 0:  # even values, such as labels, meet a multiple of their number
        return (len(values) - 1) * -(-least // (len(values) - 1))
    counts = np.arange(least, 2 * least)
    worst = np.zeros(len(counts))
    for place in places:
        beside = place * counts
        worst = np.maximum(worst, np.abs(beside - np.rint(beside)))
    return int(counts[worst.round(6).argmin()])
