"""The thumbnail of a material: a ball on no background."""

import io
from functools import partial

import numpy as np

from brdfkit.core.colours import to_srgb
from brdfkit.core.documents import Picture
from brdfkit.images.ball.ball import ball

SIDE = 92  # pixels


def ball_picture(name, brdf):
    """The `Picture` of a ball of a BRDF (wi, wo) → (n, 1 or 3), the material called `name`."""
    return Picture(partial(_draw, brdf), f"a ball of {name} under two softboxes", SIDE)


def _draw(brdf):
    """The PNG of the ball."""
    from PIL import Image

    linear, cover = ball(brdf, SIDE)
    rgb = np.broadcast_to(to_srgb(linear), (SIDE, SIDE, 3))
    pixels = np.dstack([rgb, cover]) * 255 + 0.5
    stream = io.BytesIO()
    Image.fromarray(pixels.astype(np.uint8)).save(stream, "PNG")
    return stream.getvalue()
