"""How far a receiver is moved towards the light before the test, lest it shadow itself.

The light sees a surface at the centres of texels, the camera between them: without a bias half of
a slanted surface is behind what the light saw (acne). Too large a bias loses shadows where they
begin (peter-panning) [Ergun 2008, 3.1.2].
"""

from dataclasses import dataclass


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
