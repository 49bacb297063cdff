"""The half disc that lobes are drawn on: half a polar plot, logarithmic, the normal upwards."""

import math

import numpy as np

SMALL = {"size": 8, "color": "0.35"}
MOST_DECADES = 5


class Radius:
    """Maps BRDF values to radii by their logarithm: a power of ten to 0, the largest to nearly 1.

    `curves`: the values (n,) of each lobe that is drawn. At most `MOST_DECADES` are shown.
    """

    def __init__(self, curves):
        shown = [values[values > 0] for values in curves]
        shown = [values for values in shown if values.size] or [np.ones(1)]
        highest = np.log10(max(values.max() for values in shown))
        lowest = np.log10(min(np.percentile(values, 2) for values in shown))
        self.lowest = math.floor(min(max(lowest, highest - MOST_DECADES), highest - 0.5))
        self.decades = 1.03 * (highest - self.lowest)

    def __call__(self, values):
        floor = 10.0**self.lowest  # NaN, where nothing was measured, stays NaN
        return (np.log10(np.maximum(values, floor)) - self.lowest) / self.decades

    def ticks(self):
        """Values to label from the centre to the rim: powers of ten, so few that no labels touch.

        Where fewer than two decades are shown, 2 and 5 or 3 times these powers are labelled, too.
        """
        step = math.ceil(self.decades / 4.5)
        powers = 10.0 ** np.arange(self.lowest, self.lowest + self.decades, step)
        between = (1, 2, 5) if self.decades < 1.2 else (1, 3) if self.decades < 2 else (1,)
        ticks = np.outer(powers, between).ravel()
        return ticks[np.log10(ticks) - self.lowest < self.decades]


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
