"""The function τ: the lit share of a disc whose occluder has a straight edge.

    τ(r) = 1/2 + (r √(1 - r²) + arcsin r) / π,    τ'(r) = 2/π √(1 - r²)

The edge is at the distance r from the centre of the unit disc; r is negative where the centre is in
shadow. Nothing is lit below r = -1, and all is above r = 1.

[Bálint et al. 2019, section 4.1]
"""

import drjit as dr

from brdfkit.core.array_types import JitFloat
from brdfkit.core.jit.gradients import replace_grad


def lit_disc_share(r: JitFloat) -> JitFloat:
    """Return τ(r), the lit share of the unit disc beside a straight edge at the distance r.

    Its derivative is finite everywhere.

    >>> lit_disc_share(0.25)
    0.6574811791308206
    """
    r = dr.clip(r, -1, 1)
    fixed = dr.detach(r)  # detached: the slopes of arcsin and of the root at ±1 are infinite
    share = 0.5 + (fixed * dr.sqrt(1 - fixed * fixed) + dr.asin(fixed)) / dr.pi
    return replace_grad(share, lit_disc_slope(fixed) * r) if dr.grad_enabled(r) else share


def lit_disc_slope(r: JitFloat) -> JitFloat:
    """Return the derivative of `lit_disc_share` by the edge's distance r, at most 2/π.

    >>> lit_disc_slope(1.0)
    0.0
    """
    return 2 / dr.pi * dr.safe_sqrt(1 - r * r)
