"""Bands of a march: how many pixels of a light's shadows lie on one, by ε."""

import numpy as np
from brdfkit.theses.balint2019.dense import dense
from brdfkit.theses.balint2019.measuring import shares

from brdfkit.distance_fields.shadows.marches import compute_linear_shadow

INVERSES = 2, 4, 8, 16, 32, 64, 128, 256  # of ε
SMOOTH = 0.05  # jumps of the truth up to which a pixel is no edge
FEW = 0.01  # of the pixels may lie on a band


class Light:
    """The shadows of a light of one radius by 1 / ε: their shares, errors and evaluations."""

    def __init__(self, view, radius):
        field, cone = view.scene.field, view.cones(radius)
        model = shares(dense(field, cone))
        self.truth = view.image(model)
        self.shares, self.errors, self.evaluations = {}, {}, {}
        for n in INVERSES:
            shadow = compute_linear_shadow(field, cone, 1 / n)
            self.shares[n] = shares(shadow)
            self.errors[n] = view.image(self.shares[n] - model)
            self.evaluations[n] = float(np.mean(shadow.evaluations))

    def banded(self, n, height):
        """The share of pixels on a band of more than this height."""
        return float(np.mean((jumps(self.errors[n]) > height) & (jumps(self.truth) < SMOOTH)))

    def right(self, height):
        """The least 1 / ε at which hardly a pixel lies on a band; None where there is none."""
        return next((n for n in INVERSES if self.banded(n, height) < FEW), None)

    def highest(self, n):
        """The largest error."""
        return float(np.nanmax(np.abs(self.errors[n])))


def jumps(image):
    """How much an image (size, size) changes towards its neighbours above and on the left."""
    down, across = (np.abs(np.diff(image, axis=axis)) for axis in (0, 1))
    return np.maximum(down[:, 1:], across[1:])
