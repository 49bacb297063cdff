"""Summarises a `Refinement` as a document, which prints as text and as HTML."""

from typing import Any

import numpy as np

from brdfkit.core.documents import Cell, Document, Paragraph, Picture, Table
from brdfkit.core.documents.parts import BAD, SOFT
from brdfkit.rendering.montage import TILE
from brdfkit.rendering.result import WIDEST


def describe_refinement(result: Any) -> Document:
    """Return a `Refinement` as a document: values with errors, compared pictures, and notes."""
    errors = result.standard_errors
    rows = tuple(
        (
            name,
            Cell(_format_value(value, errors[name]), colour=_find_colour(value)),
            Cell("on its bound", kind=BAD) if name in result.at_bounds else "",
        )
        for name, value in result.values.items()
    )
    several = "s" * (result.steps != 1)
    early = f"Not converged, and the values are not final: {result.message}."
    return Document(
        f"Refined: the residual is {100 * result.loss:.2g} % of white (RMS)",
        (
            *(Paragraph(early, kind=BAD) for _ in range(not result.converged)),
            Table(rows),
            *(_make_comparison_picture(result, number) for number in range(len(result.pictures))),
            *(Paragraph(note) for note in result.notes),
            Paragraph(
                f"{result.message}; {result.steps} step{several}, the last at {result.samples} "
                f"samples per pixel, {result.seconds:.1f} s",
                kind=SOFT,
            ),
        ),
    )


def _make_comparison_picture(result: Any, number: int) -> Picture:
    """Return a given picture and the rendered one side by side, drawn on demand."""
    width = min(WIDEST, 2 * max(result.pictures[number].shape[1], TILE))
    alt_text = f"given and found pictures {result.names[number]}, and their difference"
    return Picture(lambda: result.look(number).drawn(), alt_text, width)


def _format_value(value: Any, error: Any) -> str:
    """Return a value with its standard errors as text; for an array, its shape and range."""
    if isinstance(value, np.ndarray):
        shape = " × ".join(map(str, value.shape))
        return f"{shape}, {value.min():.3g} to {value.max():.3g}, mean {value.mean():.4g}"
    pairs = zip(np.atleast_1d(value), np.atleast_1d(error), strict=True)
    return "  ".join(f"{v:.5g}" if np.isnan(e) else f"{v:.5g} ± {e:.2g}" for v, e in pairs)


def _find_colour(value: Any) -> tuple[float, ...]:
    """Return the colour with which a value is shown: the value itself if it is one, else ()."""
    return value if isinstance(value, tuple) and len(value) == 3 and min(value) >= 0 else ()
