"""Pixels in blocks, in Dr.Jit's arrays, in the place of `blocks.py` of samples."""

from dataclasses import dataclass

import drjit as dr
import numpy as np

from brdfkit.core.jit import double_precision
from brdfkit.model.samples import Samples
from brdfkit.regression.problem.blocks import SIZE, Block

UP = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class PixelBlock(Block):
    """Pixels, repeated for each point; their columns are sums over their `pairs`, a `Block` whose
    importance is the share of a pair in its pixel."""

    pairs: Block

    def columns(self, columns, table):
        """As `Block.columns`; a slope that is not finite at a pair counts as 0, as it does in
        `require_finite_columns`."""
        lobes, each = len(columns.lobes), len(self.pairs.wi.x) // len(self.wi.x)
        found = self.pairs.columns(columns, table)
        slopes = [dr.select(dr.isfinite(slope), slope, 0) for slope in found[lobes:]]
        return [_add_up(self.pairs.importance * c, each) for c in (*found[:lobes], *slopes)]


class PixelBlocks:
    """The blocks of `Pixels`, whose `importance` is (n,), under a `loss` of pixels."""

    def __init__(self, pixels, importance, loss):
        self.pixels, self.importance, self.loss, self._kept = pixels, importance, loss, {}
        n, none = len(pixels.values), np.zeros((len(pixels.wi), 0))
        # A pixel has no direction of its own
        up, valid = np.tile(UP, (n, 1)), np.ones(n, bool)
        self.whole = Samples(up, up, pixels.values, valid, importance)
        self.pairs = Samples(pixels.wi, pixels.wo, none, none, pixels.shares)

    def __call__(self, count):
        """The blocks for `count` points. A single one is kept, several are made anew."""
        n, pairs = len(self.importance), self.pixels.pairs
        step = max(SIZE // (count * pairs), 1)
        if n <= step and count in self._kept:
            yield self._kept[count]
            return
        for start in range(0, n, step):
            rows = slice(start, min(start + step, n))
            of_pixels = Block.of(self.whole, self.importance, self.loss, rows, count)
            these = slice(rows.start * pairs, rows.stop * pairs)
            of_pairs = Block.of(self.pairs, self.pixels.shares, self.loss, these, count)
            block = PixelBlock(**vars(of_pixels), pairs=of_pairs)
            if n <= step:
                self._kept[count] = block
            yield block


def _add_up(array, each):
    """The sums of every `each` numbers of an array."""
    if double_precision.has_derivatives():
        return dr.block_sum(array, each)
    return double_precision.to_array(np.asarray(array).reshape(-1, each).sum(axis=1))
