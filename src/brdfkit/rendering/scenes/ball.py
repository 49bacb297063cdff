"""A ball on grey ground, under a clear sky and one softbox."""

from typing import Any

from brdfkit.core.array_types import MitsubaObject
from brdfkit.rendering.scenes._studio import BALL, make_studio


def ball(
    bsdf: dict[str, Any] | MitsubaObject, size: tuple[int, int] = (512, 512), spp: int = 64
) -> dict[str, Any]:
    """Return the dictionary of a scene that shows the material `bsdf` on a ball.

    `spp` is the number of samples per pixel. The axis of the ball's parametrisation is z, so an
    anisotropic material is brushed along the ball's parallels.

    >>> ball({"type": "diffuse"})["type"]
    'scene'
    """
    shape = {"type": "sphere", "center": list(BALL), "radius": 1.0, "bsdf": bsdf}
    return make_studio(size, spp) | {"ball": shape}
