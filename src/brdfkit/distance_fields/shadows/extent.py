"""How large a field is, and where: a sphere about all of it that is not endless."""

import numpy as np

from brdfkit.distance_fields.boxes import join
from brdfkit.distance_fields.shadows.field import pieces_of

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
