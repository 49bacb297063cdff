"""What a fit by `Picture` minimises: E² of a model on pixels, and a share of it on samples."""

import math

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.fitting.blocks import Blocks
from brdfkit.fitting.named_losses import losses
from brdfkit.fitting.not_finite import require_finite_columns
from brdfkit.fitting.part import draw_part
from brdfkit.fitting.pixel_blocks import PixelBlock, PixelBlocks
from brdfkit.fitting.problem import Problem

LOG = losses.by_sample["log"]
# So many samples stand for all; where starts are compared, fewer do, and a share of the pixels
SAMPLES, FEW_SAMPLES, FEW_PIXELS = 20_000, 2_000, 1 / 12


class PictureProblem(Problem):
    """E² of a model class under a `Picture`, on `Pixels` and on valid `Samples`."""

    def __init__(self, model, samples, picture, space, pixels):
        super().__init__(model, samples, LOG, space)
        if self.clamped:
            raise BrdfkitError(
                f"{model.type_name()}: may be negative, and is clamped at 0 there, so that pixels "
                "are no sums of its lobes; choose another loss, or another model."
            )
        self.picture, self.pixels = picture, pixels
        of_samples = picture.share * self.importance
        of_pixels = pixels.weights / (pixels.weights.sum() * self.channels)
        self._of_samples = Blocks(samples, of_samples, LOG)
        self._of_pixels = PixelBlocks(pixels, of_pixels, picture.of_pixels)
        self.importance = np.concatenate([of_samples, of_pixels])
        self.blocks = self._all_blocks

    @classmethod
    def of(cls, model, samples, picture, space, pixels, rng):
        """The problem on a part of many samples, which the generator `rng` draws."""
        return cls(model, _part(model, samples, space, SAMPLES, rng), picture, space, pixels)

    def few(self, rng):
        """The same problem on few samples and pixels, by which starts are compared."""
        samples = _part(self.model, self.samples, self.space, FEW_SAMPLES, rng)
        pixels = self.pixels.first(math.ceil(len(self.pixels.values) * FEW_PIXELS))
        return PictureProblem(self.model, samples, self.picture, self.space, pixels)

    def _all_blocks(self, count):
        yield from self._of_samples(count)
        yield from self._of_pixels(count)

    def _evaluate(self, block, u, columns, *others):
        if isinstance(block, PixelBlock):
            self._require_finite_pairs(block, u, columns)
        return super()._evaluate(block, u, columns, *others)

    def _require_finite_pairs(self, block, u, columns):
        """Raise `BrdfkitError` for a lobe that is not finite at one of the pairs of pixels."""
        values = columns[: len(self.columns.lobes)]
        if not all(np.isfinite(np.array(value)).all() for value in values):
            found = [block.pairs.fold(column) for column in self._columns(block.pairs, u)]
            require_finite_columns(self.columns, found, block.pairs, self.space, u)


def _part(model, samples, space, size, rng):
    """About `size` of `Samples`, or all where they are not many more."""
    if len(samples.wi) <= 2 * size:
        return samples
    part, _ = draw_part(samples, Problem(model, samples, LOG, space).black, size, rng)
    return part
