"""Reads the thesis's printed figures, and computes means and relative scores as the thesis does."""

import tomllib
from functools import cache
from pathlib import Path

import numpy as np


@cache
def read_printed_table(table):
    """Return a table of `printed.toml` as an array of figures for each name."""
    text = Path(__file__).with_name("printed.toml").read_text(encoding="utf-8")
    return {name: np.array(figures) for name, figures in tomllib.loads(text)[table].items()}


def average_cells(cells):
    """Return the mean of cells (..., view, light), and their relative score.

    The relative score is the mean over views of the difference between both lights
    [Ergun 2008, 3.2].

    >>> average_cells(np.array([[1.0, 2.0], [4.0, 1.0]]))
    (2.0, 2.0)
    """
    return float(cells.mean()), float(np.abs(np.diff(cells, axis=-1)).mean())
