"""`TensorTree`: a BRDF in the cells of Radiance's tensor trees.

A cell holds pairs of directions. Directions to the light lie in a cell of the square that
`core/geometry/disc.py` maps to the disc of their x and y; so do directions to the viewer, negated,
if the BRDF is anisotropic. If it is isotropic, the viewer has the one coordinate ½ - ½ sinθ, of
which only the lower half is used, and the light is turned so that the negated viewer lies at +x.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.geometry.disc import disc_to_square, square_to_disc
from brdfkit.materials.measured.measured_data import Lookup

LEAST_COSINE = 1e-3  # of directions at the edge of the disc
PARTS = 2  # points along each edge of a cell at which a BRDF is evaluated
DIGITS = 4  # of the values in a tree


@dataclass(frozen=True, eq=False)
class TensorTree:
    """A BRDF that is constant in each cell; it evaluates like a material.

    `name`: the material's name; `cells`: values (n, n, n, channels) of an isotropic BRDF, or
    (n, n, n, n, channels): one dimension or two of the viewer, and two of the light.
    """

    name: str
    cells: FloatArray

    def eval(self, wi: FloatArray, wo: FloatArray) -> NDArray[np.float64]:
        """Return the BRDF [sr⁻¹] (n, channels) for directions to light and viewer, (n, 3) each."""
        light, view = wi[:, :2], -wo[:, :2]
        if self.cells.ndim == 4:
            sine, phi = np.hypot(*view.T), np.arctan2(view[:, 1], view[:, 0])
            turn = np.array([[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]])
            light = np.einsum("ni,ijn->nj", light, turn)
            viewer = (1 - sine[:, None]) / 2
        else:
            viewer = disc_to_square(view)
        n = self.cells.shape[0]
        square = np.concatenate([viewer, disc_to_square(light)], axis=1)
        values = self.cells[tuple(np.clip((square * n).astype(int), 0, n - 1).T)]
        above = (wi[:, 2:] > 0) & (wo[:, 2:] > 0)
        return np.where(above, values, 0).astype(float)


def tabulate(f: Lookup, depth: int, isotropic: bool) -> FloatArray:
    """Return the means of a BRDF in 2^depth cells along each dimension, the `cells` of a tree.

    Values below 0 count as 0.
    """
    n = 2**depth
    fine = (np.arange(n * PARTS) + 0.5) / (n * PARTS)
    lights = _raise(square_to_disc(np.array(list(product(fine, fine)))))
    if isotropic:
        sines = 1 - 2 * fine[: n // 2 * PARTS]
        views = np.stack([-sines, 0 * sines], axis=1).reshape(-1, PARTS, 2)
    else:  # one point for each viewer: more cost much time, and change little
        middles = (np.arange(n) + 0.5) / n
        views = -square_to_disc(np.array(list(product(middles, middles))))[:, None]
    rows = [
        np.mean([_tabulate_lights(f, lights, view, n) for view in _raise(cell)], axis=0)
        for cell in views
    ]
    if isotropic:
        rows += [np.zeros_like(rows[0])] * (n - len(rows))
    return np.reshape(rows, (*[n] * (3 if isotropic else 4), -1))


def _tabulate_lights(f: Lookup, lights: FloatArray, view: FloatArray, n: int) -> FloatArray:
    """Return the means of a BRDF in the cells (n, n, channels) of the light, for a view (3,)."""
    values = np.maximum(f(lights, np.broadcast_to(view, lights.shape)), 0)
    return values.reshape(n, PARTS, n, PARTS, -1).mean(axis=(1, 3)).astype(np.float32)


def _raise(xy: FloatArray) -> FloatArray:
    """Return the directions (n, 3) above the surface with these x and y (n, 2)."""
    z = np.sqrt(np.maximum(1 - np.square(xy).sum(axis=1), LEAST_COSINE**2))
    return np.column_stack([xy, z])


def merge_cells(cells: FloatArray, tolerance: float) -> FloatArray:
    """Return cells (n, n, ...) in which blocks of almost equal values are equal.

    A block, which is a half of the cells along each dimension, or a half of that, and so on,
    becomes its mean if its values differ by less than the share `tolerance` of that.
    """
    merged = low = high = mean = cells
    while len(mean) > 1:
        low, high, mean = _gather(low).min(-1), _gather(high).max(-1), _gather(mean).mean(-1)
        equal = high - low <= tolerance * mean
        merged = np.where(_spread(equal, len(cells)), _spread(mean, len(cells)), merged)
    return merged


def _gather(cells: FloatArray) -> FloatArray:
    """Return the values (n / 2, n / 2, ..., children) of two cells along each dimension."""
    halves = cells.reshape([part for n in cells.shape for part in (n // 2, 2)])
    ends = range(1, halves.ndim, 2)
    return np.moveaxis(halves, ends, range(-cells.ndim, 0)).reshape(*halves.shape[::2], -1)


def _spread(blocks: AnyArray, n: int) -> AnyArray:
    """Return the values of blocks at n cells along each dimension."""
    for axis in range(blocks.ndim):
        blocks = blocks.repeat(n // blocks.shape[axis], axis)
    return blocks


def format_tree(cells: FloatArray) -> str:
    """Return the text of a tree: a branch for each block of cells that are not equal.

    A branch has a child for each half along each dimension, the first dimension changing fastest;
    in a block of two cells along each dimension, the last changes fastest.

    >>> format_tree(np.array([[1.0, 2.0], [3.0, 4.0]]))
    '{1 2 3 4}\\n'
    """
    first = cells.flat[0]
    if (cells == first).all():
        return f"{{{first:.{DIGITS}g}}}\n"
    n = len(cells) // 2
    if n == 1:
        return f"{{{' '.join([f'{value:.{DIGITS}g}' for value in cells.ravel().tolist()])}}}\n"
    halves = slice(n), slice(n, None)
    branches = (cells[places[::-1]] for places in product(halves, repeat=cells.ndim))
    return f"{{\n{''.join(map(format_tree, branches))}}}\n"


def round_digits(values: FloatArray) -> FloatArray:
    """Return values from 0 on as the text of a tree has them.

    >>> round_digits(np.array([0.0, 0.123456]))
    array([0.    , 0.1235])
    """
    powers = np.floor(np.log10(values, out=np.zeros(values.shape), where=values > 0))
    steps = 10.0 ** (powers - DIGITS + 1)
    return np.round(values / steps) * steps
