"""Pre-integrated transfer functions: their means between the values at two places of a ray.

Between the places, the value v is assumed to change linearly from v₀ to v₁. The mean of A is then

    (S(v₁) - S(v₀)) / (v₁ - v₀),   S(v) = ∫ A dv

and the mean of A RGB likewise. Even a thin peak of the function thus counts, which samples a step
apart would miss [Engel et al. 2001]. Where the function changes little within a step, samples are
better, because they follow values that go up and down from voxel to voxel, and a straight line does
not.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, JitFloat, JitVector

THIN = 0.1  # deviation from the mean, over the largest value, above which a table has peaks


@dataclass(init=False, eq=False)  # `dr.freeze` finds the arrays of a dataclass
class Preintegration:
    """The integrals of a table over values, differentiable by its numbers.

    `steps` is the number of steps of the table. `rows` are A R, A G, A B and A at the ends of the
    steps, flat, and linear between them. `sums` are their integrals S from the first row to each,
    flat; a step has the width 1.
    """

    steps: int
    rows: Any
    sums: Any

    def __init__(self, table: Any) -> None:
        """Integrate a `table`, a `mi.TensorXf` (n, 4) of RGBA at even steps."""
        import mitsuba as mi

        flat, place = table.array, dr.arange(mi.UInt32, len(table.array))
        alpha = dr.gather(mi.Float, flat, place | 3)  # the A of each number's row
        self.steps = table.shape[0] - 1
        self.rows = dr.select((place & 3) == 3, alpha, flat * alpha)
        first = dr.gather(mi.Float, self.rows, place & 3)
        self.sums = dr.custom(Cumulative, self.rows) - (self.rows + first) / 2  # trapezoids
        dr.make_opaque(self.rows, self.sums)

    def at(self, x: JitFloat) -> tuple[JitFloat, JitVector, JitVector]:
        """Return (x, row, S) at a value `x`, in steps from the first one; `mean` takes two of them.

        Beyond the ends of the table, the row and S are those of the end.
        """
        import mitsuba as mi

        within = dr.clip(x, 0, self.steps)
        i = dr.minimum(mi.UInt32(within), self.steps - 1)
        share = within - mi.Float(i)
        low, high, before = (
            dr.gather(mi.Vector4f, source, index)
            for source, index in ((self.rows, i), (self.rows, i + 1), (self.sums, i))
        )
        row = dr.lerp(low, high, share)
        return x, row, before + share * (low + row) / 2

    def mean(self, front: Any, back: Any) -> JitVector:
        """Return the means (4) of the rows between two values, each as `at` gives it.

        If the values are less than a step apart, this is the mean of both rows, since rounding
        would spoil the difference of S.
        """
        (x0, row0, s0), (x1, row1, s1) = front, back
        within0, within1 = (dr.clip(x, 0, self.steps) for x in (x0, x1))
        apart = dr.abs(within1 - within0) >= 1
        beyond = (within0 - x0) * row0 + (x1 - within1) * row1
        whole = s1 - s0 + beyond
        return dr.select(apart, whole / dr.select(apart, x1 - x0, 1), (row0 + row1) / 2)


class Cumulative(dr.CustomOp):
    """Cumulative sums of rows, in NumPy.

    In Dr.Jit 1.5, derivatives through slices of tensors, `dr.concat` and `dr.cumsum` are sometimes
    zero. For the same reason rows are gathered.
    """

    def eval(self, rows: JitFloat) -> JitFloat:
        return accumulate(rows)

    def forward(self) -> None:
        self.set_grad_out(accumulate(self.grad_in("rows")))

    def backward(self) -> None:
        self.set_grad_in("rows", accumulate(self.grad_out(), -1))


def accumulate(flat: JitFloat, way: int = 1) -> JitFloat:
    """Return the sums of each row of four and all rows before it, or behind it if `way` is -1."""
    rows = np.array(flat, float).reshape(-1, 4)
    return type(flat)(np.cumsum(rows[::way], axis=0)[::way].astype(np.float32).ravel())


def has_peaks(table: AnyArray, reach: float) -> bool:
    """Return whether a `table` (n, 4) of RGBA has peaks or jumps within a `reach` [steps].

    A table has peaks if it deviates from its own moving mean over the reach by more than THIN.

    >>> peak = np.ones((100, 4)) * (np.arange(100) == 50)[:, None]
    >>> has_peaks(peak, 4.0), has_peaks(np.linspace(0, 1, 400).reshape(100, 4), 4.0)
    (True, False)
    """
    from scipy.ndimage import uniform_filter1d

    rows = table * [1, 1, 1, 0] * table[:, 3:] + table * [0, 0, 0, 1]
    width = 2 * int(np.ceil(min(reach, len(rows)) / 2)) + 1
    means = uniform_filter1d(rows, width, axis=0, mode="nearest")
    return bool((np.abs(rows - means).max(axis=0) > THIN * rows.max(axis=0)).any())
