"""Chooses the size of the pictures for a canvas of the page."""

from __future__ import annotations

from itertools import product
from math import log

STEP = 64  # pixels: every size of a picture needs kernels of its own, so there are few
SMALLEST_SIDE, LARGEST_SIDE = 64, 2048


def choose_size(width: int, height: int) -> tuple[int, int]:
    """Return the size of the pictures for a canvas [pixels]: in steps, nearly of its proportions.

    The page covers the canvas with the picture and crops what is over, so the proportions count
    more than the size.
    """
    scale = min(1.0, LARGEST_SIDE / max(width, height))
    wanted = [max(scale * min(side, 10**6), SMALLEST_SIDE) for side in (width, height)]
    steps = [{int(side // STEP), int(-(-side // STEP))} for side in wanted]

    def misfit(size: tuple[int, int]) -> float:
        wider, higher = (log(own / side) for own, side in zip(size, wanted, strict=True))
        return abs(wider - higher) + abs(wider + higher) / 4

    return min(((STEP * across, STEP * down) for across, down in product(*steps)), key=misfit)
