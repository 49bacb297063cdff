"""Draws quasi-random points, the scrambled sequences of Halton and Sobol'.

The points are the same as those of `scipy.stats.qmc` in SciPy 1.17. They are computed here because
importing that package takes as much processor time as a whole fit.
"""

from math import ceil, log2

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray

BITS = 30  # binary digits of the coordinates of Sobol' points
# For each dimension of Sobol' points after the first, as S. Joe and F. Y. Kuo published them in
# 2008: the inner coefficients of a primitive polynomial, and its first direction numbers m
POLYNOMIALS: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...] = (
    ((), (1,)),
    ((1,), (1, 3)),
    ((0, 1), (1, 3, 1)),
)


def draw_halton_points(
    count: int, dimensions: int, rng: np.random.Generator | int | None
) -> FloatArray:
    """Return the first points (count, dimensions) of a Halton sequence in the unit cube.

    `rng`, a generator or its seed, scrambles the digits of each coordinate by permutations, as A.
    B. Owen described in 2017. With None, nothing is scrambled, and the first point is 0.

    >>> draw_halton_points(3, 2, None)
    array([[0.        , 0.        ],
           [0.5       , 0.33333333],
           [0.25      , 0.66666667]])
    """
    own = None if rng is None else np.random.default_rng(rng).spawn(1)[0]
    bases = _find_primes(dimensions)
    return np.stack([_mirror_digits(count, base, own) for base in bases], axis=1)


def _mirror_digits(count: int, base: int, rng: np.random.Generator | None) -> FloatArray:
    """Return 0 to `count` - 1 with the digits mirrored at the point, and permuted by `rng`."""
    number, place, mirrored = np.arange(count), 1 / base, np.zeros(count)
    # Permuted zeros do not end, so there are as many digits as double precision holds
    for _ in range(ceil(54 / log2(base)) - 1):
        digits = np.arange(base)
        if rng is not None:
            rng.shuffle(digits)
        mirrored += digits[number % base] * place
        number, place = number // base, place / base
    return mirrored


def _find_primes(count: int) -> list[int]:
    """Return the first `count` prime numbers.

    >>> _find_primes(5)
    [2, 3, 5, 7, 11]
    """
    primes: list[int] = []
    number = 2
    while len(primes) < count:
        if all(number % prime for prime in primes):
            primes.append(number)
        number += 1
    return primes


def draw_sobol_points(power: int, dimensions: int, seed: int) -> FloatArray:
    """Return the first 2^power points of a Sobol' sequence in the unit cube of up to 4 dimensions.

    The result has the shape (2^power, dimensions). The digits are scrambled by random triangular
    matrices and a random shift, as J. Matoušek described in 1998.

    >>> draw_sobol_points(10, 3, seed=0).mean(axis=0).round(3)
    array([0.5, 0.5, 0.5])
    """
    rng = np.random.default_rng(seed).spawn(1)[0]
    shifts = rng.integers(2, size=(dimensions, BITS), dtype=np.uint32)
    matrices = np.tril(rng.integers(2, size=(dimensions, BITS, BITS), dtype=np.uint32), -1)
    matrices += np.eye(BITS, dtype=np.uint32)
    columns = []
    for k, (shift, matrix) in enumerate(zip(shifts, matrices, strict=True)):
        directions = _join_bits(_split_bits(_compute_direction_numbers(k)) @ matrix.T % 2)
        # In the order of Gray's code, the next 2^j points are the first ones in reverse order, with
        # one more direction number added
        points = _join_bits(shift[None, ::-1])
        for direction in directions[:power]:
            points = np.concatenate([points, points[::-1] ^ direction])
        columns.append(points)
    return np.stack(columns, axis=1) * 2.0**-BITS


def _compute_direction_numbers(dimension: int) -> IntArray:
    """Return the direction numbers (BITS,) of a dimension, whose first binary digit is 2^-1."""
    inner, numbers = POLYNOMIALS[dimension - 1] if dimension else ((), (1,) * BITS)
    m, degree = list(numbers), len(numbers)
    while len(m) < BITS:
        terms = [2**k * m[-k] for k, a in enumerate(inner, 1) if a]
        m.append(np.bitwise_xor.reduce([m[-degree], 2**degree * m[-degree], *terms]))
    return np.array([number << (BITS - 1 - j) for j, number in enumerate(m)])


def _split_bits(numbers: IntArray) -> IntArray:
    """Return the binary digits (n, BITS) of whole numbers (n,), the largest one first."""
    return numbers[:, None] >> np.arange(BITS - 1, -1, -1) & 1


def _join_bits(bits: IntArray) -> IntArray:
    """Return the whole numbers (n,) with these binary digits (n, BITS), the largest one first."""
    return bits @ (1 << np.arange(BITS - 1, -1, -1))
