"""A transfer function as a texture, looked up by renderers: derivatives by all of its numbers."""

import warnings
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.volumes.transfer.preintegration import Preintegration
from brdfkit.volumes.transfer.transfer_function import TransferFunction

# Of a table over values, at least: a step in a function is one of them wide; and at most, or twice
STEPS, MOST = 2**12, 2**15


@dataclass(init=False, eq=False)  # of a dataclass `dr.freeze` finds the arrays
class TransferLookup:
    """A `TransferFunction` in the memory of Mitsuba's current variant.

    function : what it was made of.
    table : `mi.TensorXf` (n, 4) of RGBA at even steps of the values, or (m, n, 4), m of gradient
        magnitudes. Optimisers may change it; its numbers should stay 0 or more, and A 1 or less.
    extinction : `mi.Float`, σ_t where A is 1 [1/unit of length].
    axes : (low, scale, first) of values, and of gradient magnitudes.
    texture : the table as a `mi.Texture1f` or `mi.Texture2f`.
    integrals : its `Preintegration`; None of a function of gradient magnitudes.
    """

    function: TransferFunction
    table: Any
    extinction: Any
    axes: list[Any]
    texture: Any
    integrals: Any

    def __init__(self, function):
        import mitsuba as mi

        self.function, n = function, 1 + steps(function.values)
        self.table = mi.TensorXf(function.table(n))
        self.extinction = mi.Float(function.extinction)
        ranges = function.range, function.gradient_range
        sizes = self.table.shape[-2::-1]  # n, and m
        # Ends of the range are centres of texels: (place - low) · scale + first
        self.axes = [
            (mi.Float(low), mi.Float((size - 1) / size / (high - low)), 0.5 / size)
            for (low, high), size in zip(ranges[: len(sizes)], sizes, strict=True)
        ]
        dr.make_opaque(self.table, self.extinction, self.axes)
        self.changed()

    def changed(self):
        """To be called after `table` or `extinction` were assigned."""
        import mitsuba as mi

        kind = mi.Texture1f if len(self.axes) == 1 else mi.Texture2f
        self.texture = kind(self.table, use_accel=False, wrap_mode=dr.WrapMode.Clamp)
        self.integrals = Preintegration(self.table) if len(self.axes) == 1 else None

    def __call__(self, places, active=True):
        """RGB, a `mi.Color3f` in linear sRGB, and A; `places`: [value], or [value, ‖∇V‖]."""
        import mitsuba as mi

        at = [
            (x - low) * scale + first
            for x, (low, scale, first) in zip(places, self.axes, strict=True)
        ]
        point = mi.Point1f if len(at) == 1 else mi.Point2f
        r, g, b, a = self.texture.eval(point(*at), active)
        return mi.Color3f(r, g, b), a

    def integrals_at(self, value):
        """What `mean_between` takes, of one value."""
        low, scale, _ = self.axes[0]
        return self.integrals.at((value - low) * scale * (self.integrals.steps + 1))

    def mean_between(self, front, back):
        """The means of A RGB, a `mi.Color3f`, and of A, as the value goes from one to the other."""
        import mitsuba as mi

        r, g, b, a = self.integrals.mean(front, back)
        return mi.Color3f(r, g, b), a

    def table_over_values(self):
        """(n, 4) in NumPy: the table, or of each value the largest over gradient magnitudes."""
        table = np.array(self.table)
        return table if table.ndim == 2 else table.max(axis=0)

    def steps_of(self, values):
        """Places of `values`, NumPy's, in the table: 0 is its first row, n - 1 its last."""
        low, high = self.function.range
        return np.clip((values - low) / (high - low), 0, 1) * (self.table.shape[-2] - 1)


def steps(values):
    """How many even steps, `STEPS` or more, best meet all `values` (k,), rising.

    So that corners of a function, and labels, lie on rows of its table. Values that are nearer to
    each other have more steps, up to a limit, beyond which a warning tells that they share a row.

    >>> steps(np.array([0.0, 7.0, 29.0]))
    4118
    """
    places = (values - values[0]) / (values[-1] - values[0])
    gaps = np.diff(places)
    gap = gaps[gaps > 0].min()
    if gap < 0.5 / MOST:
        warnings.warn(
            f"values of the transfer function are {gap:.1g} of its range apart; what is between "
            f"them is not seen below {0.5 / MOST:.1g}: number labels anew, or cut the range.",
            stacklevel=2,
        )
    least = int(np.clip(np.ceil(1 / gap), STEPS, MOST))
    if np.ptp(gaps) == 0:  # any number of them, as of labels
        return (len(values) - 1) * -(-least // (len(values) - 1))
    counts = np.arange(least, 2 * least)
    worst = np.zeros(len(counts))
    for place in places:
        beside = place * counts
        worst = np.maximum(worst, np.abs(beside - np.rint(beside)))
    return int(counts[worst.round(6).argmin()])
