"""Splits samples into blocks of Dr.Jit arrays, so that a kernel's results need little memory.

A search evaluates a model at several points, sets of its parameters, at once. So the arrays of a
block contain its samples once for each point.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import Vector, differentiate
from brdfkit.core.jit.padding import pad
from brdfkit.model.samples import Samples
from brdfkit.regression.losses.loss import Loss
from brdfkit.regression.problem.columns import Columns

# Largest number of channels that one kernel evaluates; more channels are split into groups
GROUP = 8
# Largest size of a block: its samples times the points of the search times the groups of channels
BLOCK_SIZE = 2**17


@dataclass(frozen=True, eq=False)
class Block:
    """Some samples as Dr.Jit arrays, repeated once for each of several points of a search.

    A point is a set of parameters of the model. All arrays have the length points × samples, the
    samples of the first point first.

    `loss`: loss of the samples; `rows`: range of the samples' indices; `count`: number of points;
    `wi`, `wo`: incident and outgoing directions; `measured`: values of each channel; `importance`:
    weights of the samples in the loss; `point`: index of the point that an entry belongs to.
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
        """Return the block with the range `rows` of `samples`, for `count` points.

        `importance` (n,): weights of all samples in the loss.
        """

        def repeat_rows(values: FloatArray) -> JitFloat:
            """Return the block's part of an array (n,), repeated for each point."""
            part = values[rows]
            return double_precision.to_array(part if count == 1 else np.tile(part, count))

        wi, wo = (
            double_precision.Vector(*map(repeat_rows, np.asarray(w).T))
            for w in (samples.wi, samples.wo)
        )
        size = rows.stop - rows.start
        point = np.repeat(np.arange(count, dtype=np.uint32), size)
        index = dr.uint32_array_t(double_precision.choose_float_type())
        measured = [repeat_rows(channel) for channel in samples.values.T]
        return cls(loss, rows, count, wi, wo, measured, repeat_rows(importance), index(pad(point)))

    def repeat_for_samples(self, table: FloatArray) -> list[JitFloat]:
        """Return numbers of each point as Dr.Jit arrays, repeated for all samples of the block.

        `table`: a row of numbers for each point (points, columns); the list has one array for each
        column.
        """
        float64, columns = double_precision.choose_float_type(), table.shape[1]
        if not double_precision.has_derivatives():  # then arrays do not support dr.gather
            size = self.rows.stop - self.rows.start
            return [float64(np.repeat(column, size)) for column in table.T]
        return self.gather_by_point(double_precision.to_array(table.ravel()), columns)

    def gather_by_point(self, flat: JitFloat, columns: int) -> list[JitFloat]:
        """Return `repeat_for_samples` of a table (points, `columns`) that is a `flat` array."""
        float64, first = double_precision.choose_float_type(), self.point * columns
        return [dr.gather(float64, flat, first + k) for k in range(columns)]

    def evaluate_columns(self, columns: Columns, table: FloatArray) -> list[JitFloat]:
        """Evaluate the model's `columns` at the samples, one Dr.Jit array for each column.

        `table`: values of the shape parameters at each point (points, shapes).
        """
        return columns.evaluate(
            self.repeat_for_samples(table) if table.size else [], self.wi, self.wo
        )

    def evaluate_difference(
        self, value: Any, channel: int, clamped: bool, extended: bool
    ) -> tuple[JitFloat, JitFloat]:
        """Return the loss's difference in a channel, and its derivative with respect to `value`.

        `clamped`: whether a negative value counts as 0; `extended`: whether the difference instead
        continues below 0 as a straight line, with the slope that it has at 0.
        """

        def difference(value: JitFloat) -> JitFloat:
            """Return the difference of the loss between a model's value and the measured one."""
            return self.loss.difference(value, self.measured[channel], self.wi.z, self.wo.z)

        def clamp_difference(value: JitFloat) -> JitFloat:
            """Return the difference of a value that is clamped at 0 where it is negative."""
            return difference(dr.select(value < 0, 0, value))

        value = double_precision.choose_float_type()(value) + 0 * self.wi.z
        if not clamped:
            return differentiate(difference, value)
        if not extended:
            return differentiate(clamp_difference, value)
        _, slope = differentiate(difference, 0 * value)
        return differentiate(lambda v: clamp_difference(v) + slope * dr.minimum(v, 0), value)

    def get_sample_directions(self) -> tuple[Vector, Vector]:
        """Return the incident and outgoing directions of the samples, without repetition."""
        wi, wo = (
            Vector(*(double_precision.to_array(self.split_by_point(x)[0]) for x in (w.x, w.y, w.z)))
            for w in (self.wi, self.wo)
        )
        return wi, wo

    def split_by_point(self, array: JitFloat) -> FloatArray:
        """Return a Dr.Jit array of the block as a NumPy array (points, samples)."""
        return np.asarray(array).reshape(self.count, -1)


class Blocks:
    """An iterable factory of the blocks of some samples, for any number of points.

    If all samples fit into one block, it is cached; otherwise blocks are made again for each use,
    to save memory.
    """

    def __init__(self, samples: Samples, importance: FloatArray, loss: Loss) -> None:
        self.samples, self.importance, self.loss = samples, importance, loss
        self._cache: dict[int, Block] = {}

    def __call__(self, count: int) -> Iterator[Block]:
        """Yield the blocks of the samples, with arrays repeated for `count` points."""
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
