"""Functions of Dr.Jit values that stay accurate in single precision, for narrow lobes."""

import drjit as dr

from brdfkit.core.array_types import JitFloat


def cosine_power(complement: JitFloat, exponent: JitFloat) -> JitFloat:
    """Return cosine^exponent from `complement` = 1 - cosine, accurate for large exponents.

    The result is 0 where the cosine is not positive.
    """
    power = dr.exp(exponent * log1p(-dr.minimum(complement, 1 - 1e-6)))
    return dr.select(complement < 1, power, 0)


def log1p(x: JitFloat) -> JitFloat:
    """Return log(1 + x), accurate for small x, by W. Kahan's method."""
    y = 1 + x
    return dr.select(y == 1, x, dr.log(y) * x / dr.select(y == 1, 1, y - 1))


def expm1(x: JitFloat) -> JitFloat:
    """Return exp(x) - 1, accurate for small x, by W. Kahan's method."""
    y = dr.exp(dr.maximum(x, -50))
    log_y = dr.log(y)
    return dr.select(y == 1, x, (y - 1) * dr.maximum(x, -50) / dr.select(y == 1, 1, log_y))
