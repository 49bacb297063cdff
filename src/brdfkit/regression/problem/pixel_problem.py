"""What a fit minimises where pixels count beside samples: E² of a model on both."""

import numpy as np

from brdfkit.regression.problem.blocks import Blocks
from brdfkit.regression.problem.not_finite import require_finite_columns
from brdfkit.regression.problem.pixel_blocks import PixelBlock, PixelBlocks
from brdfkit.regression.problem.problem import Problem


class PixelProblem(Problem):
    """E² of a model class on valid `Samples` under a `Loss`, and on `Pixels` under another.

    `share`: how much E² of the samples counts; `of_pixels` (n,): how much each of the `pixels`
    does, under `loss_of_pixels`.
    """

    def __init__(self, model, samples, loss, space, share, pixels, of_pixels, loss_of_pixels):
        super().__init__(model, samples, loss, space)
        of_samples = share * self.importance
        self.pixels = pixels
        self._of_samples = Blocks(samples, of_samples, loss)
        self._of_pixels = PixelBlocks(pixels, of_pixels, loss_of_pixels)
        self.importance = np.concatenate([of_samples, of_pixels])
        self.blocks = self._all_blocks

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
