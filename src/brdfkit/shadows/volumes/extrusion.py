"""Points moved away from a light, as homogeneous points: by a length, or to infinity.

At infinity a point V of a light L is (V L_w - L) with w = 0; of a light far away, -L for all points
[Ergun 2008, 2.1.7; w = 0 before the projection].
"""

import numpy as np


def extruded(points, light, length):
    """The points (n, 4) of `points` (n, 3), away from a `Light`.

    length : how far each is moved [unit of length]; 0: to infinity.
    """
    away = points * light.point[3] - light.point[:3]
    if not length:
        return np.column_stack([away, np.zeros(len(points))])
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    return finite(points + length * away)


def finite(points):
    """Points (n, 3) at a place, as (n, 4)."""
    return np.column_stack([points, np.ones(len(points))])
