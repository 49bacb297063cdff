"""Pre-integrated transfer functions: their means between the values at two places of a ray.

Between the places the value v is taken to change evenly from v₀ to v₁. Then the mean of A is

    (S(v₁) - S(v₀)) / (v₁ - v₀),   S(v) = ∫ A dv

and that of A RGB likewise. So a peak of the function counts, however thin; samples at places a step
apart would miss it [Engel et al. 2001]. Where the function changes little in a step, samples are
better: from voxel to voxel values go up and down, and a straight line has less of that than they.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

THIN = 0.1  # of a row's largest value


@dataclass(init=False, eq=False)  # of a dataclass `dr.freeze` finds the arrays
class Preintegration:
    """The integrals of a table over values; they have the derivatives by its numbers.

    steps : how many the table has.
    rows : A R, A G, A B and A at both ends of each step, flat; linear between them.
    sums : their integrals S from the first row to each, flat; a step is 1 wide.
    """

    steps: int
    rows: Any
    sums: Any

    def __init__(self, table):
        """table : `mi.TensorXf` (n, 4), RGBA at even steps."""
        import mitsuba as mi

        flat, place = table.array, dr.arange(mi.UInt32, len(table.array))
        alpha = dr.gather(mi.Float, flat, place | 3)  # of each number's row
        self.steps = table.shape[0] - 1
        self.rows = dr.select((place & 3) == 3, alpha, flat * alpha)
        first = dr.gather(mi.Float, self.rows, place & 3)
        self.sums = dr.custom(Cumulative, self.rows) - (self.rows + first) / 2  # by trapezoids
        dr.make_opaque(self.rows, self.sums)

    def at(self, x):
        """(x, row, S) at a value, in steps from the first one; `mean` takes two of them.

        Beyond the ends of the table the row is that of the end, and S is that of the end, too.
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

    def mean(self, front, back):
        """The means (4) of the rows between two values, each as `at` gives it.

        Where they are less than a step apart, it is that of both rows: S would be rounded.
        """
        (x0, row0, s0), (x1, row1, s1) = front, back
        within0, within1 = (dr.clip(x, 0, self.steps) for x in (x0, x1))
        apart = dr.abs(within1 - within0) >= 1
        beyond = (within0 - x0) * row0 + (x1 - within1) * row1
        whole = s1 - s0 + beyond
        return dr.select(apart, whole / dr.select(apart, x1 - x0, 1), (row0 + row1) / 2)


class Cumulative(dr.CustomOp):
    """Cumulative sums of rows, in NumPy.

    Derivatives through tensors' slices, `dr.concat` and `dr.cumsum` were at times zeros in Dr.Jit
    1.5: so rows are gathered, too.
    """

    def eval(self, rows):
        return cumulative(rows)

    def forward(self):
        self.set_grad_out(cumulative(self.grad_in("rows")))

    def backward(self):
        self.set_grad_in("rows", cumulative(self.grad_out(), -1))


def cumulative(flat, way=1):
    """The sums of each row of four and those before it; of those behind it if the `way` is -1."""
    rows = np.array(flat, float).reshape(-1, 4)
    return type(flat)(np.cumsum(rows[::way], axis=0)[::way].astype(np.float32).ravel())


def is_thin(table, reach):
    """Whether a table (n, 4) of RGBA, NumPy's, has peaks or jumps within a `reach` [steps].

    There it is off its own mean over the reach, by more than THIN.

    >>> peak = np.ones((100, 4)) * (np.arange(100) == 50)[:, None]
    >>> is_thin(peak, 4.0), is_thin(np.linspace(0, 1, 400).reshape(100, 4), 4.0)
    (True, False)
    """
    from scipy.ndimage import uniform_filter1d

    rows = table * [1, 1, 1, 0] * table[:, 3:] + table * [0, 0, 0, 1]
    width = 2 * int(np.ceil(min(reach, len(rows)) / 2)) + 1
    means = uniform_filter1d(rows, width, axis=0, mode="nearest")
    return bool((np.abs(rows - means).max(axis=0) > THIN * rows.max(axis=0)).any())
