"""Masks, which select the pixels to compare, and the cropping of pictures to a mask."""

from collections.abc import Sequence

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray


def make_mask(picture: AnyArray, mask: BoolArray | None) -> BoolArray:
    """Return `mask` (height, width), or a mask of all pixels of the picture if it is None.

    >>> make_mask(np.zeros((1, 2, 3)), None)
    array([[ True,  True]])
    """
    return np.full(picture.shape[:2], True) if mask is None else mask


def crop_to_mask(
    pictures: Sequence[AnyArray], mask: BoolArray, margin: int = 0
) -> tuple[list[AnyArray], BoolArray]:
    """Crop pictures and their mask to the bounding box of the mask, with a `margin` [pixels].

    All pixels outside the mask become black in every picture, so that they do not differ in metrics
    that use the neighbourhood of a pixel.

    >>> pictures, mask = crop_to_mask([np.ones((9, 9, 3))], np.eye(9) > 0)
    """
    rows, columns = (np.flatnonzero(mask.any(axis=axis)) for axis in (1, 0))
    box = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
    border = (margin, margin), (margin, margin), (0, 0)
    black = [np.where(mask[..., None], picture, 0)[box] for picture in pictures]
    return [np.pad(picture, border) for picture in black], np.pad(mask[box], margin)
