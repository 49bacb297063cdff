"""Packs pictures as compressed text for the script of a report's page.

The pictures are linear light, whose exposure the script can change. A number takes 16 bits: its
binary logarithm in steps of 1/128, which is 0.5 %. Neighbouring pixels are alike, so their
differences are small and compress well. PNG files would not do, because a browser may change the
colours that a script reads from them.
"""

import zlib
from base64 import b64encode
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.pages.images import apply_colour_map

DARKEST = -12  # binary logarithm of the smallest light above 0
STEPS = 128  # number of codes for each doubling of the light
LAST_CODE = 4095  # code of the largest light, 2^20
COLOUR_MAP = "magma"  # colours of the picture of colour differences
BRIGHT_DIFFERENCE = 10  # colour difference ΔE at the bright end of the colour map
LARGEST_DIFFERENCE = 100  # largest colour difference ΔE that a code stands for


def pack_pictures(
    names: list[str], pictures: list[AnyArray], differences: list[AnyArray]
) -> dict[str, Any]:
    """Return pictures and their colour differences as data for the script of a report's page.

    `names`: names of the pictures; `pictures`: pictures (height, width, 3) of linear light, the
    measurement first; `differences`: for each of the other pictures, its colour differences ΔE
    (height, width) from the measurement.
    """
    height, width = pictures[0].shape[:2]
    palette = apply_colour_map(COLOUR_MAP, np.linspace(0, 1, 256))[:, :3]
    return {
        "width": width,
        "height": height,
        "darkest": DARKEST,
        "steps": STEPS,
        "most": BRIGHT_DIFFERENCE,
        "highest": LARGEST_DIFFERENCE,
        "palette": b64encode(np.round(palette * 255).astype(np.uint8).tobytes()).decode(),
        "names": names,
        "pictures": [_compress_codes(encode_light(picture)) for picture in pictures],
        "differences": [_compress_codes(encode_difference(d)) for d in differences],
    }


def encode_light(linear: AnyArray) -> AnyArray:
    """Return the codes (3, height, width) of a picture (height, width, 3) of linear light.

    The code 0 is black; any other code k is the light 2^(DARKEST + k / STEPS).
    """
    with np.errstate(divide="ignore"):
        doublings = np.log2(np.maximum(np.nan_to_num(linear), 0)) - DARKEST
    codes = np.clip(np.round(doublings * STEPS), 0, LAST_CODE).astype(np.uint16)
    return np.moveaxis(codes, -1, 0)


def encode_difference(difference: AnyArray) -> AnyArray:
    """Return the codes (height, width) of colour differences ΔE, finest for small ones.

    The code k is the difference LARGEST_DIFFERENCE · (k / 255)².
    """
    share = np.clip(np.nan_to_num(difference) / LARGEST_DIFFERENCE, 0, 1)
    codes: AnyArray = np.round(np.sqrt(share) * 255).astype(np.uint16)
    return codes


def _compress_codes(codes: AnyArray) -> str:
    """Return 16-bit codes as compressed text.

    The text contains the differences of neighbouring codes: all low bytes, then all high bytes.
    """
    steps = np.diff(codes.ravel(), prepend=np.uint16(0))
    split = np.stack([steps & 255, steps >> 8]).astype(np.uint8)
    # Compression at level 9 would take twenty times as long, and save one percent
    return b64encode(zlib.compress(split.tobytes())).decode()
