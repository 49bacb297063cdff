"""Judges fits to a material by their errors in held-out directions and by a picture."""

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

FOLDS = 5  # number of parts of the directions, each of which is held out of one fit


class Judge:
    """Judges the fits to one measured material, to reveal models that only suit their own samples.

    `settings` are the settings of the fits; their seed also draws the held-out directions.
    """

    def __init__(self, data: Measured, settings: FitSettings) -> None:
        self.settings, self.anisotropic = settings, data.anisotropic
        angle, seed = settings.max_angle, settings.seed
        samples = select_samples(data, angle, None, False, settings.spectral)
        self.appearance = Appearance(data, samples, angle, seed + 1)
        self.held_out, loss = None, to_loss(settings.loss)
        if not isinstance(loss, Picture):
            rng = np.random.default_rng(seed)
            with suppress(BrdfkitError):  # raised for fewer blocks of directions than folds
                self.held_out = HeldOut.divide(samples, loss, data.anisotropic, FOLDS, rng)

    def judge_fit(self, fit: Fit) -> dict[str, float]:
        """Return the held-out error and the PSNR of a fit, by their names in `Row`."""
        return {
            "held_out": self.compute_held_out_error(fit),
            "psnr": self.compute_picture_psnr(fit),
        }

    def compute_held_out_error(self, fit: Fit) -> float:
        """Return the error E of a fit's model in directions that are held out of the fit in turn.

        It is nan if the loss is a `Picture`, or if there are too few samples.
        """
        if self.held_out is None:
            return math.nan
        how = self.settings.to_search_arguments()
        del how["starts"]  # every search starts from the values of the fit instead
        if how["anisotropic"] is None:
            how["anisotropic"] = self.anisotropic
        model = type(fit.model)
        first = {name: fit.values[name] for name in model.shapes(how["anisotropic"])}
        try:
            return math.sqrt(compute_held_out_errors(model, self.held_out, first, how).sum())
        except BrdfkitError:
            return math.nan

    def compute_picture_psnr(self, fit: Fit) -> float:
        """Return the PSNR [dB] of a ball's picture with the fit to one with the measurement."""
        return to_decibels(self.appearance.compute_picture_error(fit.model.rgb.eval))
