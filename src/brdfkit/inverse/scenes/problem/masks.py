"""Masks: which pixels of the pictures to reach count, and how much."""

from pathlib import Path

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import require_file
from brdfkit.mitsuba_bridge.properties.picture_file import read_pixels


def read_masks(mask, count):
    """A mask (height, width) for each of `count` pictures; None of those that count everywhere.

    `mask`: None; that of the only picture, an array or a path; or several, of which some may be
    None. Raises `BrdfkitError` for as many masks as there are no pictures, and for a mask that is
    no picture of weights ≥ 0, or 0 everywhere.
    """
    if mask is None:
        return [None] * count
    alone = isinstance(mask, str | Path) or (count == 1 and isinstance(mask, np.ndarray))
    several = [mask] if alone else list(mask)
    if len(several) != count:
        raise BrdfkitError(
            f"refine: there should be one mask for each picture: {len(several)} for {count}."
        )
    return [None if one is None else _read(one, number) for number, one in enumerate(several)]


def _read(mask, number):
    name = f"refine: mask {number}"
    if isinstance(mask, str | Path):
        name = str(mask)
        mask = read_pixels(require_file(mask), name).mean(axis=2)
    mask = np.asarray(mask)
    if mask.ndim != 2 or mask.dtype.kind not in "biuf":
        raise BrdfkitError(
            f"{name}: its shape {mask.shape} of {mask.dtype} should be (height, width) of booleans "
            "or weights."
        )
    mask = mask.astype(float)
    if not (np.isfinite(mask) & (mask >= 0)).all():
        raise BrdfkitError(f"{name}: its weights should be finite numbers ≥ 0.")
    if not mask.any():
        raise BrdfkitError(f"{name}: it is 0 everywhere; no pixel would count.")
    return mask
