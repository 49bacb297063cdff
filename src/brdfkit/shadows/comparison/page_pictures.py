"""The pictures of shadows on a page, small enough that a page of hundreds stays light."""

import numpy as np

from brdfkit.core.colours import to_srgb
from brdfkit.core.pages.images import apply_colour_map, encode_webp, shrink
from brdfkit.shadows.comparison.map_pictures import OUTSIDE

WIDEST = 320  # pixels of a picture on the page
QUALITY = 60  # of WebP
ERRORS = "RdBu_r"  # matplotlib's scale for light that is lost (blue) or gained (red)
STEPS = 8  # of errors, from none to all of the light: pictures of few colours are small
TINTS = "Set2"  # of maps, in turn
NOTHING = (0.16, 0.2, 0.3)  # where the light sees no surface


def small(picture):
    """A picture (height, width, n), halved until it is narrow enough."""
    return shrink(np.asarray(picture, float), WIDEST)


def draw_radiance(picture, white):
    """The address of a picture (height, width, 3), in which `white` is the brightest value."""
    return looked_at(small(picture / white))


def draw_errors(errors):
    """The address of the shares (height, width) of the light that are gained, or lost below 0."""
    shares = np.round(small(errors[..., None])[..., 0] * STEPS) / STEPS
    return encode_webp(apply_colour_map(ERRORS, (shares + 1) / 2)[..., :3], lossless=True)


def draw_texels(maps):
    """The address of a scene under the checker of its `MapPictures`; grey where there is no map."""
    tints = np.ones((OUTSIDE + 1, 3))
    tints[:OUTSIDE] = apply_colour_map(TINTS, np.arange(OUTSIDE) % 8 / 7.99)[:, :3] ** 2
    return looked_at(small(maps.shade[..., None] * tints[maps.part]))


def draw_depths(depths):
    """The address of what the light sees (side, side), 0 near to 1 far, near ones bright."""
    bright = (1 - 0.9 * depths.astype(float))[..., None] ** 2
    return looked_at(np.where(np.isnan(bright), NOTHING, bright))


def looked_at(linear):
    """The address of a picture (height, width, 3) of linear sRGB, which may lose a little."""
    return encode_webp(to_srgb(linear), quality=QUALITY)
