"""Pre-integrated transfer functions: their means between the values at two points of a ray.

Between the points, the value v is assumed to change linearly from v₀ to v₁. The mean of the
function's A, the extinction from 0 to 1, is then

    (S(v₁) - S(v₀)) / (v₁ - v₀),   S(v) = ∫ A dv

and the mean of A · RGB likewise. Even a narrow peak of the function thus counts, which samples at
the two points would miss [Engel et al. 2001]. Where the function is smooth, samples are better,
because they follow values that rise and fall between the points.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, JitFloat, JitVector
from brdfkit.core.jit.padding import pad

# A table has peaks if it deviates from its moving mean by more than this share of its maximum
THIN = 0.1


@dataclass(init=False, eq=False)  # `dr.freeze` finds the arrays of a dataclass
class Preintegration:
    """The integrals of a transfer function's table over values, differentiable for its entries.

    `steps` is the number of steps of the table. `rows` are A·R, A·G, A·B and A at the ends of the
    steps, as a flat array, between which they are linear. `sums`, flat as well, are their integrals
    S from the first row up to each row, where a step has the width 1.
    """

    steps: int
    rows: Any
    sums: Any

    def __init__(self, table: Any) -> None:
        """Integrate a `table`, a `mi.TensorXf` (n, 4) of RGBA at even steps."""
        import mitsuba as mi

        flat, place = table.array, dr.arange(mi.UInt32, len(table.array))
        alpha = dr.gather(mi.Float, flat, place | 3)  # A of the row of each number
        self.steps = table.shape[0] - 1
        self.rows = dr.select((place & 3) == 3, alpha, flat * alpha)
        first = dr.gather(mi.Float, self.rows, place & 3)
        self.sums = dr.custom(Cumulative, self.rows) - (self.rows + first) / 2  # trapezoidal rule
        dr.make_opaque(self.rows, self.sums)

    def integrate_up_to(self, x: JitFloat) -> tuple[JitFloat, JitVector, JitVector]:
        """Integrate the table up to `x`, a value in steps from the first one; return (x, row, S).

        `row` are the A·RGB and A at x, and S their integrals; `mean_between` takes two results.
        Beyond the ends of the table, row and S are those of the end.
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

    def mean_between(self, front: Any, back: Any) -> JitVector:
        """Return the means of A·R, A·G, A·B and A between two values.

        `front` and `back` are the results of `integrate_up_to` at both values. If these are less
        than a step apart, the result is the mean of both rows, since the difference of the
        integrals would be lost in rounding.
        """
        (x0, row0, s0), (x1, row1, s1) = front, back
        within0, within1 = (dr.clip(x, 0, self.steps) for x in (x0, x1))
        apart = dr.abs(within1 - within0) >= 1
        beyond = (within0 - x0) * row0 + (x1 - within1) * row1
        whole = s1 - s0 + beyond
        return dr.select(apart, whole / dr.select(apart, x1 - x0, 1), (row0 + row1) / 2)


class Cumulative(dr.CustomOp):
    """A differentiable operation of Dr.Jit for the cumulative sums of a flat array's rows of four.

    It is computed in NumPy, because derivatives through `dr.cumsum`, `dr.concat` and slices of
    tensors are sometimes zero in Dr.Jit 1.5.
    """

    def eval(self, rows: JitFloat) -> JitFloat:
        return accumulate_rows(rows)

    def forward(self) -> None:
        self.set_grad_out(accumulate_rows(self.grad_in("rows")))

    def backward(self) -> None:
        self.set_grad_in("rows", accumulate_rows(self.grad_out(), -1))


def accumulate_rows(flat: JitFloat, way: int = 1) -> JitFloat:
    """Return the cumulative sums of a flat array's rows of four; from the last row if `way` is -1.

    The reversed sums are the derivative of the sums, for `Cumulative.backward`.
    """
    rows = np.array(flat, float).reshape(-1, 4)
    sums = np.cumsum(rows[::way], axis=0)[::way].astype(np.float32)
    return type(flat)(pad(sums.ravel()))  # aligned, so that all tables use the same kernels


def has_narrow_peaks(table: AnyArray, reach: float) -> bool:
    """Return whether a `table` (n, 4) of RGBA has peaks or jumps that samples would miss.

    `reach` is the distance of samples in steps of the table. The table has peaks if it deviates
    from its moving mean over the reach by more than the share THIN of its largest value.

    >>> peak = np.ones((100, 4)) * (np.arange(100) == 50)[:, None]
    >>> has_narrow_peaks(peak, 4.0), has_narrow_peaks(np.linspace(0, 1, 400).reshape(100, 4), 4.0)
    (True, False)
    """
    from scipy.ndimage import uniform_filter1d

    rows = table * [1, 1, 1, 0] * table[:, 3:] + table * [0, 0, 0, 1]
    width = 2 * int(np.ceil(min(reach, len(rows)) / 2)) + 1
    means = uniform_filter1d(rows, width, axis=0, mode="nearest")
    return bool((np.abs(rows - means).max(axis=0) > THIN * rows.max(axis=0)).any())
