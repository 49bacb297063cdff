"""What a bias does wrong, as shares of a picture: too small, acne; too large, peter-panning.

Pictures are arrays (height, width): `found`, the share of the light, in [0, 1], that a shadow map
lets through; `lit`, whether a ray to the light is free; `facing`, whether the surface looks towards
the light.
"""

import numpy as np


def acne(found, lit, facing, margin):
    """The share of light that lit pixels lack, away from shadows [Ergun 2008, 3.1.2].

    margin : pixels from the next shadow within which borders are blurred, which is no acne.
    """
    from scipy.ndimage import binary_dilation

    square = np.ones((3, 3), bool)
    near = binary_dilation(facing & ~lit, square, margin) if margin else facing & ~lit
    return _mean(1 - found, facing & lit & ~near)


def peter_panning(found, lit, facing, gap, contact):
    """The share of light that pixels in a shadow have, next to what casts it.

    gap : (height, width), from each pixel to its occluder along the ray of light.
    contact : the largest gap that is looked at.
    """
    return _mean(found, facing & ~lit & (gap <= contact))


def _mean(values, where):
    """0 where there are none."""
    return float(values[where].mean()) if where.any() else 0.0
