"""Arrays of constants that plugins read by index, and searches for nodes around a coordinate."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import ArrayLike, JitFloat, JitInt, JitMask
from brdfkit.core.jit.padding import pad

BELOW_ONE = 1 - 2**-24  # the largest number below 1 in single precision


class Rows:
    """Rows of numbers (n, columns), or plain numbers (n,), in the current variant's memory.

    >>> Rows([[0.1, 0.2, 0.3]]).at(0, mi.Color3f)    # doctest: +SKIP
    [[0.1, 0.2, 0.3]]
    """

    def __init__(self, values: ArrayLike) -> None:
        import mitsuba as mi

        values = np.ascontiguousarray(values, np.float32)
        self.scalar = str(mi.variant()).startswith("scalar")
        self.values = values if self.scalar else mi.Float(mi.TensorXf(values).array)

    def at(self, index: JitInt, kind: Any = None, active: JitMask = True) -> Any:
        """Return row `index` as the type `kind`, by default `mi.Float`; 0 where not `active`."""
        import drjit as dr
        import mitsuba as mi

        kind = kind or mi.Float
        if not self.scalar:
            return dr.gather(kind, self.values, index, active)
        row = self.values[index] if active else np.zeros_like(self.values[0])
        return kind(*np.atleast_1d(row).tolist())


class Integers:
    """Whole numbers (n,), 0 to 2³² - 1, in the current variant's memory."""

    def __init__(self, values: ArrayLike) -> None:
        import mitsuba as mi

        self.scalar = str(mi.variant()).startswith("scalar")
        integers = np.ascontiguousarray(values, np.uint32)
        self.values: Any = integers if self.scalar else mi.UInt32(pad(integers))

    def at(self, index: JitInt, active: JitMask = True) -> JitInt:
        """Return the number at an index as a `mi.UInt32`; 0 where not `active`."""
        import drjit as dr
        import mitsuba as mi

        if not self.scalar:
            return dr.gather(mi.UInt32, self.values, index, active)
        return int(self.values[index]) if active else 0


def find_cell(x: JitFloat, n: JitFloat) -> JitInt:
    """Return the index of the cell around `x` among `n` cells of length 1, clamped at the ends."""
    import drjit as dr
    import mitsuba as mi

    return mi.UInt32(dr.clip(x, 0, n - 1))


def find_bracket(x: JitFloat, n: int) -> tuple[JitInt, JitInt, JitFloat]:
    """Return the nodes below and above `x` among 0 ... n - 1, and the upper one's weight."""
    import drjit as dr
    import mitsuba as mi

    x = dr.clip(x, 0, n - 1)
    lower = dr.minimum(mi.UInt32(x), max(n - 2, 0))
    return lower, dr.minimum(lower + 1, n - 1), x - mi.Float(lower)


def find_periodic_bracket(x: JitFloat, n: int) -> tuple[JitInt, JitInt, JitFloat]:
    """Return the nodes below and above `x` on a circle of `n` nodes, and the upper one's weight."""
    import drjit as dr
    import mitsuba as mi

    x = x - n * dr.floor(x / n)
    lower = dr.minimum(mi.UInt32(x), n - 1)
    return lower, dr.select(lower + 1 == n, 0, lower + 1), x - mi.Float(lower)


class Nodes:
    """The nodes of an axis for interpolation: increasing numbers, evenly spaced or not."""

    def __init__(self, values: Any) -> None:
        self.count, self.rows = len(values), Rows(values)

    def find_bracket(self, x: JitFloat) -> tuple[JitInt, JitInt, JitFloat]:
        """Return the lower and upper node around `x`, and the upper one's interpolation weight."""
        import drjit as dr
        import mitsuba as mi

        above = dr.binary_search(1, self.count - 1, lambda node: self.rows.at(node) <= x)
        lower = mi.UInt32(above - 1)
        upper = dr.minimum(lower + 1, self.count - 1)
        start, end = self.rows.at(lower), self.rows.at(upper)
        width = dr.select(end > start, end - start, 1)
        return lower, upper, dr.clip((x - start) / width, 0, 1)
