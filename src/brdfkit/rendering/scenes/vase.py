"""A vase with a foot, a belly and a flared lip, into which one sees a little."""

import numpy as np

from brdfkit.rendering.scenes._meshes import mesh_of_grid, revolve
from brdfkit.rendering.scenes._studio import studio

# Profile (r, z) of the vase, from the middle of its foot up the outside, and down the inside
PROFILE = np.array(
    [
        (0.0, 0.02),
        (0.25, 0.02),
        (0.42, 0.0),
        (0.47, 0.05),
        (0.44, 0.13),
        (0.52, 0.3),
        (0.72, 0.6),
        (0.82, 0.95),
        (0.74, 1.28),
        (0.5, 1.55),
        (0.365, 1.75),
        (0.38, 1.92),
        (0.5, 2.07),
        (0.56, 2.11),
        (0.56, 2.145),
        (0.5, 2.13),
        (0.37, 2.0),
        (0.31, 1.85),
        (0.31, 1.72),
        (0.45, 1.5),
        (0.68, 1.25),
        (0.75, 0.95),
        (0.65, 0.6),
        (0.44, 0.3),
        (0.2, 0.17),
        (0.0, 0.15),
    ]
)


def vase(bsdf, size=(512, 512)):
    """The scene's dictionary; see `brdfkit.rendering.scenes`.

    It is brushed around its axis, as on a potter's wheel.

    >>> vase({"type": "diffuse"})["vase"].class_name()    # doctest: +SKIP
    'Mesh'
    """
    return studio(size) | {"vase": mesh_of_grid(*revolve(*PROFILE.T, between=8), bsdf)}
