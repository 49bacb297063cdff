"""Small pictures of any BRDF, which notebooks show beside its figures: a ball, and its lobes."""

from brdfkit.images.thumbnails.ball import ball_picture
from brdfkit.images.thumbnails.lobes import lobe_picture


def thumbnails(name, brdf):
    """The `Picture`s of a BRDF (wi, wo) → (n, 1 or 3), the material called `name`."""
    return ball_picture(name, brdf), lobe_picture(name, brdf)
