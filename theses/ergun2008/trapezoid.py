"""Computes the matrix N_T that maps a trapezoid to a square in eight steps [Ergun 2008, 2.2.2.4].

As printed, step 4 shears by x/2 and step 7 divides sums; both miss the square.
"""

import numpy as np

CORNERS = np.array(
    [(-0.8, -0.9), (0.7, -0.9), (0.3, 0.6), (-0.2, 0.6)]
)  # the points t_0 to t_3 of the thesis
SQUARE = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float)


def map_trapezoid_to_square(corners=CORNERS, shear_as_printed=False, centre_as_printed=False):
    """Return the matrix N_T (4, 4) for corners (4, 2): two of the base, two of the top.

    Two steps can be computed as they are printed.
    """
    t = np.column_stack([corners, np.zeros(4), np.ones(4)])
    total = make_shift(*-(t[2] + t[3])[:2] / 2)
    x, y = (t[2] - t[3])[:2] / np.linalg.norm(t[2] - t[3])
    total = make_matrix({(0, 0): x, (0, 1): y, (1, 0): y, (1, 1): -x}) @ total
    total = make_shift(*-(total @ find_apex(t))[:2]) @ total
    x, y = (total @ (t[2] + t[3]) / 2)[:2]
    total = make_matrix({(0, 1): -x / 2 if shear_as_printed else -x / y}) @ total
    x, y = (total @ t[2])[:2]
    total = np.diag([1 / x, 1 / y, 1, 1]) @ total
    total = make_matrix({(1, 3): 1, (3, 1): 1, (3, 3): 0}) @ total
    (_, y, _, w), (_, y_top, _, w_top) = total @ t[0], total @ t[2]
    middle = (y / w + y_top / w_top) / 2
    total = make_shift(0, -(y + y_top) / (w + w_top) if centre_as_printed else -middle) @ total
    _, y, _, w = total @ t[0]
    return np.diag([1, -w / y, 1, 1]) @ total


def make_matrix(values):
    """Return the identity (4, 4) with other entries, given by (row, column)."""
    matrix = np.eye(4)
    for place, value in values.items():
        matrix[place] = value
    return matrix


def make_shift(x, y):
    return make_matrix({(0, 3): x, (1, 3): y})


def find_apex(t):
    """Return the point where the sides of a trapezoid (4, 4) meet."""
    one, other = (t[3] - t[0])[:2], (t[2] - t[1])[:2]
    share = np.linalg.solve(np.column_stack([one, -other]), (t[1] - t[0])[:2])[0]
    return t[0] + share * (t[3] - t[0])
