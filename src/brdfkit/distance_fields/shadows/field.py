"""The properties of a field that shadows need: its distance, its bound L, its convex pieces.

A field is a function of points, or a node with a method `distance(p)`, and perhaps `lipschitz` and
`is_convex`. A node whose `kind` is "union" and that `is_sharp` has its pieces as `children`.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.distance_fields.boxes import join_boxes
from brdfkit.distance_fields.shapes.motions import Motion

UNIT_BOX = -np.ones(3), np.ones(3)  # used for fields that have no bounded parts


def distance_function(field: Any) -> Callable[[Any], Any]:
    """Return the function from points to distances of a field, which may be the field itself."""
    distance: Callable[[Any], Any] = getattr(field, "distance", field)
    return distance


def lipschitz_bound(field: Any) -> float:
    """Return the upper bound on the slope of a field; 1 for a field that states none."""
    return float(getattr(field, "lipschitz", 1.0))


def split_into_pieces(field: Any) -> list[Any]:
    """Return fields whose minimum is `field`: the parts of a sharp union, else the field itself.

    Unions within unions, and moved unions, are taken apart, too.
    """
    if getattr(field, "kind", None) == "union" and field.is_sharp:
        return [piece for child in field.children for piece in split_into_pieces(child)]
    if isinstance(field, Motion):
        moved: Any = field
        return [replace(moved, child=piece) for piece in split_into_pieces(field.child)]
    return [field]


def bounding_sphere(field: Any) -> tuple[FloatArray, float]:
    """Return the centre (3,) and radius of a sphere around the bounded parts of a field.

    >>> from brdfkit.distance_fields import plane, sphere
    >>> bounding_sphere(sphere(2).at(7, 0, 0) | plane())
    (array([7., 0., 0.]), 3.4641016151377544)
    """
    boxes = [piece.bounds() for piece in split_into_pieces(field)]
    boxes = [box for box in boxes if np.isfinite(box).all() and np.less(*box).all()]
    low, high = join_boxes(boxes or [UNIT_BOX])
    return (low + high) / 2, float(np.linalg.norm(high - low) / 2)
