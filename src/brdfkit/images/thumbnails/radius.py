"""`Radius`: the logarithmic radius of lobes, in thumbnails and in plots."""

import math

import numpy as np

MOST_DECADES = 5
# The darkest is this share of the range from the centre: nearer, both sides of a line meet there,
# and a dark lobe is a wedge
MARGIN = 0.2


class Radius:
    """Maps BRDF values to radii by their logarithm.

    A power of ten below them is 0, the largest nearly 1.
    `curves`: the values (n,) of each lobe that is drawn. At most `MOST_DECADES` are shown.
    """

    def __init__(self, curves):
        shown = [values[values > 0] for values in curves]
        shown = [values for values in shown if values.size] or [np.ones(1)]
        highest = np.log10(max(values.max() for values in shown))
        lowest = np.log10(min(np.percentile(values, 2) for values in shown))
        lowest -= MARGIN * (highest - lowest)
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
