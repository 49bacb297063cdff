"""Figures of matplotlib that notebooks can show on light and on dark backgrounds."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from brdfkit.core.array_types import AnyArray

# The grey, from 0 to 1, that replaces black: its contrast ratio is 4 to white and 4.5 to the
# background of dark notebooks
INK_LEVEL = 0.49
OPACITY_GAIN = 1.6  # a grey g, 0 to 1, gets the opacity 1.6 (1 - g): light greys fade
GREY_TOLERANCE = 0.02  # a colour whose channels differ by less counts as grey
# The attributes that hold colours, by the names of matplotlib's classes
COLOURS = {
    "Text": ("color",),
    "Line2D": ("color", "markerfacecolor", "markeredgecolor"),
    "Patch": ("edgecolor", "facecolor"),
    "LineCollection": ("color",),
}


class Plot(Figure):
    """A matplotlib `Figure` without pyplot, its windows and its global state.

    Notebooks show it even if pyplot was not set up for them.
    """

    def _repr_png_(self) -> bytes:
        return to_png(self)


def to_png(figure: Figure, dpi: float = 100) -> bytes:
    """Return a matplotlib figure as the bytes of a PNG that is legible on white and on black.

    The background is transparent; black and greys become a middle grey. The figure is not changed.
    """
    png = io.BytesIO()
    with _with_visible_greys(figure):
        figure.savefig(png, format="png", dpi=dpi, facecolor="none")
    return png.getvalue()


@contextmanager
def _with_visible_greys(figure: Figure) -> Iterator[None]:
    """Make the greys of a figure legible on any background within the block."""
    figure.draw_without_rendering()  # creates the tick labels, which `findobj` then finds
    before = [
        (artist, name, getattr(artist, f"get_{name}")())
        for artist in figure.findobj()
        for kind in type(artist).__mro__
        for name in COLOURS.get(kind.__name__, ())
    ]
    try:
        for artist, name, colour in before:
            getattr(artist, f"set_{name}")(_replace_greys(colour))
        yield
    finally:
        for artist, name, colour in before:
            getattr(artist, f"set_{name}")(colour)


def _replace_greys(colours: Any) -> AnyArray | tuple[float, ...] | str:
    """Return colours with black and greys replaced by a middle grey, fainter for lighter greys.

    White becomes transparent; colours that are not grey stay.
    """
    from matplotlib.colors import to_rgba_array

    rgba = to_rgba_array(colours)
    grey = np.ptp(rgba[:, :3], axis=1) < GREY_TOLERANCE
    strength = np.minimum(OPACITY_GAIN * (1 - rgba[grey, 0]), 1)
    rgba[grey, :3] = INK_LEVEL
    rgba[grey, 3] *= strength
    return rgba if len(rgba) > 1 else tuple(rgba[0]) if len(rgba) else "none"
