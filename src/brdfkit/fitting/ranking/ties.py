"""Which errors cannot be told apart: differences block by block, and the noise of their sum."""

import math

import numpy as np

# A model is tied with the best where it is behind by at most so many standard errors: so large a
# difference comes about by chance once in twenty times
TIED = 2.0
# Errors that differ by less, as shares of them, differ by rounding
EQUAL = 1e-9


def beside(errors, best, shares):
    """A model's E, by how much it is above the best model's, and the standard error of that.

    `errors`, `best` (blocks,): what each block of directions adds to the E² of each; `shares`
    (blocks,): how much each block counts.
    """
    error, least = (math.sqrt(squares.sum()) for squares in (errors, best))
    noise = paired_standard_error(errors - best, shares)
    # Of E², whose difference is (E + least) (E - least)
    return error, error - least, noise / (error + least) if noise else 0.0


def is_tied(error, behind, uncertainty):
    """Whether an E is no worse than the best one, within the noise; see `beside`."""
    return behind <= TIED * uncertainty + EQUAL * error


def paired_standard_error(differences, shares):
    """The standard error of the sum of `differences` (blocks,), of blocks with these `shares`; 0 of
    one block, which tells nothing of noise."""
    count = len(differences)
    if count < 2:
        return 0.0
    apart = differences - differences.sum() * shares / shares.sum()
    return float(np.sqrt(count / (count - 1) * (apart**2).sum()))
