"""A warp of the unit square to a tabulated density, and the tables that go with it.

A table has its values on an even grid over the unit square, first axis y, and is bilinear in
between; it may depend on parameters, between whose nodes it is linear. The warp inverts the
marginal distribution of y first, then that of x given y: Mitsuba's `MarginalContinuous2D`.

W. Jakob et al., Mitsuba 3, `distr_2d.h`; here in double precision.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from brdfkit.geometry.multilinear import bracket, corners, flat_index


def even_grid(n):
    """n × n points (n², 2), (x, y), of the unit square, from edge to edge, x running fastest."""
    x, y = np.meshgrid(*[np.linspace(0, 1, n)] * 2)
    return np.stack([x.ravel(), y.ravel()], axis=1)


def between(nodes, values):
    """The slices of a table between whose parameters `values` lie: [(slice, weight), ...].

    `nodes`: one increasing array per parameter, `values`: (n,) for each, held at the ends. The
    slices are numbered with the last parameter running fastest.
    """
    brackets, shape = [], []
    for axis, x in zip(nodes, values, strict=True):
        if len(axis) > 1:
            lower = np.clip(np.searchsorted(axis, x) - 1, 0, len(axis) - 2)
            t = np.clip((x - axis[lower]) / (axis[lower + 1] - axis[lower]), 0, 1)
            brackets.append((lower, lower + 1, t))
            shape.append(len(axis))
    first = np.zeros(np.shape(values[0]), int)
    return [(first + flat_index(at, shape), weight) for at, weight in corners(brackets)]


def interpolated(table, u, slices=((0, 1.0),)):
    """Values (n, ...) at the points `u` (n, 2), (x, y), of a `table` (slices, ny, nx, ...)."""
    _, ny, nx, *rest = table.shape
    cells = [_bracket(u[:, 0], nx), _bracket(u[:, 1], ny)]
    result = 0.0
    for at, weight in slices:
        for (x, y), share in corners(cells):
            result = result + (weight * share).reshape(-1, *[1] * len(rest)) * table[at, y, x]
    return result


@dataclass(frozen=True, eq=False)
class Warp:
    """The warp to each of the densities (slices, ny, nx), which need not be normalised.

    >>> Warp(np.ones((1, 2, 2))).sample(0, np.array([[0.25, 0.5]]))
    array([[0.25, 0.5 ]])
    """

    density: np.ndarray

    @cached_property
    def _tables(self):
        """Density, distribution along each row, and of the rows: normalised, in units of cells."""
        along = _cumulative(self.density)
        rows = _cumulative(along[..., -1])
        total = rows[:, -1]
        return (
            self.density / total[:, None, None],
            along / total[:, None, None],
            rows / total[:, None],
        )

    def sample(self, at, u):
        """The points (n, 2) of slice `at` to which evenly distributed `u` (n, 2), (x, y), go."""
        density, along, rows = (table[at] for table in self._tables)
        y = np.clip(np.searchsorted(rows, u[:, 1]) - 1, 0, len(rows) - 2)
        ty = _solved(u[:, 1] - rows[y], along[y, -1], along[y + 1, -1])

        row = _mixed(along[y], along[y + 1], ty[:, None])
        share = u[:, 0] * row[:, -1]
        x = np.clip((row < share[:, None]).sum(axis=1) - 1, 0, row.shape[1] - 2)
        before = np.take_along_axis(row, x[:, None], axis=1)[:, 0]
        left = _mixed(density[y, x], density[y + 1, x], ty)
        right = _mixed(density[y, x + 1], density[y + 1, x + 1], ty)
        tx = _solved(share - before, left, right)
        return np.stack([(x + tx) / (row.shape[1] - 1), (y + ty) / (len(rows) - 1)], axis=1)

    def pdf(self, points, slices):
        """Density of `sample` at points (n, 2); `slices` as `between` gives them."""
        density, _, _ = self._tables
        _, ny, nx = density.shape
        return (ny - 1) * (nx - 1) * interpolated(density, points, slices)

    def invert(self, u, slices):
        """Where `sample` takes the points `u` (n, 2) from; `slices` as `between` gives them."""
        density, along, rows = self._tables
        x, _, tx = _bracket(u[:, 0], density.shape[2])
        y, _, ty = _bracket(u[:, 1], density.shape[1])

        def at(table, *index):
            return sum(weight * table[(slice_, *index)] for slice_, weight in slices)

        left = _mixed(at(density, y, x), at(density, y + 1, x), ty)
        right = _mixed(at(density, y, x + 1), at(density, y + 1, x + 1), ty)
        before = _mixed(at(along, y, x), at(along, y + 1, x), ty)
        lower, upper = at(along, y, -1), at(along, y + 1, -1)
        row = _mixed(lower, upper, ty)
        share = before + _mass(left, right, tx)
        x = np.divide(share, row, out=np.zeros_like(share), where=row > 0)
        return np.stack([x, at(rows, y) + _mass(lower, upper, ty)], axis=1)


def _bracket(u, n):
    """Of a coordinate of the unit square among `n` nodes from edge to edge."""
    return bracket(u * (n - 1), n)


def _cumulative(values):
    """Integrals of the linear interpolant from the first node to each, along the last axis."""
    steps = (values[..., 1:] + values[..., :-1]) / 2
    return np.concatenate([np.zeros_like(values[..., :1]), np.cumsum(steps, axis=-1)], axis=-1)


def _mixed(a, b, t):
    return (1 - t) * a + t * b


def _mass(a, b, t):
    """∫ of the line from a (at 0) to b (at 1) up to t."""
    return t * (a + t / 2 * (b - a))


def _solved(mass, a, b):
    """The t at which `_mass` is `mass`, in a form that does not cancel."""
    divisor = a + np.sqrt(np.maximum(a * a + 2 * mass * (b - a), 0))
    return np.divide(2 * mass, divisor, out=np.zeros_like(mass), where=divisor > 0)
