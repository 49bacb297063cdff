"""Draws the figure of docs/volume_programs.md: pictures of programs, and their differences."""

import numpy as np

from brdfkit.core.colours import to_srgb
from brdfkit.theses.drawing import make_figure

from .case import NAMES, Case

TIMES = 10  # factor of the differences
SHOWN = (
    ("brdfkit", "defaults"),
    ("VTK", "typed in"),
    ("VTK", "careful"),
    ("PyVista", "careful"),
    ("K3D", "right unit"),
    ("Mitsuba", "gridvolume"),
)


def draw_figure(pictures):
    """Return the figure; `pictures`: RGB and opacity by (case, program, setting)."""
    page = make_figure(13, 11.5)
    axes = page.subplots(len(NAMES), 1 + 2 * len(SHOWN))
    for a in axes.flat:
        a.set_axis_off()
    for row, name in zip(axes, NAMES, strict=True):
        exact = Case(name).exact
        show_linear(row[0], exact[..., :3])
        row[0].set_title(name, size=9)
        for k, (program, setting) in enumerate(SHOWN):
            found = pictures.get((name, program, setting))
            if found is None:
                continue
            part = choose_channels(found)
            show_linear(row[1 + 2 * k], found[..., part])
            row[2 + 2 * k].imshow(to_three_channels(0.5 + TIMES * (found - exact)[..., part]))
            if name == NAMES[0]:
                row[1 + 2 * k].set_title(f"{program},\n{setting}", size=9)
                row[2 + 2 * k].set_title(f"× {TIMES}", size=9)
    return page


def choose_channels(picture):
    """Return the slice of a picture's channels to compare: RGB, or opacity without RGB."""
    return slice(3) if np.isfinite(picture[..., 0]).all() else slice(3, 4)


def show_linear(axes, linear):
    axes.imshow(to_three_channels(to_srgb(np.clip(linear, 0, 1))))


def to_three_channels(pixels):
    """Return pixels as three channels between 0 and 1."""
    return np.clip(np.broadcast_to(pixels, (*pixels.shape[:2], 3)), 0, 1)
