"""A vase with a foot, a belly and a flared lip, whose inside shows a little."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import MitsubaObject
from brdfkit.rendering.scenes._meshes import make_grid_mesh, revolve_profile
from brdfkit.rendering.scenes._studio import make_studio

# (radius, height) of points of the profile: from the foot's middle up the outside, down the inside
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


def vase(
    bsdf: dict[str, Any] | MitsubaObject, size: tuple[int, int] = (512, 512)
) -> dict[str, Any]:
    """Return the dictionary of a scene that shows the material `bsdf` on a vase.

    An anisotropic material is brushed around the vase's axis, as on a potter's wheel.

    >>> vase({"type": "diffuse"})["vase"].class_name()    # doctest: +SKIP
    'Mesh'
    """
    return make_studio(size) | {
        "vase": make_grid_mesh(*revolve_profile(PROFILE[:, 0], PROFILE[:, 1], between=8), bsdf)
    }
