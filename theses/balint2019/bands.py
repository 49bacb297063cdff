"""Finds bands in the shadows of a march: jumps of its error between pixels, by ε."""

import numpy as np
from brdfkit.theses.balint2019.dense import compute_dense_shadow
from brdfkit.theses.balint2019.measuring import read_shares

from brdfkit.distance_fields.shadows.marches import compute_linear_shadow

INVERSES = 2, 4, 8, 16, 32, 64, 128, 256  # of ε
SMOOTH = 0.05  # a jump of the true shadow above this is an edge, not a band
LEVEL = 1 / 256  # the grey level of a display; a larger jump is a band
FEW = 0.01  # the share of pixels that may lie on a band


class Light:
    """The shadows of a light of one radius by marches with several ε, the bound of the error.

    inverses : the values of 1 / ε, by default all.
    """

    def __init__(self, view, radius, inverses=None):
        field, cone = view.scene.field, view.make_cones(radius)
        model = read_shares(compute_dense_shadow(field, cone))
        self.truth = view.make_image(model)
        self.shares, self.errors, self.evaluations = {}, {}, {}
        for n in inverses or INVERSES:
            shadow = compute_linear_shadow(field, cone, 1 / n)
            self.shares[n] = read_shares(shadow)
            self.errors[n] = view.make_image(self.shares[n] - model)
            self.evaluations[n] = float(np.mean(shadow.evaluations))

    def measure_banded_share(self, n, height):
        """Return the share of pixels on a band higher than `height`, for the bound ε = 1 / n."""
        return float(
            np.mean((measure_jumps(self.errors[n]) > height) & (measure_jumps(self.truth) < SMOOTH))
        )

    def find_right_inverse(self, height, few=FEW):
        """Return the least 1 / ε with less than `few` of the pixels on a band, or None."""
        return next((n for n in INVERSES if self.measure_banded_share(n, height) < few), None)

    def find_largest_error(self, n):
        """Return the largest error of a march with the error bound ε = 1 / n."""
        return float(np.nanmax(np.abs(self.errors[n])))


def measure_jumps(image):
    """Return how much an image (size, size) changes from neighbours above and on the left."""
    down, across = (np.abs(np.diff(image, axis=axis)) for axis in (0, 1))
    return np.maximum(down[:, 1:], across[1:])
