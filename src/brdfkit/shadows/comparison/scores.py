"""What one technique does in one view and one light."""

import math
from dataclasses import dataclass, fields
from math import nan

import numpy as np

# Name, heading, scale, decimals, and whether more is better
COLUMNS = (
    ("psnr", "PSNR [dB]", 1, 1, True),
    ("wrong", "wrong [%]", 100, 2, False),
    ("acne", "acne [%]", 100, 2, False),
    ("texture_use", "use [%]", 100, 1, True),
    ("aliasing", "aliasing [dB]", 1, 1, True),
    ("camera_flicker", "camera flicker [%]", 100, 3, False),
    ("light_flicker", "light flicker [%]", 100, 3, False),
    ("build", "build [ms]", 1e3, 0, False),
    ("look_up", "look-up [ms]", 1e3, 0, False),
)


def to_texts(rows):
    """The `Scores` by technique as rows of texts; "–" for what is unknown."""

    def text(value, digits):
        return "–" if math.isnan(value) else f"{value:.{digits}f}"

    return [
        (
            label,
            *(text(getattr(scores, name) * scale, digits) for name, _, scale, digits, _ in COLUMNS),
        )
        for label, scores in rows.items()
    ]


@dataclass(frozen=True)
class Scores:
    """Errors against exact shadows, and what they cost.

    Attributes
    ----------
    psnr : float
        Q3, of the picture lit by this light alone, against the one with exact shadows [dB].
    wrong : float
        The share of light that is wrong where the surface faces the light: the mean difference
        from exact shadows.
    acne : float
        The share of light that lit surfaces lack, away from shadows.
    texture_use : float
        Q1, the share of the maps' texels that the picture uses.
    aliasing : float
        Q2, how fine the texels are beside the pixels [dB].
    camera_flicker, light_flicker : float
        The mean change of the error from picture to picture, while the camera moves and while the
        light does.
    build, look_up : float
        Processor time to make the maps, and to read them for all pixels [s].
    """

    psnr: float = nan
    wrong: float = nan
    acne: float = nan
    texture_use: float = nan
    aliasing: float = nan
    camera_flicker: float = nan
    light_flicker: float = nan
    build: float = nan
    look_up: float = nan


NAMES = tuple(field.name for field in fields(Scores))


def mean(scores):
    """The `Scores` that are means of several; of dB as in the thesis, not of squared errors.

    A picture without an error has infinite dB: it counts as 99. What is nan does not count, nor
    dB against a picture that is black.
    """
    return averaged(table_of(scores))


def between_lights(scores):
    """The relative `Scores`: the mean difference of neighbours, (light 1, light 2) of each view."""
    table = table_of(scores)
    first, second = table[::2], table[1::2]
    return averaged(np.abs(first[: len(second)] - second))


def table_of(scores):
    """The numbers (scores, names) of `Scores`, 99 at most, nan for -∞."""
    table = np.array([[getattr(one, name) for name in NAMES] for one in scores])
    return np.where(np.isneginf(table), nan, np.minimum(table, 99.0))


def averaged(table):
    """The `Scores` that are the means of the columns of a `table`, without what is nan in it."""
    known = ~np.isnan(table)
    count = known.sum(axis=0)
    sums = np.where(known, table, 0).sum(axis=0)
    return Scores(*np.where(count, sums / np.maximum(count, 1), nan).tolist())
