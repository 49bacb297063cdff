"""How steady a shadow is while the camera or the light moves: swimming and popping.

Points of the world keep their places. Where the light stands still their true shadow does not
change, and whatever the technique changes from picture to picture is its own fault; where the light
moves, the true change is taken off:

    flicker = mean over pictures k and points of |e_k - e_(k-1)|,    e_k = lit_k - true_k
"""

import numpy as np


def flicker(lit, true):
    """The mean change of the error from picture to picture, 0 at best.

    lit, true : shares of the light (pictures, points), by the technique and in truth.

    >>> flicker([[1, 0], [0, 0]], [[1, 1], [1, 1]])
    0.5
    """
    errors = np.asarray(lit, float) - np.asarray(true, float)
    return float(np.abs(np.diff(errors, axis=0)).mean())
