"""The printed figures, and what the thesis makes of them: means, and relative scores."""

import tomllib
from functools import cache
from pathlib import Path

import numpy as np


@cache
def printed(table):
    """A table of `printed.toml`: name → its figures, an array."""
    text = Path(__file__).with_name("printed.toml").read_text(encoding="utf-8")
    return {name: np.array(figures) for name, figures in tomllib.loads(text)[table].items()}


def mean_and_relative(cells):
    """Of cells (..., view, light): their mean, and the mean over views of the difference between
    both lights [Ergun 2008, 3.2].

    >>> mean_and_relative(np.array([[1.0, 2.0], [4.0, 1.0]]))
    (2.0, 2.0)
    """
    return float(cells.mean()), float(np.abs(np.diff(cells, axis=-1)).mean())
