"""Square windows of texels about a point, for filters that compare first and average then."""

import drjit as dr

from brdfkit.host.declared import count

WIDTH = count(3, (1, 15), "texels along a side of the window")


def mean_lit(texels, point, width, weights):
    """The mean of what the texels of a window say of a `MapPoint`: Σ_ij w_i w_j [z ≤ f_ij].

    texels : the `Texels` of a map.
    width : texels along a side.
    weights : of the `width` columns and rows; a function of where, from 0 to 1, the window begins
        within its first texel.
    """
    begin_u, begin_v = point.u - (width - 1) / 2, point.v - (width - 1) / 2
    across, upwards = weights(begin_u - dr.floor(begin_u)), weights(begin_v - dr.floor(begin_v))
    return sum(
        upwards[j]
        * sum(across[i] * texels.lit(point, begin_u + i, begin_v + j) for i in range(width))
        for j in range(width)
    )
