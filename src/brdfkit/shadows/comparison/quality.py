"""Q2: the aliasing of a picture as one number [dB], larger is better [Ergun 2008, 3.2].

e, how many pixels a texel covers, is written to the red channel, and the picture's PSNR is taken
against a black one. The thesis does not tell how e becomes a grey level; here e is the level, at
most 255, which gives figures as printed (27 to 37 dB):

    10 log10 (255² / mean e²)
"""

import numpy as np

BINS = 64  # along each side of a map: cells enough to tell where, points enough in each


def share_used(maps, bins=BINS):
    """The share of the maps that points use, in (0, 1]; nan where no point is on a map.

    maps : for each map, the places (n, 2) of points on it, in [0, 1]²; others do not count.

    >>> share_used([np.array([[0.2, 0.2], [0.7, 0.2]])], bins=2)
    0.5
    """
    counts = np.stack([np.histogram2d(*places.T, bins, [[0, 1]] * 2)[0] for places in maps])
    if not counts.any():
        return np.nan
    return float(counts.sum() ** 2 / (counts.size * np.square(counts).sum()))


def flicker(lit, true):
    """The mean change of the error from picture to picture, 0 at best.

    lit, true : shares of the light (pictures, points), by the technique and in truth.

    >>> flicker([[1, 0], [0, 0]], [[1, 1], [1, 1]])
    0.5
    """
    errors = np.asarray(lit, float) - np.asarray(true, float)
    return float(np.abs(np.diff(errors, axis=0)).mean())


WHITE = 255.0


def aliasing_error(e):
    """Q2 [dB] of the texels' areas `e` [pixels] of all that is seen; nan where nothing is.

    >>> aliasing_error(np.full(9, 25.5))
    20.0
    """
    e = np.minimum(np.asarray(e, float), WHITE)
    return float(10 * np.log10(WHITE**2 / np.square(e).mean())) if e.size else np.nan
