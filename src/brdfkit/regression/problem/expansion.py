"""Approximates the squared loss E² near points of the search by quadratic functions.

The quadratic function has the gradient of E² and its Gauss-Newton Hessian, which leaves out second
derivatives of the model. A search takes its next step to the minimum of this function.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.regression.problem.box_quadratic import minimise_in_box
from brdfkit.regression.problem.columns import Columns
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.sums import Sums


@dataclass(eq=False)
class Expansion:
    """Quadratic approximations E² + 2 gᵀ s + sᵀ H s of the squared loss for steps s from points.

    A point is a set of parameters: coordinates of the shape parameters, then the weights of the
    lobes by channel. A step changes these n numbers.

    `columns`, `space`: columns and search space of the problem; `u`: coordinates (points, shapes);
    `weights`: weights (points, channels, lobes); `error`: E² (points,); `gradient`: g (points, n),
    half the gradient of E²; `hessian`: H (points, n, n), or None if it was not computed; `gram`,
    `moment`: sums as in `Sums`.
    """

    columns: Any
    space: Any
    u: np.ndarray
    weights: np.ndarray
    error: np.ndarray
    gradient: np.ndarray
    hessian: Any
    gram: Any
    moment: np.ndarray

    @classmethod
    def from_sums(
        cls, columns: Columns, space: Space, sums: Sums, u: FloatArray, weights: FloatArray
    ) -> Expansion:
        """Return the expansion about points from the sums over all samples at these points.

        `u` (points, shapes), `weights` (points, channels, lobes): the points.
        """
        change = make_derivative_matrix(columns, weights, space.differentiate_parameters(u))
        gradient = _sum_gradients((change @ sums.moment[..., None])[..., 0], len(columns.names))
        given = columns, space, u, weights, sums.error, gradient
        made = cls(*given, None, sums.gram, sums.moment)
        return made if sums.gram is None else replace(made, hessian=made._make_hessian(change))

    def split_gradient(self) -> FloatArray:
        """Return the gradient as parts (points, channels, n) of each channel."""
        slopes = self.space.differentiate_parameters(self.u)
        change = make_derivative_matrix(self.columns, self.weights, slopes)
        by_channel = (change @ self.moment[..., None])[..., 0]
        parts = [
            _sum_gradients(
                by_channel * (np.arange(by_channel.shape[1]) == c)[:, None], slopes.shape[1]
            )
            for c in range(by_channel.shape[1])
        ]
        return np.stack(parts, axis=1)

    def _make_hessian(self, change: FloatArray) -> FloatArray:
        """Return half the Gauss-Newton Hessians (points, n, n) of the squared loss E².

        `change`: matrices of the model's derivatives, from `make_derivative_matrix`.
        """
        points, channels, lobes = self.weights.shape
        shapes = self.u.shape[1]
        products = change @ self.gram @ change.transpose(0, 1, 3, 2)
        hessian = np.zeros((points, shapes + channels * lobes, shapes + channels * lobes))
        hessian[:, :shapes, :shapes] = products[:, :, :shapes, :shapes].sum(axis=1)
        for c in range(channels):
            own = slice(shapes + c * lobes, shapes + (c + 1) * lobes)
            hessian[:, own, own] = products[:, c, shapes:, shapes:]
            hessian[:, :shapes, own] = products[:, c, :shapes, shapes:]
            hessian[:, own, :shapes] = products[:, c, shapes:, :shapes]
        return hessian

    def predict_best_weights(self, u: FloatArray, limits: FloatArray) -> FloatArray:
        """Return the best weights (points, channels, lobes) for other coordinates of the shapes.

        A search needs them because a lobe's weight and its Fresnel reflectance can make up for each
        other: if one changes, so must the other. The prediction assumes that the lobes are linear
        in their parameters, and the loss is quadratic in the model. `u` (points, shapes): the other
        coordinates; `limits` (2, lobes): lower and upper bounds of the weights.
        """
        columns, count = self.columns, len(self.columns.lobes)
        by = self.space.to_parameters(u) - self.space.to_parameters(self.u)
        # Each row expresses a lobe at the new coordinates as a combination of the old columns
        lobes = np.zeros((len(u), count, len(columns)))
        lobes[:, range(count), range(count)] = 1
        for k, (value, j) in enumerate(columns.slopes, count):
            lobes[:, value, k] = by[:, j]
        model = np.zeros((*self.weights.shape[:2], len(columns)))
        model[:, :, :count] = self.weights[:, :, columns.lobes] ** columns.powers
        target = (self.gram @ model[..., None])[..., 0] - self.moment
        lobes = lobes[:, None]
        gram = lobes @ self.gram @ lobes.transpose(0, 1, 3, 2)
        moment = -(lobes @ target[..., None])[..., 0]
        # Lobes without a weight are in the target's way: their factor stays 1
        n, fixed = self.weights.shape[2], columns.powers == 0
        moment = moment[..., :n] + gram[..., :n, fixed].sum(axis=-1)
        gram = gram[..., :n, :n].reshape(-1, n, n)
        return minimise_in_box(gram, moment.reshape(-1, n), *limits).reshape(self.weights.shape)

    def select_points(self, rows: Any) -> Expansion:
        """Return the expansion about some of the points, selected by indices or a mask.

        It shares its arrays with this expansion if all points are selected.
        """
        rows = np.asarray(rows)
        if rows.dtype == bool and rows.all():
            return self
        return replace(self, **{name: getattr(self, name)[rows] for name in ARRAYS})

    def replace_points(self, rows: IntArray, other: Expansion) -> None:
        """Replace the points with the indices `rows` by all points of the expansion `other`."""
        for name in ARRAYS:
            getattr(self, name)[rows] = getattr(other, name)


def _sum_gradients(by_channel: FloatArray, shapes: int) -> FloatArray:
    """Return gradients (points, n) from derivatives (points, channels, shapes + lobes)."""
    weights = by_channel[:, :, shapes:].reshape(len(by_channel), -1)
    return np.hstack([by_channel[:, :, :shapes].sum(axis=1), weights])


ARRAYS = [f.name for f in fields(Expansion) if f.name not in ("columns", "space")]


def make_derivative_matrix(columns: Columns, weights: FloatArray, slopes: FloatArray) -> FloatArray:
    """Return the matrices (points, channels, shapes + lobes, columns) of the model's derivatives.

    A matrix times the columns of the model gives its derivatives with respect to the coordinates of
    the shape parameters, then with respect to the weights of the lobes in a channel. `weights`
    (points, channels, lobes): weights of the lobes; `slopes` (points, shapes): derivative of each
    shape parameter with respect to its coordinate.
    """
    points, channels, lobes = weights.shape
    shapes, values = len(columns.names), len(columns.lobes)
    change = np.zeros((points, channels, shapes + lobes, len(columns)))
    for k, (lobe, power) in enumerate(zip(columns.lobes, columns.powers, strict=True)):
        if power:
            change[:, :, shapes + lobe, k] = 1 if power == 1 else 2 * weights[:, :, lobe]
    factors = weights[:, :, columns.lobes] ** columns.powers
    for k, (value, j) in enumerate(columns.slopes, values):
        change[:, :, j, k] = factors[:, :, value] * slopes[:, None, j]
    return change
