"""`Scores`: the errors and costs of one technique in one view and light, and their means."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from math import nan

import numpy as np

from brdfkit.core.array_types import FloatArray

# Each column of the table: the attribute of `Scores`, the heading, the factor that converts the
# attribute to the unit in the heading, the number of decimals, and whether larger is better
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


@dataclass(frozen=True)
class Scores:
    """Errors of a shadow technique against exact shadows, and its processor times.

    Attributes
    ----------
    psnr : float
        The PSNR between the picture and one with exact shadows, both lit by this light alone [dB];
        Q3 in [Ergun 2008, 3.2].
    wrong : float
        The mean absolute error of the share of light that arrives, where surfaces face the light.
    acne : float
        The mean share of light that lit surfaces wrongly lack, away from true shadows.
    texture_use : float
        The share of the maps' area that the picture uses; Q1 in [Ergun 2008, 3.2].
    aliasing : float
        A measure of how small the texels are in the picture [dB]; larger is better; Q2 there.
    camera_flicker, light_flicker : float
        The mean change of the error between successive pictures, while the camera moves, and while
        the light moves.
    build, look_up : float
        Processor time to make the maps, and to look up all pixels in them [s].
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


def average_scores(scores: Sequence[Scores]) -> Scores:
    """Return the mean scores over several views and lights.

    Means of dB are means of the decibels themselves, as in [Ergun 2008]. A picture without an error
    has infinite PSNR, which counts as 99 dB. NaN is left out, and so is a PSNR of -∞.
    """
    return _average_columns(_make_score_array(scores))


def average_light_differences(scores: Sequence[Scores]) -> Scores:
    """Return the mean over views of |score in light 1 - score in light 2|, for each score.

    scores : the scores of one technique: of the first view in light 1, the first view in light 2,
        the second view in light 1, and so on.
    """
    table = _make_score_array(scores)
    first, second = table[::2], table[1::2]
    return _average_columns(np.abs(first[: len(second)] - second))


def format_scores(rows: Mapping[str, Scores]) -> list[tuple[str, ...]]:
    """Return the rows of a table, the label and the scores of each technique as texts.

    An unknown score is "–".

    rows : scores by label.
    """

    def format_value(value: float, digits: int) -> str:
        return "–" if math.isnan(value) else f"{value:.{digits}f}"

    return [
        (
            label,
            *(format_value(getattr(scores, name) * k, digits) for name, _, k, digits, _ in COLUMNS),
        )
        for label, scores in rows.items()
    ]


def _make_score_array(scores: Sequence[Scores]) -> FloatArray:
    """Return scores as an array (scores, attributes), at most 99, with NaN in place of -∞."""
    table = np.array([[getattr(one, name) for name in NAMES] for one in scores])
    return np.where(np.isneginf(table), nan, np.minimum(table, 99.0))


def _average_columns(table: FloatArray) -> Scores:
    """Return the `Scores` of column means of an array (scores, attributes), leaving out NaN."""
    known = ~np.isnan(table)
    count = known.sum(axis=0)
    sums = np.where(known, table, 0).sum(axis=0)
    return Scores(*np.where(count, sums / np.maximum(count, 1), nan).tolist())
