"""Computes a scene's shadows by all methods and by rays: shares, errors and times."""

from functools import partial

import numpy as np
from brdfkit.theses.balint2019.measuring import compute_rms, measure_in_turns, read_shares
from brdfkit.theses.balint2019.rivals import aaltonen, quilez
from brdfkit.theses.balint2019.view import View
from brdfkit.theses.balint2019.whole_frames import ROWS

from brdfkit.distance_fields.shadows.marches import compute_convex_shadow, compute_linear_shadow
from brdfkit.distance_fields.shadows.monte_carlo import compute_monte_carlo_shadow
from brdfkit.distance_fields.shadows.split import compute_split_shadow
from brdfkit.images.errors.psnr import find_peak, psnr
from brdfkit.theses.timing import compare_times

SIZE, TRUE_RAYS, TIMES = 144, 1024, 5
EPSILON = {0.2: 1 / 10, 1.0: 1 / 20}  # by the radius of the light
RAYS = 1, 2, 3, 4, 8, 16, 32, 64, 128, 512


class Frame:
    """The shadows of a scene by all methods and by rays: shares of the light, errors and times."""

    def __init__(self, scene, radius):
        self.view = View(scene(), SIZE, ROWS)
        field, cone, epsilon = self.view.scene.field, self.view.make_cones(radius), EPSILON[radius]
        methods = {n: partial(compute_monte_carlo_shadow, field, cone, n) for n in RAYS}
        methods["linear"] = partial(compute_linear_shadow, field, cone, epsilon)
        methods["convex"] = partial(compute_convex_shadow, field, cone, epsilon)
        methods["split"] = partial(compute_split_shadow, field, cone, epsilon)
        methods |= {m.__name__: partial(m, field, cone) for m in (quilez, aaltonen)}
        self.seconds = measure_in_turns(methods, TIMES)
        self.shares = {name: read_shares(method()) for name, method in methods.items()}
        self.truth = read_shares(
            compute_monte_carlo_shadow(field, cone, TRUE_RAYS, 1e-4, max(RAYS))
        )
        facing = self.view.facing  # an error where the surface looks away is not seen
        self.errors = {
            name: compute_rms(facing * (share - self.truth)) for name, share in self.shares.items()
        }

    def compare_times(self, rays, name="linear"):
        """Return the time of so many rays over that of a method."""
        return compare_times(self.seconds[rays], self.seconds[name]).value

    def count_equal_rays(self, name):
        """Return the number of rays with the error of a method, by interpolation."""
        errors = np.log([self.errors[n] for n in RAYS])
        return float(np.exp(np.interp(-np.log(self.errors[name]), -errors, np.log(RAYS))))

    def compare_times_at_equal_error(self, name):
        """Return the time of rays with the same error as a method, over its time."""
        times = [self.compare_times(n, name) for n in RAYS]
        return float(np.interp(self.count_equal_rays(name), RAYS, times))

    def compute_psnr(self, name, dimmed=False):
        """Return the PSNR [dB] of the shaded picture by a method, or of pixels not fully lit."""
        true, other = (self.view.shade(s)[..., None] for s in (self.truth, self.shares[name]))
        mask = self.view.make_image(self.truth < 1, 0) > 0 if dimmed else None
        return psnr(true, other, mask, find_peak(true))
