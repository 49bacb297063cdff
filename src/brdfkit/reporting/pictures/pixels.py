"""The pictures as numbers for the page's script: linear light, which an exposure can scale.

A number is 16 bits: its binary logarithm in steps of 1/128, 0.5 %. Neighbours are alike, so that
their differences are small and shrink well. Not PNGs: what a canvas reads of them a browser may
convert for its screen, or change a little so that nobody knows it again by them.
"""

import zlib
from base64 import b64encode

import numpy as np

from brdfkit.core.pages.images import apply_colour_map

DARKEST = -12  # the binary logarithm of the least light above 0
STEPS = 128  # per doubling
LAST = 4095  # the highest code, of the light 2^20
SCALE = "magma"  # of colour differences
MOST = 10  # ΔE of its bright end
HIGHEST = 100  # ΔE that a byte can say


def for_script(names, pictures, differences):
    """What the script needs of pictures (height, width, 3), the measured first, by their names, and
    of the colour differences ΔE (height, width) of the others to it."""
    height, width = pictures[0].shape[:2]
    palette = np.round(apply_colour_map(SCALE, np.linspace(0, 1, 256))[:, :3] * 255).astype(
        np.uint8
    )
    return {
        "width": width,
        "height": height,
        "darkest": DARKEST,
        "steps": STEPS,
        "most": MOST,
        "highest": HIGHEST,
        "palette": b64encode(palette.tobytes()).decode(),
        "names": names,
        "pictures": [_pack(encode(picture)) for picture in pictures],
        "differences": [_pack(encode_difference(d)) for d in differences],
    }


def encode(linear):
    """The codes (3, height, width) of a picture (height, width, 3): 0 is black, and k else
    2^(DARKEST + k / STEPS)."""
    with np.errstate(divide="ignore"):
        doublings = np.log2(np.maximum(np.nan_to_num(linear), 0)) - DARKEST
    codes = np.clip(np.round(doublings * STEPS), 0, LAST).astype(np.uint16)
    return np.moveaxis(codes, -1, 0)


def encode_difference(difference):
    """The codes (height, width) of differences ΔE: HIGHEST (k / 255)², finest where they are
    small."""
    share = np.clip(np.nan_to_num(difference) / HIGHEST, 0, 1)
    return np.round(np.sqrt(share) * 255).astype(np.uint16)


def _pack(codes):
    """Codes as text: each less the one before it, all low bytes, then all high ones, deflated."""
    steps = np.diff(codes.ravel(), prepend=np.uint16(0))
    split = np.stack([steps & 255, steps >> 8]).astype(np.uint8)
    # Its level 9 takes twenty times as long, for one percent less
    return b64encode(zlib.compress(split.tobytes())).decode()
