"""τ: the lit share of a disc whose occluder has a straight edge, its inverse and its slope.

    τ(r) = 1/2 + (r √(1 - r²) + arcsin r) / π,    τ'(r) = 2/π √(1 - r²)

The edge lies at the distance r from the centre of the unit disc; it is negative where the centre
is in shadow. Below -1 nothing is lit, and above 1 all is.

[Bálint et al. 2019, section 4.1]
"""

import drjit as dr

STEPS = 4  # of Newton's method: errors below 1e-14, and of 1e-6 in single precision


def tau(r):
    """τ(r), 0 below -1 and 1 above 1; its derivative is finite everywhere.

    >>> tau(0.25)
    0.6574811791308206
    """
    r = dr.clip(r, -1, 1)
    fixed = dr.detach(r)  # arcsin and the root have infinite slopes at ±1, which cancel in τ'
    share = 0.5 + (fixed * dr.sqrt(1 - fixed * fixed) + dr.asin(fixed)) / dr.pi
    return dr.replace_grad(share, slope(fixed) * r) if dr.grad_enabled(r) else share


def slope(r):
    """τ'(r), at most 2/π.

    >>> slope(1.0)
    0.0
    """
    return 2 / dr.pi * dr.safe_sqrt(1 - r * r)


def tau_inverse(share):
    """The r of a lit `share`, which is clamped to [0, 1].

    The thesis bisects, because Newton's steps for τ are divisions by 0 at both ends. But with
    r = ±cos(y/2) it is y - sin y = π - π |2 share - 1|, convex in y ≥ 0: four Newton steps from the
    root of y³/6, which is exact at the ends, reach the last digit. Forty bisections made `base` 15
    times as slow as `linear`.

    >>> round(tau_inverse(0.75), 9)
    0.403972753
    """
    side = 2 * dr.clip(share, 0, 1) - 1
    c = dr.pi * (1 - dr.abs(side))
    y = dr.cbrt(6 * c)
    for _ in range(STEPS):
        sin, cos = dr.sincos(y)
        y = y - (y - sin - c) / dr.maximum(1 - cos, 1e-30)
    return dr.copysign(dr.cos(y / 2), side)
