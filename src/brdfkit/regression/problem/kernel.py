"""Evaluates a model and a loss at the samples of a block, by a kernel that is recorded once.

A search evaluates the same formula dozens of times, and a program fits one model to many materials.
The formula is traced in the first of these evaluations only (`core/jit/recording.py`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import Vector
from brdfkit.core.jit.recording import Recorded
from brdfkit.model import Model
from brdfkit.model.evaluation import is_own
from brdfkit.regression.losses.loss import Loss
from brdfkit.regression.problem.blocks import Block
from brdfkit.regression.problem.columns import Columns

Terms = tuple[list[JitFloat], list[JitFloat], list[JitFloat]]


def can_record(model: type[Model], loss: Loss) -> bool:
    """Return whether the formulas of a model and a loss are brdfkit's own, and can be recorded.

    A user's formula may convert NumPy arrays, and Dr.Jit would end the process.
    """
    own = str(loss.difference.__module__).startswith("brdfkit.") and is_own(model)
    return own and double_precision.has_derivatives()


def compute_terms(
    block: Block,
    values: Iterable[JitFloat],
    channels: Iterable[int],
    *,
    clamped: bool,
    extended: bool,
    curvature: bool,
    factors: list[JitFloat] | None,
) -> Terms:
    """Return w d², w d d' and w d'² at the samples of a block, each a list by channel.

    w is the weight of a sample, d the difference of the loss, d' its derivative. `values`: values
    of the model in some `channels`; `clamped`, `extended`: as in `Block.evaluate_difference`;
    `curvature`: whether w d'² is needed; if it is equal in all channels, the list has one array;
    `factors`: None, or factors of w for each channel of the block.
    """
    squares, moments, grams = [], [], []
    for c, value in zip(channels, values, strict=True):
        difference, slope = block.evaluate_difference(value, c, clamped, extended)
        weight = block.importance if factors is None else block.importance * factors[c]
        squares.append(weight * dr.square(difference))
        moments.append(weight * difference * slope)
        grams.append(weight * slope * slope)
    if not curvature:
        return squares, moments, []
    return squares, moments, grams[:1] if shares_curvature(block, factors) else grams


def shares_curvature(block: Block, factors: list[JitFloat] | None) -> bool:
    """Return whether w d'² is equal in all channels: d' does not depend on the model's value."""
    return bool(block.loss.linear) and factors is None


def mix_columns(columns: list[JitFloat], factors: list[JitFloat]) -> list[JitFloat]:
    """Return the values of the model, an array for each channel.

    `factors`: factors of the columns that are values of lobes, for one channel after the other.
    """
    count = len(columns)
    return [
        sum(f * column for f, column in zip(factors[k : k + count], columns, strict=True))
        for k in range(0, len(factors), count)
    ]


def evaluate_recorded(
    block: Block,
    columns: Columns,
    table: FloatArray,
    weights: FloatArray,
    *,
    constant: list[JitFloat],
    factors: list[JitFloat] | None,
    **how: bool,
) -> tuple[list[JitFloat], JitFloat, list[JitFloat], list[JitFloat]]:
    """Return the `columns` of a model, and sums and lists of the terms of `compute_terms`.

    The results are (columns, w d² summed over channels, w d d', w d'²). `table`: values of the
    shape parameters at each point (points, shapes); `weights`: factors of the columns that are
    values, (points, channels · values); `constant`: the columns if they are known, otherwise empty;
    `factors`, `how`: arguments of `compute_terms`.
    """
    fixed = sorted(columns.fixed)
    constants = np.array([*map(columns.fixed.get, fixed), 0.0])
    # One array with a row of numbers for each point, which a kernel reads by the index of the point
    parameters = np.hstack([table, weights, np.tile(constants, (len(table), 1))])
    key: Any = columns.model
    recorded = _record_evaluation(
        key, columns.names, tuple(fixed), block.loss, len(block.measured), **how
    )
    columns_, total, moments, grams = recorded(
        [block.wi.x, block.wi.y, block.wi.z, block.wo.x, block.wo.y, block.wo.z],
        block.measured,
        block.importance,
        block.point,
        double_precision.to_array(parameters.ravel()),
        constant,
        factors or [],
    )
    return columns_, total, moments, grams


@lru_cache(maxsize=64)
def _record_evaluation(
    model: Any,
    names: tuple[str, ...],
    fixed_names: tuple[str, ...],
    loss: Loss,
    channels: int,
    **how: bool,
) -> Recorded:
    """Return the recorded function of `evaluate_recorded`, of Dr.Jit arrays alone."""
    columns = Columns.for_model(model, names, dict.fromkeys(fixed_names, 0.0))
    shapes, values = len(names), len(columns.lobes)

    def evaluate(
        directions: list[JitFloat],
        measured: list[JitFloat],
        importance: JitFloat,
        point: JitFloat,
        parameters: JitFloat,
        constant: list[JitFloat],
        factors: list[JitFloat],
    ) -> list[Any]:
        wi, wo = Vector(*directions[:3]), Vector(*directions[3:])
        block = Block(loss, slice(0), 1, wi, wo, measured, importance, point)
        numbers = block.gather_by_point(
            parameters, shapes + channels * values + len(fixed_names) + 1
        )
        fixed = dict(zip(fixed_names, numbers[-1 - len(fixed_names) : -1], strict=True))
        arrays = constant
        if not constant:
            evaluated = replace(columns, fixed=fixed).evaluate(numbers[:shapes], wi, wo)
            # A column may be one number; with these zeros its size is the number of samples
            arrays = [column + numbers[-1] * wi.z for column in evaluated]
        weights = numbers[shapes : shapes + channels * values]
        squares, moments, grams = compute_terms(
            block,
            mix_columns(arrays[:values], weights),
            range(channels),
            factors=factors or None,
            **how,
        )
        return [[] if constant else arrays, sum(squares), moments, grams]

    return Recorded(evaluate, is_safe=True)
