"""The half disc that lobes are drawn on: half a polar plot, logarithmic, the normal upwards."""

import numpy as np

SMALL = {"size": 8, "color": "0.35"}


def draw_half_disc(axes, radius):
    """Draw rim, grid and labels; `radius`: a `Radius`.

    Matplotlib's own polar axes would leave half of the page blank.
    """
    axes.set(aspect="equal", xlim=(-1.2, 1.2), ylim=(-0.27, 1.13))
    axes.set_axis_off()
    half = np.arange(-90, 91)
    rim = {"color": "0.3", "linewidth": 0.8, "zorder": 1.2}
    grid = {"color": "0.87", "linewidth": 0.7, "zorder": 1}
    axes.plot(*xy(half, 1), **rim)
    axes.plot([-1, 1], [0, 0], **rim)
    for theta in range(-90, 91, 30):
        axes.plot(*xy(theta, np.array([0, 1])), **grid)
        text = f"{theta}°".replace("-", "−")
        va = "bottom" if abs(theta) == 90 else "center"  # above the numbers along the radius
        axes.text(*xy(theta, 1.1), text, ha="center", va=va, **SMALL)
    for tick in radius.ticks():
        axes.plot(*xy(half, radius(tick)), **grid)
        axes.text(radius(tick), -0.03, f"{tick:g}", ha="center", va="top", **SMALL)
    axes.text(0, -0.17, "luminance of the BRDF [sr⁻¹], logarithmic", ha="center", va="top", **SMALL)


def xy(theta, radius):
    """The place (x, y) of a radius at an angle to the normal [degrees], positive to the right."""
    return radius * np.sin(np.radians(theta)), radius * np.cos(np.radians(theta))
