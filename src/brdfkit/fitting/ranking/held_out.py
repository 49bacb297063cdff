"""Divides samples and pixels into blocks, which cross-validation holds out of a fit.

Neighbouring samples are alike, so a model that follows the noise of one sample also predicts the
next one; it does not predict a whole block of directions that it was not fitted to. Direction pairs
whose values are equal by symmetry are in one block. Where the azimuth hardly matters, a block spans
all azimuths. Pixels that show the same region of the ball are in one block, under every light.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import half_azimuth, to_half_difference
from brdfkit.images.ball import Pixels
from brdfkit.model import Model
from brdfkit.model.evaluation import make_model
from brdfkit.model.samples import Samples
from brdfkit.regression import Loss, Picture, losses, regress
from brdfkit.regression.losses.loss import sum_squared_differences
from brdfkit.regression.problem.subset import draw_subset
from brdfkit.regression.regression import Solution

# Larger measurements are represented by this number of samples, drawn at random
SAMPLE_LIMIT = 8_000
# Numbers of rings of theta_h, narrow at the highlight; of bands of theta_d; of steps of
# |cosθ_i - cosθ_o|
RINGS, BANDS, STEPS = 8, 6, 5
# Numbers of rings of the ball's disc, equal in area, and of sectors of each ring
DISC_RINGS, DISC_SECTORS = 4, 12


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Samples divided into blocks and folds; with a `Picture` loss, pixels behind the samples.

    A fit uses the rows outside of one fold. `importance`, `blocks` and `folds` (n,) have a number
    for each sample and then for each pixel: how much it counts in E², its block and its fold.
    """

    samples: Samples
    pixels: Pixels | None
    loss: Loss | Picture
    importance: FloatArray
    blocks: IntArray
    folds: IntArray

    @classmethod
    def draw(
        cls,
        samples: Samples,
        loss: Loss | Picture,
        anisotropic: bool,
        folds: int,
        rng: np.random.Generator,
        pixels: Pixels | None = None,
    ) -> HeldOut:
        """Divide `Samples`, and for a `Picture` loss `Pixels`, at random into blocks and folds."""
        of_samples = _loss_of_samples(loss)
        if len(samples.wi) > SAMPLE_LIMIT:
            black = sum_squared_differences(of_samples, np.zeros_like(samples.values), samples)
            parts = of_samples.importance(samples) * black
            samples, _ = draw_subset(samples, parts, SAMPLE_LIMIT, rng)
        blocks = number_blocks(samples.wi, samples.wo, anisotropic)
        own = assign_folds(blocks, folds, rng, "samples")
        importance = of_samples.importance(samples)
        if pixels is not None:
            regions = number_regions(pixels)
            own = np.concatenate([own, assign_folds(regions, folds, rng, "pixels")])
            blocks = np.concatenate([blocks, regions + blocks.max() + 1])
            of_pixels = pixels.weights / (pixels.weights.sum() * pixels.values.shape[1])
            share = loss.share if isinstance(loss, Picture) else 1.0
            importance = np.concatenate([share * importance, of_pixels])
        return cls(samples, pixels, loss, importance, blocks, own)

    def regress(self, model: type[Model], rows: BoolArray, **settings: Any) -> Solution:
        """Fit a model class to the `rows` of a mask (n,), with the settings of `regress`."""
        of_samples, of_pixels = self._split(rows)
        pixels = self.pixels and self.pixels.at(of_pixels)
        return regress(model, self.samples.at(of_samples), self.loss, pixels=pixels, **settings)

    def square_differences(
        self, model: type[Model], solution: Solution, rows: BoolArray
    ) -> FloatArray:
        """Return the squared differences between a model's `Solution` and the measurement.

        They are summed over the channels, for the `rows` of a mask (n,).
        """
        of_samples, of_pixels = self._split(rows)
        samples = self.samples.at(of_samples)
        values = solution.eval(model, samples)
        squares = sum_squared_differences(_loss_of_samples(self.loss), values, samples)
        if self.pixels is None or not isinstance(self.loss, Picture):
            return squares
        pixels = self.pixels.at(of_pixels)
        brdf = make_model(model, solution.shapes, solution.weights).eval
        apart = sum_squared_differences(
            self.loss.pixel_loss, pixels.look(brdf), _as_samples(pixels)
        )
        return np.concatenate([squares, apart])

    def sum_by_block(self, values: FloatArray) -> FloatArray:
        """Return the sums (blocks,) of `values` (n,), each times its importance."""
        sums: FloatArray = np.bincount(self.blocks, self.importance * values).astype(float)
        return sums

    def _split(self, rows: BoolArray) -> list[BoolArray]:
        """Split a mask (n,) into the mask of the samples and the mask of the pixels."""
        return np.split(rows, [len(self.samples.wi)])


def _loss_of_samples(loss: Loss | Picture) -> Loss:
    """Return the loss by which samples count: the log loss beside a `Picture`, else `loss`."""
    if not isinstance(loss, Picture):
        return loss
    log = losses.named["log"]
    assert isinstance(log, Loss)
    return log


def number_blocks(wi: FloatArray, wo: FloatArray, anisotropic: bool) -> IntArray:
    """Return the number (n,) of the block of each direction pair (n, 3), in the order of theta_h.

    Blocks are about 15° wide, and narrower where theta_h is small.
    """
    theta_h, theta_d, phi_d = to_half_difference(wi, wo)
    ring = np.floor(RINGS * np.sqrt(theta_h / (np.pi / 2)))
    band = np.floor(BANDS * theta_d / (np.pi / 2))
    if anisotropic:
        phi_h = half_azimuth(wi, wo)
        # The difference vector's azimuth about the normal, up to an exchange of wi and wo
        turned = np.mod(phi_d + phi_h, np.pi)
        others = [_sector(phi_h / (2 * np.pi), 2 * ring + 1), _sector(turned / np.pi, band + 1)]
    else:
        others = [np.floor(STEPS * np.abs(wi[:, 2] - wo[:, 2]))]
    return _number(ring, band, *others)


def number_regions(pixels: Pixels) -> IntArray:
    """Return the number (n,) of the region of the ball that each of the `Pixels` shows.

    Regions are numbered from the middle of the ball's disc outwards.
    """
    # The direction to the eye in the frame of the point; unused pairs are along the normal
    wo = pixels.wo.reshape(-1, pixels.pairs, 3)
    x, y, z = wo[np.arange(len(wo)), wo[..., 2].argmin(axis=1)].T
    ring = np.minimum(np.floor(DISC_RINGS * (1 - z**2)), DISC_RINGS - 1)
    return _number(ring, _sector(np.arctan2(y, x) / (2 * np.pi) % 1, DISC_SECTORS))


def assign_folds(blocks: IntArray, folds: int, rng: np.random.Generator, what: str) -> IntArray:
    """Return the fold (n,) of each sample or pixel, from the number (n,) of its block.

    Of each `folds` consecutive blocks, every one is in another fold. So each fold has its share of
    the highlight and of grazing angles. `what` names the samples or pixels in errors. Raises
    `BrdfkitError` for fewer blocks than folds.
    """
    count = blocks.max() + 1
    if count < folds:
        raise BrdfkitError(
            f"folds = {folds}: the {what} lie in {count} blocks of directions; give fewer "
            "folds, at least 2, or measure more directions."
        )
    rounds = -(-count // folds)
    return np.concatenate([rng.permutation(folds) for _ in range(rounds)])[:count][blocks]


def _as_samples(pixels: Pixels) -> Samples:
    """Return `Pixels` as samples at the normal, for a loss that does not use directions."""
    up = np.broadcast_to((0.0, 0.0, 1.0), (len(pixels.values), 3))
    return Samples(up, up, pixels.values, np.ones(len(up), bool), pixels.weights)


def _number(*keys: FloatArray) -> IntArray:
    """Return the rank (n,) of each row among the different rows of the `keys` (n,)."""
    ranks: IntArray = np.unique(np.stack(keys, axis=1), axis=0, return_inverse=True)[1].ravel()
    return ranks


def _sector(share: FloatArray, count: float | FloatArray) -> FloatArray:
    """Return which of `count` sectors of a circle holds the point at a `share` of its length."""
    sector: FloatArray = np.floor(share * count)
    return sector
