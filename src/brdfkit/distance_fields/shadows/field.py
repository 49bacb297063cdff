"""What a field tells the shadows: its distance, its Lipschitz bound, and its convex pieces.

A field is a function of points, or a node with the method `distance(p)`, which may say `lipschitz`
and `is_convex`. One of the `kind` "union" that `is_sharp` has its pieces as `children`.
"""

from dataclasses import replace

import numpy as np

from brdfkit.distance_fields.boxes import join
from brdfkit.distance_fields.shapes.motions import Motion


def distance_of(field):
    """The function of points whose value is the distance."""
    return getattr(field, "distance", field)


def lipschitz_of(field):
    """How much the distance may change per unit of length: 1 of an exact one."""
    return float(getattr(field, "lipschitz", 1.0))


def pieces_of(field):
    """The fields whose minimum this one is: itself, or what a union holds, within unions and moved
    ones too."""
    if getattr(field, "kind", None) == "union" and field.is_sharp:
        return [piece for child in field.children for piece in pieces_of(child)]
    if isinstance(field, Motion):
        return [replace(field, child=piece) for piece in pieces_of(field.child)]
    return [field]


ENDLESS = -np.ones(3), np.ones(3)  # the box that stands for a field of nothing else


def sphere_about(field):
    """The middle (3,) and the radius of a sphere about what of a field is not endless, as a plane.

    >>> from brdfkit.distance_fields import plane, sphere
    >>> sphere_about(sphere(2).at(7, 0, 0) | plane())
    (array([7., 0., 0.]), 3.4641016151377544)
    """
    boxes = [piece.bounds() for piece in pieces_of(field)]
    boxes = [box for box in boxes if np.isfinite(box).all() and np.less(*box).all()]
    low, high = join(boxes or [ENDLESS])
    return (low + high) / 2, float(np.linalg.norm(high - low) / 2)
