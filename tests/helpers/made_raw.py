"""Writes RAW files (DNG) of made scenes, as a camera with a mosaic of colour filters would."""

from fractions import Fraction

import numpy as np

# From XYZ to the colours of the camera, which are those of linear sRGB
FROM_XYZ = 3.2405, -1.5371, -0.4985, -0.9693, 1.876, 0.0416, 0.0556, -0.204, 1.0572
NEUTRAL = 0.5, 1, 0.6  # what the camera sees of white
BLACK, WHITE = 512, 16383
BYTE, ASCII, SHORT, LONG, RATIONAL, SIGNED_RATIONAL = 1, 2, 3, 4, 5, 10  # types of TIFF


def write_dng(path, values):
    """Write the values (height, width, 3), from 0 to 1, that the camera's sensor has."""
    import tifffile

    height, width, _ = values.shape
    channel = np.array([[0, 1], [1, 2]])[np.indices((height, width))[0] % 2, np.arange(width) % 2]
    mosaic = np.take_along_axis(values, channel[..., None], axis=2)[..., 0]
    numbers = np.round(BLACK + mosaic * (WHITE - BLACK)).astype(np.uint16)
    tags = [
        (50706, BYTE, 4, bytes([1, 4, 0, 0]), True),  # version of DNG
        (50708, ASCII, 0, "Made", True),  # model of the camera
        (50721, SIGNED_RATIONAL, 9, _to_fractions(FROM_XYZ), True),
        (50728, RATIONAL, 3, _to_fractions(NEUTRAL), True),
        (50778, SHORT, 1, 21, True),  # the matrix is for D65
        (33421, SHORT, 2, (2, 2), True),  # size of the mosaic
        (33422, BYTE, 4, bytes([0, 1, 1, 2]), True),  # red, green, green, blue
        (50714, LONG, 1, BLACK, True),
        (50717, LONG, 1, WHITE, True),
    ]
    tifffile.imwrite(path, numbers, photometric=32803, extratags=tags, metadata=None)


def _to_fractions(numbers):
    fractions = [Fraction(number).limit_denominator(10000) for number in numbers]
    return [part for f in fractions for part in (f.numerator, f.denominator)]
