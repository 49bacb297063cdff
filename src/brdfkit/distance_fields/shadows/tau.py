"""τ: the lit share of a disc whose occluder has a straight edge, its inverse and its slope.

    τ(r) = 1/2 + (r √(1 - r²) + arcsin r) / π,    τ'(r) = 2/π √(1 - r²)

The edge lies at the distance r from the centre of the unit disc; it is negative where the centre
is in shadow. Below -1 nothing is lit, and above 1 all is.

[Bálint et al. 2019, section 4.1]
"""

import drjit as dr

# Bisections: 2⁻³⁹ is below what ten digits show. The lower end of the bracket is returned, so that
# the error bounds of the shadows hold for any number of them
DEPTH = 40


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


def tau_inverse(share, depth=DEPTH):
    """The r of a lit `share`, which is clamped to [0, 1], from below to 2¹⁻ᵈᵉᵖᵗʰ.

    By bisection: Newton's steps are divisions by 0 at both ends.
    """
    share = dr.clip(share, 0, 1)

    def halve(low, width):
        middle = low + width
        return dr.select(tau(middle) <= share, middle, low), width / 2

    zero = 0 * share
    low, _ = dr.while_loop((zero - 1, zero + 1), lambda low, width: width > 0.5**depth, halve)
    return low
