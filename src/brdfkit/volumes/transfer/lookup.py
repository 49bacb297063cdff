"""`TransferLookup`: a transfer function as a differentiable texture for renderers."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, JitColour, JitFloat, JitMask, JitVector
from brdfkit.volumes.transfer.preintegration import Preintegration
from brdfkit.volumes.transfer.transfer_function import TransferFunction

MIN_STEPS = 2**12  # smallest number of steps of a table; a jump of the function is one step wide
MAX_STEPS = 2**15  # a table has at most twice this number of steps


@dataclass(init=False, eq=False)  # `dr.freeze` finds the arrays of a dataclass
class TransferLookup:
    """A transfer function as a texture of Mitsuba's current variant, for look-ups in kernels.

    - `function`: the `TransferFunction` that is looked up
    - `table`: a `mi.TensorXf` of RGBA (n, 4) at even steps of values, or (m, n, 4) at even steps of
      gradient magnitudes as well; optimisers may change it, to numbers ≥ 0, with A ≤ 1
    - `extinction`: a `mi.Float`, the extinction where A is 1 [1/unit of length]
    - `axes`: (low, scale, first) for values, and for gradient magnitudes if the function depends on
      them; the coordinate of x in the texture is (x - low) · scale + first
    - `texture`: the table as a `mi.Texture1f` or `mi.Texture2f`
    - `integrals`: the `Preintegration` of the table; None for a function of gradient magnitudes
    """

    function: TransferFunction
    table: Any
    extinction: Any
    axes: list[Any]
    texture: Any
    integrals: Any

    def __init__(self, function: TransferFunction) -> None:
        import mitsuba as mi

        self.function, n = function, 1 + choose_table_steps(function.values)
        self.table = mi.TensorXf(function.table(n))
        self.extinction = mi.Float(function.extinction)
        ranges: list[Any] = [function.range, function.gradient_range]
        sizes = self.table.shape[-2::-1]  # numbers of values, and of gradients if any
        # The ends of the range are the centres of the first and last texel
        self.axes = [
            (mi.Float(low), mi.Float((size - 1) / size / (high - low)), 0.5 / size)
            for (low, high), size in zip(ranges[: len(sizes)], sizes, strict=True)
        ]
        dr.make_opaque(self.table, self.extinction, self.axes)
        self.recompute_texture()

    def recompute_texture(self) -> None:
        """Compute the texture and the integrals again, after `table` was changed."""
        import mitsuba as mi

        kind: Any = mi.Texture1f if len(self.axes) == 1 else mi.Texture2f
        self.texture = kind(self.table, use_accel=False, wrap_mode=dr.WrapMode.Clamp)
        self.integrals = Preintegration(self.table) if len(self.axes) == 1 else None

    def __call__(
        self, places: Sequence[JitFloat], active: JitMask = True
    ) -> tuple[JitColour, JitFloat]:
        """Look up linear RGB, and A, at `places`: [value] or [value, gradient magnitude]."""
        import mitsuba as mi

        at = [
            (x - low) * scale + first
            for x, (low, scale, first) in zip(places, self.axes, strict=True)
        ]
        point: Any = mi.Point1f if len(at) == 1 else mi.Point2f
        r, g, b, a = self.texture.eval(point(*at), active)
        return mi.Color3f(r, g, b), a

    def integrate_to_value(self, value: JitFloat) -> tuple[JitFloat, JitVector, JitVector]:
        """Return the integrals of the function up to a value, for `mean_between` two values."""
        low, scale, _ = self.axes[0]
        return self.integrals.integrate_up_to((value - low) * scale * (self.integrals.steps + 1))

    def mean_between(self, front: Any, back: Any) -> tuple[JitColour, JitFloat]:
        """Return the means of A · RGB and of A between two values on a ray.

        `front` and `back` are the results of `integrate_to_value` for both values.
        """
        import mitsuba as mi

        r, g, b, a = self.integrals.mean_between(front, back)
        return mi.Color3f(r, g, b), a

    def reduce_table_to_values(self) -> AnyArray:
        """Return RGBA (n, 4) over values; of a function of gradients, the largest over these."""
        table = np.array(self.table)
        return table if table.ndim == 2 else table.max(axis=0)

    def find_table_rows(self, values: AnyArray) -> AnyArray:
        """Return the fractional rows of the table at which `values` lie, from 0 to n - 1."""
        low, high = self.function.range
        return np.clip((values - low) / (high - low), 0, 1) * (self.table.shape[-2] - 1)


def choose_table_steps(values: FloatArray) -> int:
    """Choose the number of even steps of a table, so that control points lie on or near its rows.

    `values` (k,), rising, are the control points of a transfer function, such as labels. The number
    is MIN_STEPS or more. Close values need more steps; where they would need too many, some share a
    row, and a warning says so.

    >>> choose_table_steps(np.array([0.0, 7.0, 29.0]))
    4118
    """
    places = (values - values[0]) / (values[-1] - values[0])
    gaps = np.diff(places)
    gap = gaps[gaps > 0].min()
    if gap < 0.5 / MAX_STEPS:
        warnings.warn(
            f"values of the transfer function are only {gap:.1g} of its range apart, too close for "
            f"its table, which resolves {0.5 / MAX_STEPS:.1g}: renumber labels, or cut the range.",
            stacklevel=2,
        )
    least = int(np.clip(np.ceil(1 / gap), MIN_STEPS, MAX_STEPS))
    if np.ptp(gaps) == 0:  # if values are evenly spaced, all gaps get the same number of steps
        return (len(values) - 1) * -(-least // (len(values) - 1))
    counts = np.arange(least, 2 * least)
    worst = np.zeros(len(counts))
    for place in places:
        beside = place * counts
        worst = np.maximum(worst, np.abs(beside - np.rint(beside)))
    return int(counts[worst.round(6).argmin()])
