"""Samples in blocks, in Dr.Jit's arrays: a kernel's results on one block stay small in memory."""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.jit import double_precision
from brdfkit.core.jit.padding import pad

# Channels that one kernel evaluates: of more, one group after the other goes through the same one
GROUP = 8
# Samples of a block, times the points at which it is evaluated, times the groups of channels
SIZE = 2**17


@dataclass(frozen=True, eq=False)
class Block:
    """Samples, repeated for each of `count` points, one point after the other.

    `loss`: theirs; `rows`: which samples; `wi`, `wo`: directions; `measured`: an array per channel;
    `importance`; `point`: the number of the point, all of Dr.Jit's and `count` times as long as
    `rows`.
    """

    loss: Any
    rows: slice
    count: int
    wi: double_precision.Vector
    wo: double_precision.Vector
    measured: list[Any]
    importance: Any
    point: Any

    @classmethod
    def of(cls, samples, importance, loss, rows, count):
        """The block of the `rows` of `Samples`, whose `importance` is (n,), under a `Loss`."""

        def array(values):
            part = values[rows]
            return double_precision.to_array(part if count == 1 else np.tile(part, count))

        wi, wo = (
            double_precision.Vector(*map(array, np.asarray(w).T)) for w in (samples.wi, samples.wo)
        )
        size = rows.stop - rows.start
        point = np.repeat(np.arange(count, dtype=np.uint32), size)
        index = dr.uint32_array_t(double_precision.float_type())
        measured = [array(channel) for channel in samples.values.T]
        return cls(loss, rows, count, wi, wo, measured, array(importance), index(pad(point)))

    def spread(self, table):
        """A list of arrays, one value per sample: the columns of `table` (count, columns)."""
        float64, columns = double_precision.float_type(), table.shape[1]
        if not double_precision.has_derivatives():  # such arrays cannot be gathered from
            size = self.rows.stop - self.rows.start
            return [float64(np.repeat(column, size)) for column in table.T]
        flat, first = double_precision.to_array(table.ravel()), self.point * columns
        return [dr.gather(float64, flat, first + k) for k in range(columns)]

    def columns(self, columns, table):
        """Arrays of all `Columns` at the parameters in `table` (count, shapes)."""
        return columns.eval(self.spread(table) if table.size else [], self.wi, self.wo)

    def first(self):
        """(wi, wo) of the samples, once."""
        return [
            double_precision.Vector(
                *(double_precision.to_array(self.fold(x)[0]) for x in (w.x, w.y, w.z))
            )
            for w in (self.wi, self.wo)
        ]

    def fold(self, array):
        """An array of Dr.Jit's as NumPy's (count, samples)."""
        return np.asarray(array).reshape(self.count, -1)


class Blocks:
    """The blocks of `Samples`. A single one is kept, several are made anew for each use."""

    def __init__(self, samples, importance, loss):
        self.samples, self.importance, self.loss, self._kept = samples, importance, loss, {}

    def __call__(self, count):
        """The blocks for `count` points."""
        groups = -(-self.samples.values.shape[1] // GROUP)
        given = self.samples, self.importance, self.loss
        n, step = len(self.importance), max(SIZE // (count * groups), 1)
        if n > step:
            for start in range(0, n, step):
                rows = slice(start, min(start + step, n))
                yield Block.of(*given, rows, count)
            return
        if count not in self._kept:
            self._kept[count] = Block.of(*given, slice(0, n), count)
        yield self._kept[count]
