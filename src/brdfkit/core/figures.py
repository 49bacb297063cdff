"""Figures of matplotlib as files in memory, which notebooks show on light and on dark grounds."""

import io
from contextlib import contextmanager

import numpy as np
from matplotlib.figure import Figure

# A grey of a contrast of 4 to white, and of 4.5 to the ground of dark notebooks
INK = 0.49
STRONGER = 1.6  # than on white: a grey of 0.4 is opaque, one of 0.9 a sixth
NEUTRAL = 0.02  # channels that differ by less are a grey
COLOURS = {
    "Text": ("color",),
    "Line2D": ("color", "markerfacecolor", "markeredgecolor"),
    "Patch": ("edgecolor", "facecolor"),
    "LineCollection": ("color",),
}  # of what is drawn, by the names of matplotlib's classes


class Plot(Figure):
    """A matplotlib `Figure` that is not pyplot's: it has no window and no global state.

    Notebooks show it even if pyplot has not told them how.
    """

    def _repr_png_(self):
        return to_png(self)


def to_png(figure, dpi=100):
    """The bytes of a matplotlib `Figure` as a PNG that is legible on white and on black.

    Its ground is transparent; what is black or grey is a middle grey. The figure stays as it is.
    """
    png = io.BytesIO()
    with _with_visible_greys(figure):
        figure.savefig(png, format="png", dpi=dpi, facecolor="none")
    return png.getvalue()


@contextmanager
def _with_visible_greys(figure):
    """Within the block the greys of a `figure` are legible on any ground."""
    figure.draw_without_rendering()  # which makes the labels of the ticks
    before = [
        (artist, name, getattr(artist, f"get_{name}")())
        for artist in figure.findobj()
        for kind in type(artist).__mro__
        for name in COLOURS.get(kind.__name__, ())
    ]
    try:
        for artist, name, colour in before:
            getattr(artist, f"set_{name}")(_to_visible(colour))
        yield
    finally:
        for artist, name, colour in before:
            getattr(artist, f"set_{name}")(colour)


def _to_visible(colours):
    """`colours` of matplotlib, black and greys as a middle grey, the fainter the lighter they were;
    white is transparent."""
    from matplotlib.colors import to_rgba_array

    rgba = to_rgba_array(colours)
    grey = np.ptp(rgba[:, :3], axis=1) < NEUTRAL
    strength = np.minimum(STRONGER * (1 - rgba[grey, 0]), 1)
    rgba[grey, :3] = INK
    rgba[grey, 3] *= strength
    return rgba if len(rgba) > 1 else tuple(rgba[0]) if len(rgba) else "none"
