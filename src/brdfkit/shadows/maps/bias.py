"""How far a receiver is moved towards the light before the test, lest it shadow itself.

The light sees a surface at the centres of texels, the camera between them: without a bias half of
a slanted surface is behind what the light saw (acne). Too large a bias loses shadows where they
begin (peter-panning) [Ergun 2008, 3.1.2].
"""

from dataclasses import dataclass

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


@dataclass(frozen=True)
class Bias:
    """Ways to move a receiver, which add up.

    constant : towards the light, over the reach of the light through the scene, in [0, 1].
    slope : towards the light, in steps of depth between neighbouring texels of the surface's plane.
    normal_offset : along the normal, in texels.
    plane : whether each texel is compared with the depth of the surface's plane in its centre; a
        flat surface then needs no other bias.
    """

    constant: float = 0.0
    slope: float = 0.0
    normal_offset: float = 0.0
    plane: bool = False


AUTOMATIC = Bias(constant=5e-4, plane=True)
