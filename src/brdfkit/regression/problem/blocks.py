"""Splits samples into blocks of Dr.Jit arrays, so that results of a kernel stay small in memory."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import Vector
from brdfkit.core.jit.padding import pad
from brdfkit.model.samples import Samples
from brdfkit.regression.losses.loss import Loss
from brdfkit.regression.problem.columns import Columns

# Channels that one kernel evaluates; if there are more, it runs for one group after the other
GROUP = 8
# The number of samples in a block, times the points of its evaluation, times groups of channels
BLOCK_SIZE = 2**17


@dataclass(frozen=True, eq=False)
class Block:
    """Samples as Dr.Jit arrays, repeated for each of `count` points of the search.

    `loss`: their `Loss`; `rows`: which samples; `wi`, `wo`: directions; `measured`: an array for
    each channel; `importance`: the weights of the samples; `point`: the index of the point. All
    arrays are `count` times as long as `rows`, one point after the other.
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
    def from_samples(
        cls, samples: Samples, importance: FloatArray, loss: Loss, rows: slice, count: int
    ) -> Block:
        """Return the block with the `rows` of `Samples`; `importance` (n,): weights of samples."""

        def array(values: FloatArray) -> JitFloat:
            part = values[rows]
            return double_precision.to_array(part if count == 1 else np.tile(part, count))

        wi, wo = (
            double_precision.Vector(*map(array, np.asarray(w).T)) for w in (samples.wi, samples.wo)
        )
        size = rows.stop - rows.start
        point = np.repeat(np.arange(count, dtype=np.uint32), size)
        index = dr.uint32_array_t(double_precision.choose_float_type())
        measured = [array(channel) for channel in samples.values.T]
        return cls(loss, rows, count, wi, wo, measured, array(importance), index(pad(point)))

    def repeat_for_samples(self, table: FloatArray) -> list[JitFloat]:
        """Return the columns of `table` (count, columns) as arrays with one value per sample."""
        float64, columns = double_precision.choose_float_type(), table.shape[1]
        if not double_precision.has_derivatives():  # these arrays do not support dr.gather
            size = self.rows.stop - self.rows.start
            return [float64(np.repeat(column, size)) for column in table.T]
        flat, first = double_precision.to_array(table.ravel()), self.point * columns
        return [dr.gather(float64, flat, first + k) for k in range(columns)]

    def evaluate_columns(self, columns: Columns, table: FloatArray) -> list[JitFloat]:
        """Evaluate all `Columns` at the parameters in `table` (count, shapes); return arrays."""
        return columns.evaluate(
            self.repeat_for_samples(table) if table.size else [], self.wi, self.wo
        )

    def directions(self) -> tuple[Vector, Vector]:
        """Return (wi, wo) of the samples, without the repetition."""
        wi, wo = (
            Vector(*(double_precision.to_array(self.split_by_point(x)[0]) for x in (w.x, w.y, w.z)))
            for w in (self.wi, self.wo)
        )
        return wi, wo

    def split_by_point(self, array: JitFloat) -> FloatArray:
        """Return a Dr.Jit array as a NumPy array (count, samples)."""
        return np.asarray(array).reshape(self.count, -1)


class Blocks:
    """The blocks of `Samples`. A single block is cached, several are made anew for each use."""

    def __init__(self, samples: Samples, importance: FloatArray, loss: Loss) -> None:
        self.samples, self.importance, self.loss = samples, importance, loss
        self._cache: dict[int, Block] = {}

    def __call__(self, count: int) -> Iterator[Block]:
        """Yield the blocks for `count` points."""
        groups = -(-self.samples.values.shape[1] // GROUP)
        given = self.samples, self.importance, self.loss
        n, step = len(self.importance), max(BLOCK_SIZE // (count * groups), 1)
        if n > step:
            for start in range(0, n, step):
                rows = slice(start, min(start + step, n))
                yield Block.from_samples(*given, rows, count)
            return
        if count not in self._cache:
            self._cache[count] = Block.from_samples(*given, slice(0, n), count)
        yield self._cache[count]
