"""Judges the fits to a material where they were not fitted, and by a picture."""

import math
from contextlib import suppress

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.fitting.ranking.appearance import Appearance
from brdfkit.fitting.ranking.cross_validation import compute_held_out_errors
from brdfkit.fitting.ranking.held_out import HeldOut
from brdfkit.fitting.ranking.ranked import to_decibels
from brdfkit.fitting.settings import FitSettings
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.selection import select_samples
from brdfkit.regression import Fit, Picture, to_loss

FOLDS = 5
# Settings of a sweep's fit that its fits without a fold share; they begin where it ended


class Judge:
    """What tells how good the fits to a measured material are, beside their own error.

    `settings`: all those of the fits, whose seed draws what is held out, too.
    """

    def __init__(self, data: Measured, settings: FitSettings):
        self.settings, self.anisotropic = settings, data.anisotropic
        angle, seed = settings.max_angle, settings.seed
        samples = select_samples(data, angle, None, False, settings.spectral)
        self.appearance = Appearance(data, samples, angle, seed + 1)
        self.held_out, loss = None, to_loss(settings.loss)
        if not isinstance(loss, Picture):
            rng = np.random.default_rng(seed)
            with suppress(BrdfkitError):  # fewer blocks of directions than folds
                self.held_out = HeldOut.draw(samples, loss, data.anisotropic, FOLDS, rng)

    def judge(self, fit: Fit) -> dict[str, float]:
        """The numbers of a fit by their names in `Row`."""
        return {"held_out": self.error_of(fit), "psnr": self.psnr_of(fit)}

    def error_of(self, fit: Fit) -> float:
        """E of the fit's loss in directions that a fit did not see; nan under a `Picture`, and
        where there are too few samples."""
        if self.held_out is None:
            return math.nan
        how = self.settings.of_search()
        del how["starts"]  # the search goes on from the fit
        if how["anisotropic"] is None:
            how["anisotropic"] = self.anisotropic
        model = type(fit.model)
        first = {name: fit.values[name] for name in model.shapes(how["anisotropic"])}
        try:
            return math.sqrt(compute_held_out_errors(model, self.held_out, first, how).sum())
        except BrdfkitError:
            return math.nan

    def psnr_of(self, fit: Fit) -> float:
        """The PSNR [dB] of a picture of a ball beside the measurement's, as `rank` tells it."""
        return to_decibels(self.appearance.picture_error(fit.model.rgb.eval))
