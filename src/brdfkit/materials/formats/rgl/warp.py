"""Draws points of the unit square by a tabulated density, and interpolates such tables.

A table has values on an even grid over the unit square, with y as the first axis, and is bilinear
between them. If it depends on parameters, such as the incidence, it has a slice for each
combination of their nodes, and is linear between the slices. A warp maps uniform points to points
with the density of the table: it inverts the marginal distribution of y, then the distribution of x
for this y.

This is Mitsuba's `MarginalContinuous2D` (W. Jakob et al., Mitsuba 3, `distr_2d.h`) in double
precision.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.geometry.multilinear import find_bracket, list_corners, to_flat_index

# Pairs: the number of a table's slice, and its weight in the interpolation between slices. Both are
# arrays (n,) for n points, or single numbers for all points
Slices = Sequence[tuple[Any, Any]]


def make_even_grid(n: int) -> FloatArray:
    """Return the n × n points (x, y) of an even grid over the unit square, as (n², 2).

    The grid includes the edges, and x runs fastest.
    """
    x, y = np.meshgrid(*[np.linspace(0, 1, n)] * 2)
    return np.stack([x.ravel(), y.ravel()], axis=1)


def find_slices(nodes: Sequence[FloatArray], values: Sequence[FloatArray]) -> Slices:
    """Return the slices of a table between which to interpolate, in pairs with their weights (n,).

    A slice is the part of a table for one combination of its parameters' nodes. `nodes` has the
    increasing nodes of each parameter, and `values` n values of each, which are clamped to the
    nodes. Slices are numbered with the last parameter running fastest.
    """
    brackets, shape = [], []
    for axis, x in zip(nodes, values, strict=True):
        if len(axis) > 1:
            lower = np.clip(np.searchsorted(axis, x) - 1, 0, len(axis) - 2)
            t = np.clip((x - axis[lower]) / (axis[lower + 1] - axis[lower]), 0, 1)
            brackets.append((lower, lower + 1, t))
            shape.append(len(axis))
    first = np.zeros(np.shape(values[0]), int)
    return [(first + to_flat_index(at, shape), weight) for at, weight in list_corners(brackets)]


def interpolate(table: FloatArray, u: FloatArray, slices: Slices = ((0, 1.0),)) -> FloatArray:
    """Interpolate a `table` (slices, ny, nx, ...) at points `u` (n, 2), given as (x, y).

    `slices`, as `find_slices` returns them, are the ones to interpolate between. The result is
    (n, ...).
    """
    _, ny, nx, *rest = table.shape
    cells = [_find_grid_bracket(u[:, 0], nx), _find_grid_bracket(u[:, 1], ny)]
    result: Any = 0.0
    for at, weight in slices:
        for (x, y), share in list_corners(cells):
            result = result + (weight * share).reshape(-1, *[1] * len(rest)) * table[at, y, x]
    return result


@dataclass(frozen=True, eq=False)
class Warp:
    """A map of uniform points of the unit square to points with a tabulated density.

    `density`: table of one density per slice, which need not be normalised, (slices, ny, nx).

    >>> Warp(np.ones((1, 2, 2))).sample(0, np.array([[0.25, 0.5]]))
    array([[0.25, 0.5 ]])
    """

    density: FloatArray

    @cached_property
    def _cumulative_tables(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Three tables: the density, its integral along each row, and the integral over the rows.

        All are scaled so that the last one ends with 1, if cells of the grid have unit area.
        """
        along = _integrate_up_to_nodes(self.density)
        rows = _integrate_up_to_nodes(along[..., -1])
        total = rows[:, -1]
        return (
            self.density / total[:, None, None],
            along / total[:, None, None],
            rows / total[:, None],
        )

    def sample(self, at: int, u: FloatArray) -> FloatArray:
        """Map uniform points `u` (n, 2), as (x, y), to points with the density of a slice.

        `at` is the number of the slice.
        """
        density, along, rows = (table[at] for table in self._cumulative_tables)
        # Find y by inverting the marginal distribution of y
        y = np.clip(np.searchsorted(rows, u[:, 1]) - 1, 0, len(rows) - 2)
        ty = _invert_line_integral(u[:, 1] - rows[y], along[y, -1], along[y + 1, -1])

        # Find x by inverting the distribution along the row at this y
        row = _lerp(along[y], along[y + 1], ty[:, None])
        share = u[:, 0] * row[:, -1]
        x = np.clip((row < share[:, None]).sum(axis=1) - 1, 0, row.shape[1] - 2)
        before = np.take_along_axis(row, x[:, None], axis=1)[:, 0]
        left = _lerp(density[y, x], density[y + 1, x], ty)
        right = _lerp(density[y, x + 1], density[y + 1, x + 1], ty)
        tx = _invert_line_integral(share - before, left, right)
        return np.stack([(x + tx) / (row.shape[1] - 1), (y + ty) / (len(rows) - 1)], axis=1)

    def pdf(self, points: FloatArray, slices: Slices) -> FloatArray:
        """Return the normalised density (n,) with which `sample` draws the `points` (n, 2).

        `slices`, as `find_slices` returns them, are the ones to interpolate between.
        """
        density, _, _ = self._cumulative_tables
        _, ny, nx = density.shape
        return (ny - 1) * (nx - 1) * interpolate(density, points, slices)

    def invert(self, u: FloatArray, slices: Slices) -> FloatArray:
        """Return the uniform points (n, 2) that `sample` maps to the points `u` (n, 2).

        `slices`, as `find_slices` returns them, are the ones to interpolate between.
        """
        density, along, rows = self._cumulative_tables
        x, _, tx = _find_grid_bracket(u[:, 0], density.shape[2])
        y, _, ty = _find_grid_bracket(u[:, 1], density.shape[1])

        def mix_slices(table: FloatArray, *index: Any) -> Any:
            """Interpolate between the slices of a table, at one `index` within each slice."""
            return sum(weight * table[(slice_, *index)] for slice_, weight in slices)

        # Integrate the density along the row at y, from 0 to x
        left = _lerp(mix_slices(density, y, x), mix_slices(density, y + 1, x), ty)
        right = _lerp(mix_slices(density, y, x + 1), mix_slices(density, y + 1, x + 1), ty)
        before = _lerp(mix_slices(along, y, x), mix_slices(along, y + 1, x), ty)
        lower, upper = mix_slices(along, y, -1), mix_slices(along, y + 1, -1)
        row = _lerp(lower, upper, ty)
        share = before + _integrate_line(left, right, tx)
        x = np.divide(share, row, out=np.zeros_like(share), where=row > 0)
        # Integrate the marginal distribution of y, from 0 to y
        return np.stack([x, mix_slices(rows, y) + _integrate_line(lower, upper, ty)], axis=1)


def _find_grid_bracket(u: FloatArray, n: int) -> Any:
    """Return the nodes between which coordinates `u` (m,) in the unit square lie, and the weights.

    The `n` nodes span the unit square from edge to edge. The result is a bracket, as
    `brdfkit.core.geometry.multilinear` defines it.
    """
    return find_bracket(u * (n - 1), n)


def _integrate_up_to_nodes(values: FloatArray) -> FloatArray:
    """Integrate `values`, linearly interpolated, along the last axis, up to each node."""
    steps = (values[..., 1:] + values[..., :-1]) / 2
    return np.concatenate([np.zeros_like(values[..., :1]), np.cumsum(steps, axis=-1)], axis=-1)


def _lerp(a: Any, b: Any, t: FloatArray) -> Any:
    """Interpolate linearly from a, at t = 0, to b, at t = 1."""
    return (1 - t) * a + t * b


def _integrate_line(a: FloatArray, b: FloatArray, t: FloatArray) -> FloatArray:
    """Integrate the line that is a at 0 and b at 1 from 0 to t."""
    return t * (a + t / 2 * (b - a))


def _invert_line_integral(mass: FloatArray, a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the t up to which the line that is a at 0 and b at 1 has the integral `mass`."""
    divisor = a + np.sqrt(np.maximum(a * a + 2 * mass * (b - a), 0))
    return np.divide(2 * mass, divisor, out=np.zeros_like(mass), where=divisor > 0)
