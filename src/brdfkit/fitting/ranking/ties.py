"""Decides which errors of models are tied, from their differences in each block of directions."""

import math

import numpy as np

from brdfkit.core.array_types import AnyArray

# A model is tied with the best one if their errors differ by at most this many standard errors:
# noise alone causes larger differences in one case of twenty
TIED = 2.0
# Errors with a smaller relative difference are equal up to rounding
EQUAL = 1e-9


def compare_with_best(
    errors: AnyArray, best: AnyArray, shares: AnyArray
) -> tuple[float, float, float]:
    """Return a model's error E, its excess over the best E, and the standard error of the excess.

    `errors` and `best` (blocks,) are the contributions of the blocks of directions to E² of the
    model and of the best model; `shares` (blocks,) are the weights of the blocks.
    """
    error, least = (math.sqrt(squares.sum()) for squares in (errors, best))
    noise = compute_paired_standard_error(errors - best, shares)
    # Divided by the sum of both errors, the standard error of E² - least² becomes that of E - least
    return error, error - least, noise / (error + least) if noise else 0.0


def is_tied(error: float, behind: float, uncertainty: float) -> bool:
    """Return whether a model is as good as the best one, within the noise.

    Its error E is larger by `behind`, with the standard error `uncertainty`.
    """
    return behind <= TIED * uncertainty + EQUAL * error


def compute_paired_standard_error(differences: AnyArray, shares: AnyArray) -> float:
    """Return the standard error of the sum of `differences` (blocks,) between two models.

    It is estimated from the spread over the blocks of directions, whose weights are `shares`
    (blocks,). It is 0 for a single block, which has no spread.
    """
    count = len(differences)
    if count < 2:
        return 0.0
    apart = differences - differences.sum() * shares / shares.sum()
    return float(np.sqrt(count / (count - 1) * (apart**2).sum()))
