"""Solves the equations of pixels for steps of their weights and normals, and for their covariances.

The channels only share the slopes of the normal. With the matrix M_c of a channel's weights, its
coupling B_c to the slopes, and the matrix N of the slopes, the weights are eliminated first: the
Schur complement S = N - Σ_c B_cᵀ M_c⁻¹ B_c has only two rows. Every pixel has its own system, so
the elimination is written out in arrays of Dr.Jit over all pixels.
"""

from __future__ import annotations

from typing import Any

import drjit as dr

from brdfkit.core.array_types import JitFloat
from brdfkit.core.jit.double_precision import choose_float_type
from brdfkit.inverse.photographs.objects.equations import Equations

# Added to a matrix, as a share of its diagonal, because undetermined weights make it singular
RIDGE, TINY = 1e-9, 1e-30
LONGEST_STEP = 0.3  # largest change of the normal in one step [radians]
BOUND_ROUNDS = 3  # how often weights that would be negative are set to 0, and the others adapted


def compute_step(
    equations: Equations, a: list[list[JitFloat]], damping: JitFloat
) -> tuple[list[list[JitFloat]], list[JitFloat]]:
    """Return new weights, which are not negative, and the slopes of a damped Gauss-Newton step.

    The diagonals of the matrices are multiplied by 1 + `damping` [Marquardt 1963].
    """
    mask: Any = dr.mask_t(choose_float_type())
    channels, lobes = range(len(a)), range(len(a[0]))
    at_zero: list[list[Any]] = [[mask(False) for _ in lobes] for _ in channels]
    new = a
    slopes: list[JitFloat] = []
    for _ in range(BOUND_ROUNDS):
        solved = [_eliminate_weights(equations, a, damping, at_zero, c) for c in channels]
        slopes = _solve_slopes(equations, a, damping, at_zero, solved)
        new = [
            [
                dr.select(
                    at_zero[c][k],
                    0,
                    a[c][k] - x[k][2] - x[k][0] * slopes[0] - x[k][1] * slopes[1],
                )
                for k in lobes
            ]
            for c, x in zip(channels, solved, strict=True)
        ]
        at_zero = [[at_zero[c][k] | (new[c][k] < 0) for k in lobes] for c in channels]
    length = dr.sqrt(slopes[0] * slopes[0] + slopes[1] * slopes[1])
    shorter = dr.minimum(1, LONGEST_STEP / dr.maximum(length, 1e-9))
    return [[dr.maximum(w, 0) for w in row] for row in new], [s * shorter for s in slopes]


def compute_variances(
    equations: Equations,
) -> tuple[list[list[JitFloat]], JitFloat]:
    """Return the variances of the weights and of the normal, for residuals of variance 1.

    They are the diagonal of the inverse of the whole matrix; that of the normal is the sum for both
    slopes.
    """
    channels, lobes = range(len(equations.coupling)), range(len(equations.coupling[0]))
    solved = []
    for c in channels:
        unit = [[1.0 if k == m else 0.0 for m in lobes] for k in lobes]
        columns = [[*equations.coupling[c][k], *unit[k]] for k in lobes]
        solved.append(_eliminate(_damp(equations.weight_matrix[c], 0), columns))
    s = list(equations.slope_matrix)
    for c in channels:
        for k in lobes:
            b, x = equations.coupling[c][k], solved[c][k]
            s = [s[0] - b[0] * x[0], s[1] - b[0] * x[1], s[2] - b[1] * x[1]]
    p, pq, q = s[0] + TINY, s[1], s[2] + TINY
    determinant = dr.maximum(p * q - pq * pq, TINY)
    inverse = q / determinant, -pq / determinant, p / determinant
    weights = [
        [
            solved[c][k][2 + k]
            + solved[c][k][0] * solved[c][k][0] * inverse[0]
            + 2 * solved[c][k][0] * solved[c][k][1] * inverse[1]
            + solved[c][k][1] * solved[c][k][1] * inverse[2]
            for k in lobes
        ]
        for c in channels
    ]
    return weights, inverse[0] + inverse[2]


def _eliminate_weights(
    equations: Equations,
    a: list[list[JitFloat]],
    damping: JitFloat,
    at_zero: list[list[Any]],
    c: int,
) -> list[list[JitFloat]]:
    """Return M⁻¹ (B, g) of a channel for each lobe: two columns for the slopes, one for a step.

    A weight that is at zero changes by its own negative, and the others adapt to that.
    """
    matrix = _damp(equations.weight_matrix[c], damping)
    lobes = range(len(matrix))
    columns = []
    for k in lobes:
        step = equations.weight_gradient[c][k]
        for m in lobes:
            if m != k:
                step = step - dr.select(at_zero[c][m], matrix[k][m] * a[c][m], 0)
        columns.append([*equations.coupling[c][k], step])
    for k in lobes:
        fixed = at_zero[c][k]
        columns[k] = [
            dr.select(fixed, value, column)
            for value, column in zip((0, 0, a[c][k]), columns[k], strict=True)
        ]
        for m in lobes:
            matrix[k][m] = dr.select(fixed, 1.0 if k == m else 0.0, matrix[k][m])
            if m != k:
                matrix[m][k] = dr.select(fixed, 0.0, matrix[m][k])
    return _eliminate(matrix, columns)


def _solve_slopes(
    equations: Equations,
    a: list[list[JitFloat]],
    damping: JitFloat,
    at_zero: list[list[Any]],
    solved: list[list[list[JitFloat]]],
) -> list[JitFloat]:
    """Return the slopes p and q of a step, from the Schur complement of the weights."""
    p, pq, q = equations.slope_matrix
    p, q = p * (1 + damping) + TINY, q * (1 + damping) + TINY
    g, h = equations.slope_gradient
    for c, columns in enumerate(solved):
        for k, x in enumerate(columns):
            fixed, b = at_zero[c][k], equations.coupling[c][k]
            g = g - dr.select(fixed, b[0] * a[c][k], b[0] * x[2])
            h = h - dr.select(fixed, b[1] * a[c][k], b[1] * x[2])
            p = p - dr.select(fixed, 0, b[0] * x[0])
            pq = pq - dr.select(fixed, 0, b[0] * x[1])
            q = q - dr.select(fixed, 0, b[1] * x[1])
    determinant = p * q - pq * pq
    determinant = dr.select(dr.abs(determinant) > TINY, determinant, 1)
    return [-(q * g - pq * h) / determinant, -(p * h - pq * g) / determinant]


def _damp(matrix: list[list[JitFloat]], damping: JitFloat | float) -> list[list[JitFloat]]:
    """Return a matrix whose diagonal is multiplied by 1 + `damping`, with a small ridge."""
    ridge = RIDGE * matrix[0][0] + TINY
    return [
        [value * (1 + damping) + ridge if k == m else value + 0 for m, value in enumerate(row)]
        for k, row in enumerate(matrix)
    ]


def _eliminate(matrix: list[list[JitFloat]], columns: list[list[Any]]) -> list[list[JitFloat]]:
    """Return M⁻¹ times some columns by Gauss's elimination; M is symmetric and positive."""
    size = range(len(matrix))
    matrix, columns = [list(row) for row in matrix], [list(row) for row in columns]
    for pivot in size:
        inverse = 1 / matrix[pivot][pivot]
        for row in size[pivot + 1 :]:
            factor = matrix[row][pivot] * inverse
            matrix[row] = [x - factor * y for x, y in zip(matrix[row], matrix[pivot], strict=True)]
            columns[row] = [
                x - factor * y for x, y in zip(columns[row], columns[pivot], strict=True)
            ]
    for row in reversed(size):
        for below in size[row + 1 :]:
            columns[row] = [
                x - matrix[row][below] * y
                for x, y in zip(columns[row], columns[below], strict=True)
            ]
        columns[row] = [x / matrix[row][row] for x in columns[row]]
    return columns
