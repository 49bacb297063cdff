"""Which pixels count; crops pictures to them for metrics that look around a pixel."""

import numpy as np


def to_mask(picture, mask):
    """The mask (height, width) of the pixels that count: all where `mask` is None.

    >>> to_mask(np.zeros((1, 2, 3)), None)
    array([[ True,  True]])
    """
    return np.full(picture.shape[:2], True) if mask is None else mask


def crop_to_mask(pictures, mask, margin=0):
    """The `pictures` and the mask, cut to the mask's bounding box and a black `margin` [pixels].

    All that is outside the mask becomes black in every picture, so that nothing of it counts.

    >>> pictures, mask = crop_to_mask([np.ones((9, 9, 3))], np.eye(9) > 0)
    """
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    box = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    border = (margin, margin), (margin, margin), (0, 0)
    black = [np.where(mask[..., None], picture, 0)[box] for picture in pictures]
    return [np.pad(picture, border) for picture in black], np.pad(mask[box], margin)
