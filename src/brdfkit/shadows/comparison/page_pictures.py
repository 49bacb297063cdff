"""The pictures of shadows on a page, so small that a page of hundreds of them loads quickly."""

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.colours import to_srgb
from brdfkit.core.pages.images import apply_colour_map, encode_webp, shrink
from brdfkit.shadows.comparison.map_pictures import OUTSIDE, MapPictures

MAX_WIDTH = 320  # pixels of a picture on the page
QUALITY = 60  # of WebP pictures, from 0 to 100
ERROR_SCALE = "RdBu_r"  # matplotlib's colours for light that is lost (blue) or gained (red)
ERROR_STEPS = 8  # from none to all of the light; few colours make small files
TINTS = "Set2"  # matplotlib's colours of maps, in turn
NO_SURFACE = (0.16, 0.2, 0.3)  # the colour where the light sees nothing


def shrink_for_page(picture: AnyArray) -> FloatArray:
    """Return a picture (height, width, n), halved until it is narrow enough."""
    return shrink(np.asarray(picture, float), MAX_WIDTH)


def draw_radiance(picture: FloatArray, white: float) -> Any:
    """Draw a picture (height, width, 3) with the brightest value `white`; return a data URL."""
    return to_url(shrink_for_page(picture / white))


def draw_errors(errors: FloatArray) -> Any:
    """Draw errors (height, width), light gained or (negative) lost, and return a data URL."""
    shares = np.round(shrink_for_page(errors[..., None])[..., 0] * ERROR_STEPS) / ERROR_STEPS
    return encode_webp(apply_colour_map(ERROR_SCALE, (shares + 1) / 2)[..., :3], lossless=True)


def draw_texels(maps: MapPictures) -> Any:
    """Draw a scene with the checker of its maps, grey without a map, and return a data URL."""
    tints = np.ones((OUTSIDE + 1, 3))
    tints[:OUTSIDE] = apply_colour_map(TINTS, np.arange(OUTSIDE) % 8 / 7.99)[:, :3] ** 2
    return to_url(shrink_for_page(maps.shade[..., None] * tints[maps.part]))


def draw_depths(depths: FloatArray) -> Any:
    """Draw depths (side, side), 0 near and bright to 1 far, and return a data URL."""
    bright = (1 - 0.9 * depths.astype(float))[..., None] ** 2
    return to_url(np.where(np.isnan(bright), NO_SURFACE, bright))


def to_url(linear: FloatArray) -> Any:
    """Compress a picture (height, width, 3) of linear sRGB, with loss, to a data URL."""
    return encode_webp(to_srgb(linear), quality=QUALITY)
