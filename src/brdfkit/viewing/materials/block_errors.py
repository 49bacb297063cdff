"""`BlockErrors`: the errors of models beside one measured material, in blocks of directions."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.geometry.directions import to_half_difference
from brdfkit.fitting.noise_floor import compute_noise_floor
from brdfkit.fitting.ranking.held_out import assign_blocks
from brdfkit.fitting.ranking.ties import compare_with_best, is_tied
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model import Model
from brdfkit.model.samples.samples import Samples
from brdfkit.regression.losses.loss import sum_squared_differences
from brdfkit.regression.losses.named_losses import named

MAX_ANGLE = 80.0  # degrees, as in `compare`
EQUAL = 0.01  # a share of E² that is not worth a word
# Where two models differ: words, and the half angles [degrees] from which they hold
REGIONS = (
    (0.0, "in the highlight, at θh below 10°"),
    (10.0, "beside the highlight, at θh 10° to 30°"),
    (30.0, "far from the highlight, at θh above 30°"),
)
KEPT = 64  # models whose errors are kept


class BlockErrors:
    """The errors of models under every loss, which are computed once for each model.

    A model's part of E² in each block of directions tells whether it is worse than another one by
    more than noise.
    """

    def __init__(self, measured: Measured) -> None:
        self.measured = measured
        self.kept: dict[Model, dict[str, FloatArray]] = {}

    @cached_property
    def samples(self) -> Samples:
        """The samples at which models are compared with the material."""
        return select_samples(self.measured, MAX_ANGLE)

    @cached_property
    def blocks(self) -> IntArray:
        """The block of each sample."""
        return assign_blocks(self.samples.wi, self.samples.wo, self.measured.anisotropic)

    @cached_property
    def regions(self) -> IntArray:
        """The index in `REGIONS` of each block, by the mean half angle of its samples."""
        angles = np.degrees(to_half_difference(self.samples.wi, self.samples.wo)[0])
        count = np.maximum(np.bincount(self.blocks), 1)
        starts = [start for start, _ in REGIONS]
        return np.searchsorted(starts, np.bincount(self.blocks, angles) / count, "right") - 1

    @cached_property
    def shares(self) -> dict[str, FloatArray]:
        """The weights (blocks,) of the blocks under each loss."""
        weights = {n: own.importance(self.samples) for n, own in named.by_sample.items()}
        return {n: np.asarray(np.bincount(self.blocks, own), float) for n, own in weights.items()}

    @cached_property
    def floor(self) -> dict[str, float]:
        """The error of a perfect model under each loss, empty if the noise is unknown."""
        return compute_noise_floor(self.measured, named.by_sample)

    def compute(self, model: Model) -> dict[str, FloatArray]:
        """Return the parts (blocks,) of a model's E² under each loss; nan where none counts."""
        if model not in self.kept:
            self.kept = dict(list(self.kept.items())[1 - KEPT :])
            self.kept[model] = self._compute(model)
        return self.kept[model]

    def _compute(self, model: Model) -> dict[str, FloatArray]:
        """Do the work of `compute`."""
        samples = self.samples
        values = np.broadcast_to(model.eval(samples.wi, samples.wo), samples.values.shape)
        parts = {}
        for name, loss in named.by_sample.items():
            weights = loss.importance(samples)
            squares = weights * sum_squared_differences(loss, values, samples)
            parts[name] = np.bincount(self.blocks, squares) + (0.0 if weights.any() else np.nan)
        return parts

    def errors(self, model: Model) -> dict[str, float]:
        """Return the error of a model under each loss, as `compare` does."""
        return {name: float(np.sqrt(own.sum())) for name, own in self.compute(model).items()}

    def are_tied(self, one: Model, best: Model, loss: str) -> bool:
        """Return whether a model is worse than the best one by no more than noise.

        It is if the difference of both E² varies from block to block as much as it is large, if it
        is below that of a perfect model, or if the errors are equal to a few digits.
        """
        own, least = (self.compute(model)[loss] for model in (one, best))
        error, behind, uncertainty = compare_with_best(own, least, self.shares[loss])
        excess = own.sum() - least.sum()
        small = max(self.floor.get(loss, 0.0) ** 2, EQUAL * least.sum())
        return bool(excess <= small) or is_tied(error, behind, uncertainty)

    def locate_difference(self, one: Model, best: Model, loss: str) -> tuple[float, str]:
        """Return where most of the difference of two models' E² lies, after its share there."""
        excess = self.compute(one)[loss] - self.compute(best)[loss]
        sums = np.bincount(self.regions, excess, len(REGIONS))
        most = int(np.argmax(sums))
        return float(min(sums[most] / excess.sum(), 1.0)), REGIONS[most][1]
