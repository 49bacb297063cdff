"""`Scores`: the errors and costs of one technique in one view and light, and their means."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from math import nan

import numpy as np

from brdfkit.core.array_types import FloatArray

# Attribute of `Scores`, heading, factor from its unit, decimals, and whether more is better
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
        The PSNR of the picture lit by this light alone, against exact shadows [dB]; Q3 in
        [Ergun 2008, 3.2].
    wrong : float
        The mean absolute error of the share of light that arrives, where surfaces face the light.
    acne : float
        The mean share of light that lit surfaces lack, away from shadows.
    texture_use : float
        The share of the maps' texels that the picture uses, Q1.
    aliasing : float
        A measure of how small the texels are in the picture, Q2; larger is better [dB].
    camera_flicker, light_flicker : float
        The mean change of the error from picture to picture, while the camera moves and while the
        light does.
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

    dB are averaged themselves, as in [Ergun 2008]. A picture without an error has infinite dB,
    which count as 99. NaN is left out, as are dB against a black picture, -∞.
    """
    return _average_columns(_to_table(scores))


def average_light_differences(scores: Sequence[Scores]) -> Scores:
    """Return the mean absolute differences between each view's scores in light 1 and in light 2.

    scores : scores of all views in which the two lights alternate.
    """
    table = _to_table(scores)
    first, second = table[::2], table[1::2]
    return _average_columns(np.abs(first[: len(second)] - second))


def format_scores(rows: Mapping[str, Scores]) -> list[tuple[str, ...]]:
    """Return the scores of techniques as rows of texts; "–" for unknown ones."""

    def format_value(value: float, digits: int) -> str:
        return "–" if math.isnan(value) else f"{value:.{digits}f}"

    return [
        (
            label,
            *(format_value(getattr(scores, name) * k, digits) for name, _, k, digits, _ in COLUMNS),
        )
        for label, scores in rows.items()
    ]


def _to_table(scores: Sequence[Scores]) -> FloatArray:
    """Return scores as an array (scores, names), limited to 99, with NaN in place of -∞."""
    table = np.array([[getattr(one, name) for name in NAMES] for one in scores])
    return np.where(np.isneginf(table), nan, np.minimum(table, 99.0))


def _average_columns(table: FloatArray) -> Scores:
    """Return scores with the means of the columns of an array (scores, names), leaving out NaN."""
    known = ~np.isnan(table)
    count = known.sum(axis=0)
    sums = np.where(known, table, 0).sum(axis=0)
    return Scores(*np.where(count, sums / np.maximum(count, 1), nan).tolist())
