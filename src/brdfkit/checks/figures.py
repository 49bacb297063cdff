"""Figures of the checks."""

import numpy as np


def larger(a, b):
    """The larger of two figures, NaN if one is NaN: what is not a number must not pass as small."""
    return float(np.maximum(a, b))
