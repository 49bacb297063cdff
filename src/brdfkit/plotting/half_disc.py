"""Half a polar plot, the normal upwards, logarithmic: what lobes are drawn on."""

import math

import numpy as np

SMALL = {"size": 8, "color": "0.35"}
MOST_DECADES = 5


class Radius:
    """The radius of a BRDF value, 0 to 1: its logarithm between a power of ten and the largest."""

    def __init__(self, curves):
        shown = [values[values > 0] for values in curves]
        shown = [values for values in shown if values.size] or [np.ones(1)]
        highest = np.log10(max(values.max() for values in shown))
        lowest = np.log10(min(np.percentile(values, 2) for values in shown))
        self.lowest = math.floor(min(max(lowest, highest - MOST_DECADES), highest - 0.5))
        self.decades = 1.03 * (highest - self.lowest)

    def __call__(self, values):
        floor = 10.0**self.lowest  # NaN, not measured, stays NaN
        return (np.log10(np.maximum(values, floor)) - self.lowest) / self.decades

    def ticks(self):
        """Powers of ten from the centre to the rim, not so many that their labels would touch; in
        less than two decades with what lies between."""
        step = math.ceil(self.decades / 4.5)
        powers = 10.0 ** np.arange(self.lowest, self.lowest + self.decades, step)
        between = (1, 2, 5) if self.decades < 1.2 else (1, 3) if self.decades < 2 else (1,)
        ticks = np.outer(powers, between).ravel()
        return ticks[np.log10(ticks) - self.lowest < self.decades]


def half_disc(axes, radius):
    """The axes and their labels; matplotlib's own half of a polar plot leaves half a page blank."""
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
    """Where an angle to the normal [degrees], positive to the right, and a radius lie."""
    return radius * np.sin(np.radians(theta)), radius * np.cos(np.radians(theta))
