"""Decides which errors are tied, by their differences in each block of directions."""

import math

import numpy as np

from brdfkit.core.array_types import AnyArray

# A model is tied with the best one if it is behind by at most this many standard errors: chance
# makes such a difference once in twenty times
TIED = 2.0
# Errors whose relative difference is smaller than this differ by rounding alone
EQUAL = 1e-9


def compare_with_best(
    errors: AnyArray, best: AnyArray, shares: AnyArray
) -> tuple[float, float, float]:
    """Return a model's E, its excess over the best model's E, and the excess's standard error.

    `errors` and `best` (blocks,) are what each block of directions adds to E² of the model and of
    the best model; `shares` (blocks,) say how much each block counts.
    """
    error, least = (math.sqrt(squares.sum()) for squares in (errors, best))
    noise = paired_standard_error(errors - best, shares)
    # `noise` belongs to the difference of E², which is (E + least) (E - least)
    return error, error - least, noise / (error + least) if noise else 0.0


def is_tied(error: float, behind: float, uncertainty: float) -> bool:
    """Return whether an E is no worse than the best one, within the noise."""
    return behind <= TIED * uncertainty + EQUAL * error


def paired_standard_error(differences: AnyArray, shares: AnyArray) -> float:
    """Return the standard error of the sum of `differences` (blocks,) of blocks with `shares`.

    It is 0 for a single block, which shows no noise.
    """
    count = len(differences)
    if count < 2:
        return 0.0
    apart = differences - differences.sum() * shares / shares.sum()
    return float(np.sqrt(count / (count - 1) * (apart**2).sum()))
