"""Q2: the aliasing of a picture as one number [dB], larger is better [Ergun 2008, 3.2].

e, how many pixels a texel covers, is written to the red channel, and the picture's PSNR is taken
against a black one. The thesis does not tell how e becomes a grey level; here e is the level, at
most 255, which gives figures as printed (27 to 37 dB):

    10 log10 (255² / mean e²)
"""

import numpy as np

WHITE = 255.0


def aliasing_error(e):
    """Q2 [dB] of the texels' areas `e` [pixels] of all that is seen; nan where nothing is.

    >>> aliasing_error(np.full(9, 25.5))
    20.0
    """
    e = np.minimum(np.asarray(e, float), WHITE)
    return float(10 * np.log10(WHITE**2 / np.square(e).mean())) if e.size else np.nan
