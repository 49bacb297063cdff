"""Groups the parameters of a model by its lobes, which it finds by evaluating them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray
from brdfkit.lighting.filtering.scene_bsdfs import PAIRS
from brdfkit.model import Model, Parameter
from brdfkit.model.evaluation import compute_fixed_values, compute_lobe_values

SHARES = 0.35, 0.8  # places between the bounds of a parameter at which lobes are compared


@dataclass(frozen=True)
class Group:
    """Weights of lobes that depend on the same shape parameters, with these, by their names."""

    label: str
    weights: tuple[str, ...]
    shapes: tuple[str, ...]


def group_parameters(model: type[Model]) -> list[Group]:
    """Return the groups of a model's parameters, in the order of its weights.

    A shape parameter of lobes in several groups is in the one with the most shape parameters.
    """
    weights, affected = model.weights(), find_affected_lobes(model)
    sets = [frozenset(s for s, lobes in affected.items() if lobes[k]) for k in range(len(weights))]
    distinct = list(dict.fromkeys(sets))
    owner = {
        shape: max((s for s in distinct if shape in s), key=len, default=distinct[-1])
        for shape in affected
    }
    members = [[k for k, own in enumerate(sets) if own == shapes] for shapes in distinct]
    return [
        Group(
            label,
            tuple(weights[k] for k in lobes),
            tuple(shape for shape in affected if owner[shape] == shapes),
        )
        for label, lobes, shapes in zip(
            _label_groups(model, members), members, distinct, strict=True
        )
    ]


def _label_groups(model: type[Model], members: list[list[int]]) -> list[str]:
    """Return a label for each group of lobes, given by their indices."""
    lobes = model().lobes()
    if model.has_signed_weights():
        names = ["Terms" for _ in members]
    else:
        names = [
            "Base"
            if any(lobes[k].parts for k in group)
            else "Diffuse term"
            if all(lobes[k].diffuse for k in group)
            else "Highlight"
            for group in members
        ]
    counts = {name: names.count(name) for name in names}
    numbers = [names[: k + 1].count(name) for k, name in enumerate(names)]
    return [
        f"{name} {number}" if counts[name] > 1 else name
        for name, number in zip(names, numbers, strict=True)
    ]


def find_affected_lobes(model: type[Model]) -> dict[str, BoolArray]:
    """Return for each shape parameter the mask (lobes + 1,) of the lobes that depend on it.

    The last entry is for the lobes without a weight.
    """
    hashable: Any = model  # a type checker takes a class for its objects here
    return _compare_lobes(hashable)


@cache
def _compare_lobes(model: Any) -> dict[str, BoolArray]:
    """Do the work of `find_affected_lobes`, once for each model."""
    shapes = model.shapes(anisotropic=True)
    middle = {name: place_between_bounds(model.parameters[name], SHARES[0]) for name in shapes}
    before = _evaluate_lobes(model, middle)
    affected = {}
    for name in shapes:
        moved = place_between_bounds(model.parameters[name], SHARES[1])
        after = _evaluate_lobes(model, middle | {name: moved})
        affected[name] = np.abs(after - before).max(axis=0) > 1e-9 * np.abs(before).max(axis=0)
    return affected


def _evaluate_lobes(model: type[Model], shapes: dict[str, float]) -> AnyArray:
    """Return the values (n, lobes + 1) of all lobes, at last of those without a weight."""
    return evaluate_all_lobes(model(**shapes), *PAIRS)


def evaluate_all_lobes(model: Model, wi: AnyArray, wo: AnyArray) -> AnyArray:
    """Return the values (2n, lobes + 1) of all lobes at n pairs of directions.

    The first n rows belong to the weights, the others to their squares. The last column has the sum
    of the lobes without a weight.
    """
    values = np.concatenate(compute_lobe_values(model, wi, wo))
    fixed = np.zeros((len(values), 1))
    fixed[: len(wi)] = compute_fixed_values(model, wi, wo)
    return np.hstack([values, fixed])


def place_between_bounds(parameter: Parameter, share: float) -> float:
    """Return the value of a shape parameter a `share` of the way between its bounds."""
    low, high = parameter.bounds
    if parameter.log:
        return float(low * (high / low) ** share)
    return low + share * (high - low)
