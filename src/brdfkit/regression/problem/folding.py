"""Speeds up fits to tables under a linear loss, by sums over samples with equal half vectors.

Some lobes are a product S A of two factors. S contains the shape parameters, and depends only on
the half vector and on θ_d, the angle between it and the incident direction. A contains no
parameters, so it stays the same in all steps of a fit.

A loss is linear if its difference is a factor κ times (model - measured). With weights w and
measured values R of the samples, the squared loss then follows from three sums over the samples:

    Σ w κ² (S A)_k (S A)_l for lobes k and l,   Σ w κ² S A R,   Σ w κ² R².

Samples with equal half vectors, and equal θ_d if S depends on it, form a "node"; MERL's tables have
90 half vectors. The samples of a node have the same S, so the products of w, κ, A and R are summed
once for each node. Every step of a fit then sums over the nodes only.
"""

from __future__ import annotations

from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray, JitFloat
from brdfkit.core.geometry.vectors import cos_theta_d, half_vector
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import Vector
from brdfkit.model.lobes import Lobe
from brdfkit.regression.problem.blocks import Block
from brdfkit.regression.problem.expansion import Expansion
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.sums import Sums, move_sums_to_weights, solve_weights

# Least number of samples per node (half vector), on average, at which folding saves time
SAMPLES_PER_NODE = 20
# Number of samples per node from which one matrix product for each node is fastest
LONG_NODE = 1000


def fold_problem(problem: Problem) -> FoldedProblem | None:
    """Return the `FoldedProblem` of a problem, or None if folding is impossible or too slow."""
    single = len(problem.groups) == 1  # folded sums are for all channels at once
    if not (problem.linear and single and double_precision.has_derivatives()):
        return None
    if problem.samples.cells is None:
        return None
    if not problem.columns.powers.all():  # sums with lobes without a weight are not made
        return None
    pairs = _depends_on_cos_d(problem)
    if pairs is None:
        return None
    if not problem.columns.slopes:  # all lobes stay the same, so one node is enough
        starts: Any = np.zeros(1, int)
    elif pairs:
        starts = np.flatnonzero(np.diff(problem.samples.cells[1], prepend=-1))
    else:
        starts = problem.samples.half_vector_starts
    few = len(starts) * SAMPLES_PER_NODE <= len(problem.samples.wi)
    return FoldedProblem(problem, starts) if few else None


def _depends_on_cos_d(problem: Problem) -> bool | None:
    """Return whether the factors S of the lobes depend on cosθ_d, not only on the half vector.

    Return None if the problem cannot be folded, because a factor A, or a lobe that is no product,
    depends on a shape parameter. S, A and θ_d are explained at the head of the file.
    """
    space, up = problem.space, double_precision.to_vector(np.array([[0.0, 0.0, 1.0]]))
    shapes = [
        double_precision.to_scalar(x)
        for x in space.to_parameters(np.full((1, len(space.names)), 0.5))[0]
    ]
    cos_d = double_precision.to_scalar(1.0)
    fixed = problem.columns.make_model(shapes).lobes()
    dr.enable_grad(cos_d)
    depends = any(dr.grad_enabled(l.factors[0](up, cos_d)) for l in fixed if l.factors)
    for shape in shapes:
        dr.enable_grad(shape)
    for lobe in problem.columns.make_model(shapes).lobes():
        constant = lobe.factors[1] if lobe.factors else lobe.eval
        if dr.grad_enabled(constant(up, up)):
            return None
    return depends


class FoldedProblem:
    """The squared loss of a `Problem` as sums over nodes, groups of samples with one half vector.

    It has the methods of `Problem` that a search needs. `starts` (nodes,): index of the first
    sample of each node.
    """

    clamped = False

    def __init__(self, problem: Problem, starts: IntArray) -> None:
        self.problem, self.space, self.weight_limits = problem, problem.space, problem.weight_limits
        self.columns, self.channels = problem.columns, problem.channels
        self.wi, self.wo = (
            double_precision.to_vector(np.asarray(w)[starts])
            for w in (problem.samples.wi, problem.samples.wo)
        )
        lobes, channels = len(self.columns.lobes), self.channels
        sums, black = np.zeros((len(starts), lobes + channels, lobes + channels)), []
        for block in problem.blocks(1):
            inside = starts[(starts > block.rows.start) & (starts < block.rows.stop)]
            first = int(np.searchsorted(starts, block.rows.start, "right")) - 1
            edges = np.concatenate([[block.rows.start], inside]) - block.rows.start
            constants = self._evaluate_constants(block)
            sums[first : first + len(edges)] += _sum_products_by_node(constants, edges)
            black.append(np.square(constants[lobes:]).sum(axis=0))
        problem.black_squares = np.concatenate(black)  # a by-product, which it need not compute
        by_node = sums.transpose(1, 2, 0)
        values = [*range(lobes), *(value for value, _ in self.columns.slopes)]
        self.grams = by_node[np.ix_(values, values)]
        self.moments = by_node[np.ix_(values, range(lobes, lobes + channels))]
        self.squares = float(np.trace(by_node[lobes:, lobes:].sum(axis=2)))

    def _evaluate_constants(self, block: Block) -> FloatArray:
        """Return the parts of the sums that do not change in a fit, (lobes + channels, n).

        The rows are √w κ A for each lobe and -√w κ R for each channel, at the n samples of a block,
        with weights w, the slope κ of the loss, constant factors A of lobes and measured values R.
        """
        columns = self.columns
        middle = self.space.to_parameters(np.full((1, len(self.space.names)), 0.5))[0]
        lobes = columns.make_model([double_precision.to_scalar(x) for x in middle]).lobes()
        root, constants, differences = dr.sqrt(block.importance), [], []
        for c in range(self.channels):
            difference, kappa = self.problem.evaluate_difference(block, 0.0, c)
            differences.append(root * difference)
        for lobe in lobes:
            constant = lobe.factors[1] if lobe.factors else lobe.eval
            constants.append(root * kappa * constant(block.wi, block.wo))
        dr.eval(constants, differences)
        return np.stack([np.asarray(array) for array in constants + differences])

    def estimate_weights(self, u: FloatArray) -> FloatArray:
        """Return the weights (points, channels, lobes) with the least loss at coordinates `u`."""
        return solve_weights(self.columns, self._sum_over_nodes(u), self.weight_limits)

    def expand_loss(self, u: FloatArray, weights: FloatArray, curvature: bool = True) -> Expansion:
        """Return the `Expansion` about coordinates `u` and the weights that are best for them.

        `weights` and `curvature` have no effect; `Problem.expand_loss` needs them.
        """
        sums = self._sum_over_nodes(u)
        weights = solve_weights(self.columns, sums, self.weight_limits)
        sums = move_sums_to_weights(self.columns, sums, weights)
        return Expansion.from_sums(self.columns, self.space, sums, u, weights)

    def expand_at_weights(
        self, u: FloatArray, weights: FloatArray, curvature: bool = True
    ) -> Expansion:
        """Return the `Expansion` about coordinates `u` and these `weights`, with its Hessian.

        `curvature` has no effect; `Problem.expand_at_weights` needs it.
        """
        sums = move_sums_to_weights(self.columns, self._sum_over_nodes(u), weights)
        return Expansion.from_sums(self.columns, self.space, sums, u, weights)

    def _sum_over_nodes(self, u: FloatArray) -> Sums:
        """Return the `Sums` over all samples at coordinates `u` (points, shapes), weights 0."""
        points, nodes = len(u), len(self.wi.x)
        table = self.space.to_parameters(u)
        shapes = [double_precision.to_array(np.repeat(x, nodes)) for x in table.T]
        wi, wo = (
            double_precision.Vector(*(dr.tile(x, points) for x in (w.x, w.y, w.z)))
            for w in (self.wi, self.wo)
        )
        columns = self.columns.evaluate(
            shapes, wi, wo, factor=lambda lobe: _evaluate_shape_factor(lobe, wi, wo)
        )
        dr.eval(columns)
        T = np.stack([np.asarray(column).reshape(points, nodes) for column in columns], axis=1)
        gram = np.einsum("pai,pbi,abi->pab", T, T, self.grams)[:, None]
        moment = np.einsum("pai,aci->pca", T, self.moments)
        error = np.full(points, self.squares)
        gram = np.repeat(gram, self.channels, axis=1)
        return Sums(error, moment, gram)


def _evaluate_shape_factor(lobe: Lobe, wi: Vector, wo: Vector) -> JitFloat:
    """Return the factor S of a lobe, which contains its shape parameters, at directions (n,).

    A lobe that is no product has no shape parameters here; its factor is 1.
    """
    return lobe.factors[0](half_vector(wi, wo), cos_theta_d(wi, wo)) if lobe.factors else 1.0


def _sum_products_by_node(rows: FloatArray, edges: IntArray) -> FloatArray:
    """Return the products of all pairs of `rows` (k, n), summed over the samples of each node.

    `edges` (nodes,): index of the first sample of each node. The result is (nodes, k, k).
    """
    count, n = rows.shape
    if n > LONG_NODE * len(edges):
        parts = np.split(rows, edges[1:], axis=1)
        return np.stack([part @ part.T for part in parts])
    products = np.empty((len(edges), count, count))
    for a, first in enumerate(rows):
        for b, second in enumerate(rows[: a + 1]):
            products[:, a, b] = products[:, b, a] = np.add.reduceat(first * second, edges)
    return products
