"""Expands E² about points of the search to second order, by Gauss and Newton."""

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
    """E² about points: E² + 2 gᵀ s + sᵀ H s for a step s.

    A step changes the coordinates of the shape parameters, then the weights by channel. `u`
    (points, shapes), `weights` (points, channels, lobes): the points; `error` E² (points,);
    `gradient` g (points, n); `hessian` H (points, n, n), None if no Gram matrix was summed; `gram`,
    `moment`: as in `Sums`; `columns`, `space`: of the problem.
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
        """Return the expansion made from `Sums` at the points."""
        points, channels, lobes = weights.shape
        shapes = len(columns.names)
        change = make_derivative_matrix(columns, weights, space.differentiate(u))
        by_channel = (change @ sums.moment[..., None])[..., 0]
        gradient = np.zeros((points, shapes + channels * lobes))
        gradient[:, :shapes] = by_channel[:, :, :shapes].sum(axis=1)
        gradient[:, shapes:] = by_channel[:, :, shapes:].reshape(points, channels * lobes)
        given = columns, space, u, weights, sums.error, gradient
        made = cls(*given, None, sums.gram, sums.moment)
        return made if sums.gram is None else replace(made, hessian=made._make_hessian(change))

    def _make_hessian(self, change: FloatArray) -> FloatArray:
        """Return the Hessian (points, n, n); `change`: as `make_derivative_matrix` returns."""
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

    def predict_weights(self, u: FloatArray, least: FloatArray) -> FloatArray:
        """Return the best weights (points, channels, lobes) at other coordinates `u`.

        The prediction assumes lobes that are linear in their parameters, and a loss that is
        quadratic in the model; weights are at least `least` (lobes,). So a step follows the curve
        along which the strength of a lobe and its Fresnel reflectance trade off.
        """
        columns, count = self.columns, len(self.columns.lobes)
        by = self.space.to_parameters(u) - self.space.to_parameters(self.u)
        # The lobes at `u`, as combinations of the columns at these points
        lobes = np.zeros((len(u), count, len(columns)))
        lobes[:, range(count), range(count)] = 1
        for k, (value, j) in enumerate(columns.slopes, count):
            lobes[:, value, k] = by[:, j]
        model = np.zeros((*self.weights.shape[:2], len(columns)))
        model[:, :, :count] = self.weights
        target = (self.gram @ model[..., None])[..., 0] - self.moment
        lobes = lobes[:, None]
        gram = lobes @ self.gram @ lobes.transpose(0, 1, 3, 2)
        moment = -(lobes @ target[..., None])[..., 0]
        return minimise_in_box(
            gram.reshape(-1, count, count), moment.reshape(-1, count), least, np.inf
        ).reshape(self.weights.shape)

    def select(self, rows: Any) -> Expansion:
        """Return the expansion about some of the points."""
        return replace(self, **{name: getattr(self, name)[rows] for name in ARRAYS})

    def replace_points(self, rows: IntArray, other: Expansion) -> None:
        """Replace the points `rows` by the points of the expansion `other`."""
        for name in ARRAYS:
            getattr(self, name)[rows] = getattr(other, name)


ARRAYS = [f.name for f in fields(Expansion) if f.name not in ("columns", "space")]


def make_derivative_matrix(columns: Columns, weights: FloatArray, slopes: FloatArray) -> FloatArray:
    """Return the model's derivatives as combinations of its columns.

    The array (points, channels, shapes + lobes, columns) has the derivatives by coordinates, then
    by weights. `slopes` (points, shapes): the derivatives of the parameters by coordinates.
    """
    points, channels, lobes = weights.shape
    shapes, values = len(columns.names), len(columns.lobes)
    change = np.zeros((points, channels, shapes + lobes, len(columns)))
    for k, (lobe, power) in enumerate(zip(columns.lobes, columns.powers, strict=True)):
        change[:, :, shapes + lobe, k] = 1 if power == 1 else 2 * weights[:, :, lobe]
    factors = weights[:, :, columns.lobes] ** columns.powers
    for k, (value, j) in enumerate(columns.slopes, values):
        change[:, :, j, k] = factors[:, :, value] * slopes[:, None, j]
    return change
