"""A scene's shadows by all methods beside those of rays: their shares, errors and times."""

from functools import partial

import numpy as np
from brdfkit.theses.balint2019.measuring import rms, seconds_in_turns, shares
from brdfkit.theses.balint2019.rivals import aaltonen, quilez
from brdfkit.theses.balint2019.view import View

from brdfkit.distance_fields.shadows.marches import compute_linear_shadow
from brdfkit.distance_fields.shadows.monte_carlo import compute_monte_carlo_shadow
from brdfkit.distance_fields.shadows.split import compute_split_shadow
from brdfkit.images.errors.psnr import psnr

SIZE, TRUE_RAYS, TIMES = 144, 1024, 3
EPSILON = {0.2: 1 / 10, 1.0: 1 / 20}  # by the radius of the light
RAYS = 1, 2, 3, 4, 8, 16, 32, 64, 128, 512


class Frame:
    """The shadows of a scene by all methods: their shares, errors and times."""

    def __init__(self, scene, radius):
        self.view = View(scene(), SIZE)
        field, cone, epsilon = self.view.scene.field, self.view.cones(radius), EPSILON[radius]
        methods = {n: partial(compute_monte_carlo_shadow, field, cone, n) for n in RAYS}
        methods["linear"] = partial(compute_linear_shadow, field, cone, epsilon)
        methods["split"] = partial(compute_split_shadow, field, cone, epsilon)
        methods |= {m.__name__: partial(m, field, cone) for m in (quilez, aaltonen)}
        self.seconds = seconds_in_turns(methods, TIMES)
        self.shares = {name: shares(method()) for name, method in methods.items()}
        self.truth = shares(compute_monte_carlo_shadow(field, cone, TRUE_RAYS, 1e-4))
        self.errors = {name: rms(share - self.truth) for name, share in self.shares.items()}

    def faster(self, rays, name="linear"):
        """How many times as long as a method so many rays take."""
        return self.seconds[rays] / self.seconds[name]

    def rays_of_error(self, name):
        """How many rays have the error of a method, between those that were tried."""
        errors = np.log([self.errors[n] for n in RAYS])
        return float(np.exp(np.interp(-np.log(self.errors[name]), -errors, np.log(RAYS))))

    def faster_at_equal_error(self, name):
        """How many times as long as a method rays take that have its error."""
        times = np.interp(self.rays_of_error(name), RAYS, [self.seconds[n] for n in RAYS])
        return float(times) / self.seconds[name]

    def decibels(self, name):
        """PSNR [dB] of the shaded picture by a method."""
        true, other = (self.view.shaded(s)[..., None] for s in (self.truth, self.shares[name]))
        return psnr(true, other)
