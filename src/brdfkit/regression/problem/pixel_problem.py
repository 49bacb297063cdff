"""Computes the function that a fit minimises if pixels count as well as samples.

A "pixel" is a weighted sum of the BRDF at several pairs of directions: a pixel of a picture, or a
directional albedo. Pixels are evaluated in blocks of Dr.Jit arrays, as samples are in `blocks.py`.
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
# About this number of samples is used in a fit to pictures, in addition to the pixels
SAMPLES = 20_000
# About this number of samples, and this share of the pixels, is used to compare start points
FEW_SAMPLES, PIXEL_SHARE = 2_000, 1 / 12


@dataclass(frozen=True, eq=False)
class PixelBlock(Block):
    """Some pixels as Dr.Jit arrays, repeated for each point of a search as in `Block`.

    `pairs`: block of the pairs of directions of these pixels; the importance of a pair is its
    weight in the sum of its pixel.
    """

    pairs: Block

    def evaluate_columns(self, columns: Columns, table: FloatArray) -> list[JitFloat]:
        """Evaluate the model's `columns` for the pixels, as weighted sums over their pairs.

        `table`: values of the shape parameters at each point (points, shapes). A slope that is not
        finite at a pair counts as 0, as in `require_finite_columns`.
        """
        lobes, each = len(columns.lobes), len(self.pairs.wi.x) // len(self.wi.x)
        arrays = self.pairs.evaluate_columns(columns, table)
        slopes = [dr.select(dr.isfinite(slope), slope, 0) for slope in arrays[lobes:]]
        return [
            _sum_consecutive_groups(self.pairs.importance * c, each)
            for c in (*arrays[:lobes], *slopes)
        ]


class PixelBlocks:
    """An iterable factory of the blocks of some pixels, for any number of points of a search.

    `importance`: weights of the n pixels in the squared loss (n,); `loss`: the loss that compares
    pixels.
    """

    def __init__(self, pixels: Pixels, importance: FloatArray, loss: Loss) -> None:
        self.pixels, self.importance, self.loss = pixels, importance, loss
        self._cache: dict[int, PixelBlock] = {}
        n, none = len(pixels.values), np.zeros((len(pixels.wi), 0))
        # A pixel has no direction of its own, but `Block` needs one for each of its entries
        up, valid = np.tile(UP, (n, 1)), np.ones(n, bool)
        self.whole = Samples(up, up, pixels.values, valid, importance)
        self.pairs = Samples(pixels.wi, pixels.wo, none, none, pixels.shares)

    def __call__(self, count: int) -> Iterator[Block]:
        """Yield the blocks of the pixels, with arrays repeated for `count` points.

        If all pixels fit into one block, it is cached; otherwise blocks are made again each time.
        """
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


def _sum_consecutive_groups(array: JitFloat, each: int) -> JitFloat:
    """Return the sums over groups of `each` consecutive numbers of a Dr.Jit array."""
    if double_precision.has_derivatives():
        return dr.block_sum(array, each)
    return double_precision.to_array(np.asarray(array).reshape(-1, each).sum(axis=1))


class PixelProblem(Problem):
    """The sum of two squared losses of a model: one of samples, and one of pixels.

    `samples`, `loss`, `share`: valid samples, their loss, and the factor of its square; `pixels`,
    `pixel_weights`, `pixel_loss`: pixels, their weights (n,) and their loss; `space`: search space
    of the model's shape parameters.
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
        """Yield the blocks of samples, then the blocks of pixels, for `count` points."""
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
        """Raise `BrdfkitError` if a lobe is not finite at one of the pairs of directions.

        The sum of a pixel would hide which pair it was. `u`: coordinates of the points; `columns`:
        columns of the pixels.
        """
        values = columns[: len(self.columns.lobes)]
        if not all(np.isfinite(np.array(value)).all() for value in values):
            arrays = [
                block.pairs.split_by_point(column)
                for column in self._evaluate_columns(block.pairs, u)
            ]
            require_finite_columns(
                self.columns, np.stack(arrays, axis=1), block.pairs, self.space, u
            )


class PictureProblem(PixelProblem):
    """The squared loss `Picture` of a model: of the pixels of pictures, and of samples."""

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
                f"{model.type_name()}: its values may be negative and are then clamped at 0, so "
                "that pixels are no sums of its lobes; choose another loss, or another model."
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
        """Return the problem of a fit. If there are many `samples`, `rng` draws some of them."""
        samples = _draw_samples(model, samples, space, SAMPLES, rng)
        return cls(model, samples, picture, space, pixels)

    def make_smaller(self, rng: np.random.Generator) -> PictureProblem:
        """Return the problem with few samples and pixels, to compare start points quickly."""
        samples = _draw_samples(self.model, self.samples, self.space, FEW_SAMPLES, rng)
        pixels = self.pixels.take_first_pixels(math.ceil(len(self.pixels.values) * PIXEL_SHARE))
        return PictureProblem(self.model, samples, self.picture, self.space, pixels)


def _draw_samples(
    model: type[Model], samples: Samples, space: Space, size: int, rng: np.random.Generator
) -> Samples:
    """Return about `size` of the samples, or all if there are at most twice as many.

    `model`, `space`: samples with much influence on a fit of this model are drawn more often.
    """
    if len(samples.wi) <= 2 * size:
        return samples
    part, _ = draw_subset(samples, Problem(model, samples, LOG, space).shares, size, rng)
    return part
