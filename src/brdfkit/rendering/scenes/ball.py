"""A ball on grey ground, under a clear sky and one softbox."""

from brdfkit.rendering.scenes._studio import BALL, studio


def ball(bsdf, size=(512, 512), spp=64):
    """The scene's dictionary; see `brdfkit.rendering.scenes`. `spp`: samples per pixel.

    The ball's parametrisation has z as its axis, so that an anisotropic material is brushed along
    the ball's parallels.

    >>> ball({"type": "diffuse"})["type"]
    'scene'
    """
    shape = {"type": "sphere", "center": list(BALL), "radius": 1.0, "bsdf": bsdf}
    return studio(size, spp) | {"ball": shape}
