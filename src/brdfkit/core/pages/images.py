"""Pictures as addresses `data:`, which a page holds within itself, and colour scales."""

import io
from base64 import b64encode

import numpy as np

from brdfkit.core.colours import to_srgb


def encode_jpeg(linear):
    """The address of a picture (height, width, 3) of linear sRGB, to look at."""
    return _encode(_to_bytes(to_srgb(linear)), "JPEG", quality=92, subsampling=0)


def encode_webp(colours, **options):
    """The address of colours (height, width, 3) in 0..1, half as long as JPEG's or PNG's.

    options : of Pillow, as `quality`, or `lossless`.
    """
    return _encode(_to_bytes(colours), "WEBP", **options)


def halve(linear):
    """A picture (height, width, n) of half the size."""
    height, width = (n // 2 for n in linear.shape[:2])
    return linear[: 2 * height, : 2 * width].reshape(height, 2, width, 2, -1).mean(axis=(1, 3))


def shrink(picture, widest):
    """A picture (height, width, n), halved until no side is longer than `widest` pixels."""
    while max(picture.shape[:2]) > widest:
        picture = halve(picture)
    return picture


def encode_png(colours):
    """The address of colours (height, width, 3 or 4) in 0..1, pixel by pixel."""
    return _encode(_to_bytes(colours), "PNG", optimize=True)


def apply_colour_map(name, shares):
    """Colours (..., 4) of matplotlib's scale `name` for shares (...) of its length."""
    import matplotlib as mpl

    return mpl.colormaps[name](np.clip(shares, 0, 1))


def draw_colour_bar(name, steps=128):
    """The address of a scale from its low to its high end, one pixel high."""
    return encode_png(apply_colour_map(name, np.linspace(0, 1, steps))[None, :, :3])


def _to_bytes(shares):
    return (np.clip(np.nan_to_num(shares), 0, 1) * 255 + 0.5).astype(np.uint8)


def _encode(pixels, kind, **options):
    from PIL import Image

    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, kind, **options)
    return f"data:image/{kind.lower()};base64,{b64encode(stream.getvalue()).decode()}"
