"""The function that a fit minimises if pixels count beside samples: E² of a model on both.

A pixel is a weighted sum of the BRDF at several pairs of directions: a pixel of a picture, or an
albedo. Pixels are evaluated in blocks of Dr.Jit arrays, like samples in `blocks.py`.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import drjit as dr
import numpy as np

from brdfkit.core.array_types import FloatArray, JitFloat
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit import double_precision
from brdfkit.images.ball import Pixels
from brdfkit.model import Model
from brdfkit.model.samples import Samples
from brdfkit.regression.losses.loss import Loss
from brdfkit.regression.losses.named_losses import named
from brdfkit.regression.losses.picture import Picture
from brdfkit.regression.problem.blocks import BLOCK_SIZE, Block, Blocks
from brdfkit.regression.problem.columns import Columns
from brdfkit.regression.problem.not_finite import require_finite_columns
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.problem.subset import draw_subset

UP = (0.0, 0.0, 1.0)
LOG = named.by_sample["log"]
# Samples that are drawn for a `Picture`; to compare starts, fewer samples and this share of pixels
SAMPLES, FEW_SAMPLES, PIXEL_SHARE = 20_000, 2_000, 1 / 12


@dataclass(frozen=True, eq=False)
class PixelBlock(Block):
    """Pixels as Dr.Jit arrays, repeated for each point.

    `pairs`: a `Block` of the pairs of directions of these pixels; its importance is the share of a
    pair in its pixel.
    """

    pairs: Block

    def evaluate_columns(self, columns: Columns, table: FloatArray) -> list[JitFloat]:
        """Evaluate the columns of pixels, sums over their pairs; see `Block.evaluate_columns`.

        A slope that is not finite at a pair counts as 0, as in `require_finite_columns`.
        """
        lobes, each = len(columns.lobes), len(self.pairs.wi.x) // len(self.wi.x)
        arrays = self.pairs.evaluate_columns(columns, table)
        slopes = [dr.select(dr.isfinite(slope), slope, 0) for slope in arrays[lobes:]]
        return [_sum_groups(self.pairs.importance * c, each) for c in (*arrays[:lobes], *slopes)]


class PixelBlocks:
    """The blocks of `Pixels`, with the weights `importance` (n,), under a `loss` of pixels."""

    def __init__(self, pixels: Pixels, importance: FloatArray, loss: Loss) -> None:
        self.pixels, self.importance, self.loss = pixels, importance, loss
        self._cache: dict[int, PixelBlock] = {}
        n, none = len(pixels.values), np.zeros((len(pixels.wi), 0))
        # A pixel has no direction of its own
        up, valid = np.tile(UP, (n, 1)), np.ones(n, bool)
        self.whole = Samples(up, up, pixels.values, valid, importance)
        self.pairs = Samples(pixels.wi, pixels.wo, none, none, pixels.shares)

    def __call__(self, count: int) -> Iterator[Block]:
        """Yield the blocks for `count` points. A single block is cached, several are made anew."""
        n, pairs = len(self.importance), self.pixels.pairs
        step = max(BLOCK_SIZE // (count * pairs), 1)
        if n <= step and count in self._cache:
            yield self._cache[count]
            return
        for start in range(0, n, step):
            rows = slice(start, min(start + step, n))
            of_pixels = Block.from_samples(self.whole, self.importance, self.loss, rows, count)
            pair_rows = slice(rows.start * pairs, rows.stop * pairs)
            of_pairs = Block.from_samples(
                self.pairs, self.pixels.shares, self.loss, pair_rows, count
            )
            block = PixelBlock(**vars(of_pixels), pairs=of_pairs)
            if n <= step:
                self._cache[count] = block
            yield block


def _sum_groups(array: JitFloat, each: int) -> JitFloat:
    """Return the sums of every `each` numbers of a Dr.Jit array."""
    if double_precision.has_derivatives():
        return dr.block_sum(array, each)
    return double_precision.to_array(np.asarray(array).reshape(-1, each).sum(axis=1))


class PixelProblem(Problem):
    """E² of a model class on valid `Samples` under a `Loss`, plus E² on `Pixels` under another.

    `share`: the factor of E² of the samples; `pixel_weights` (n,): the weights of the `pixels`,
    whose loss is `pixel_loss`.
    """

    def __init__(
        self,
        model: type[Model],
        samples: Samples,
        loss: Loss,
        space: Space,
        share: float,
        pixels: Pixels,
        pixel_weights: FloatArray,
        pixel_loss: Loss,
    ) -> None:
        super().__init__(model, samples, loss, space)
        sample_weights = share * self.importance
        self.pixels = pixels
        self._sample_blocks = Blocks(samples, sample_weights, loss)
        self._pixel_blocks = PixelBlocks(pixels, pixel_weights, pixel_loss)
        self.importance = np.concatenate([sample_weights, pixel_weights])
        self.blocks = self._iterate_blocks

    def _iterate_blocks(self, count: int) -> Iterator[Block]:
        """Yield the blocks of samples, then the blocks of pixels."""
        yield from self._sample_blocks(count)
        yield from self._pixel_blocks(count)

    def _evaluate_block(
        self, block: Block, u: FloatArray, columns: list[JitFloat], *others: list[JitFloat]
    ) -> tuple[Any, ...]:
        if isinstance(block, PixelBlock):
            self._require_finite_pairs(block, u, columns)
        return super()._evaluate_block(block, u, columns, *others)

    def _require_finite_pairs(
        self, block: PixelBlock, u: FloatArray, columns: list[JitFloat]
    ) -> None:
        """Raise `BrdfkitError` for a lobe that is not finite at one of the pairs of pixels."""
        values = columns[: len(self.columns.lobes)]
        if not all(np.isfinite(np.array(value)).all() for value in values):
            arrays = [
                block.pairs.split_by_point(column)
                for column in self._evaluate_columns(block.pairs, u)
            ]
            require_finite_columns(self.columns, arrays, block.pairs, self.space, u)


class PictureProblem(PixelProblem):
    """E² of a model class under a `Picture`, on the `Pixels` of pictures and on valid `Samples`."""

    def __init__(
        self, model: type[Model], samples: Samples, picture: Picture, space: Space, pixels: Pixels
    ) -> None:
        weights = pixels.weights / (pixels.weights.sum() * samples.values.shape[1])
        super().__init__(
            *(model, samples, LOG, space, picture.share), *(pixels, weights, picture.pixel_loss)
        )
        self.picture = picture
        if self.clamped:
            raise BrdfkitError(
                f"{model.type_name()}: may be negative, and is clamped at 0 there, so that pixels "
                "are no sums of its lobes; choose another loss, or another model."
            )

    @classmethod
    def for_fit(
        cls,
        model: type[Model],
        samples: Samples,
        picture: Picture,
        space: Space,
        pixels: Pixels,
        rng: np.random.Generator,
    ) -> PictureProblem:
        """Return the problem on a part of the samples, which the generator `rng` draws."""
        samples = _draw_samples(model, samples, space, SAMPLES, rng)
        return cls(model, samples, picture, space, pixels)

    def make_smaller(self, rng: np.random.Generator) -> PictureProblem:
        """Return the same problem on few samples and pixels, to compare starts."""
        samples = _draw_samples(self.model, self.samples, self.space, FEW_SAMPLES, rng)
        pixels = self.pixels.take_first(math.ceil(len(self.pixels.values) * PIXEL_SHARE))
        return PictureProblem(self.model, samples, self.picture, self.space, pixels)


def _draw_samples(
    model: type[Model], samples: Samples, space: Space, size: int, rng: np.random.Generator
) -> Samples:
    """Draw about `size` of `Samples`; return all if there are at most twice as many."""
    if len(samples.wi) <= 2 * size:
        return samples
    part, _ = draw_subset(samples, Problem(model, samples, LOG, space).black_squares, size, rng)
    return part
