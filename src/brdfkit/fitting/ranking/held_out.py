"""Divides samples and pixels into blocks, which cross-validation holds out of a fit as a whole.

Neighbouring samples are alike, so a model that follows the noise of one sample also predicts the
next one, but not a whole block of directions. Direction pairs whose values are equal for reasons of
symmetry are in one block. A block spans all azimuths if the material is isotropic. Pixels that show
the same region of the ball are in one block, under every light.
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
from brdfkit.regression.problem.subset import Shares, draw_subset
from brdfkit.regression.regression import Solution

# Of larger measurements this number of samples is drawn at random
SAMPLE_LIMIT = 8_000
RINGS = 8  # number of intervals of the half angle theta_h, narrow at the highlight
BANDS = 6  # number of equal intervals of theta_d, the angle from half vector to incidence
STEPS = 5  # number of equal intervals of |cosθ_i - cosθ_o|
# Number of rings of equal area on the ball's disc, and of sectors in each
DISC_RINGS, DISC_SECTORS = 4, 12


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Samples, and for a `Picture` loss also pixels, divided into blocks and folds.

    Each fit leaves out one fold. `importance`, `blocks` and `folds` (n,) contain a number for each
    sample and then for each pixel: its weight in E², its block and its fold.
    """

    samples: Samples
    pixels: Pixels | None
    loss: Loss | Picture
    importance: FloatArray
    blocks: IntArray
    folds: IntArray

    @classmethod
    def divide(
        cls,
        samples: Samples,
        loss: Loss | Picture,
        anisotropic: bool,
        folds: int,
        rng: np.random.Generator,
        pixels: Pixels | None = None,
    ) -> HeldOut:
        """Divide `Samples`, and `Pixels` for a `Picture` loss, into blocks and random folds.

        Large measurements are represented by a random part of their samples.
        """
        of_samples = _find_sample_loss(loss)
        if len(samples.wi) > SAMPLE_LIMIT:
            black = sum_squared_differences(of_samples, np.zeros_like(samples.values), samples)
            parts = of_samples.importance(samples) * black
            samples, _ = draw_subset(
                samples, Shares.from_influence(samples, parts), SAMPLE_LIMIT, rng
            )
        blocks = assign_blocks(samples.wi, samples.wo, anisotropic)
        own = assign_folds(blocks, folds, rng, "samples")
        importance = of_samples.importance(samples)
        if pixels is not None:
            regions = assign_regions(pixels)
            own = np.concatenate([own, assign_folds(regions, folds, rng, "pixels")])
            blocks = np.concatenate([blocks, regions + blocks.max() + 1])
            of_pixels = pixels.weights / (pixels.weights.sum() * pixels.values.shape[1])
            share = loss.share if isinstance(loss, Picture) else 1.0
            importance = np.concatenate([share * importance, of_pixels])
        return cls(samples, pixels, loss, importance, blocks, own)

    def regress(self, model: type[Model], rows: BoolArray, **settings: Any) -> Solution:
        """Fit a model class to the samples and pixels in the mask `rows` (n,).

        `settings` are further arguments of `brdfkit.regression.regress`.
        """
        of_samples, of_pixels = self._split_mask(rows)
        pixels = self.pixels and self.pixels.at(of_pixels)
        return regress(model, self.samples.at(of_samples), self.loss, pixels=pixels, **settings)

    def compute_squared_differences(
        self, model: type[Model], solution: Solution, rows: BoolArray
    ) -> FloatArray:
        """Return the squared differences of a model's `Solution` from the measurement.

        They are sums over the channels, for the samples and pixels in the mask `rows` (n,).
        """
        of_samples, of_pixels = self._split_mask(rows)
        samples = self.samples.at(of_samples)
        values = solution.eval(model, samples)
        squares = sum_squared_differences(_find_sample_loss(self.loss), values, samples)
        if self.pixels is None or not isinstance(self.loss, Picture):
            return squares
        pixels = self.pixels.at(of_pixels)
        brdf = make_model(model, solution.shapes, solution.weights).eval
        apart = sum_squared_differences(
            self.loss.pixel_loss, pixels.evaluate(brdf), _to_samples_at_normal(pixels)
        )
        return np.concatenate([squares, apart])

    def sum_by_block(self, values: FloatArray) -> FloatArray:
        """Return the sums (blocks,) of `values` (n,) over each block, weighted by `importance`."""
        return np.bincount(self.blocks, self.importance * values).astype(float)

    def _split_mask(self, rows: BoolArray) -> list[BoolArray]:
        """Split a mask (n,) into the mask of the samples and the mask of the pixels."""
        return np.split(rows, [len(self.samples.wi)])


def _find_sample_loss(loss: Loss | Picture) -> Loss:
    """Return the loss of the samples: `loss` itself, or the log loss if `loss` is a `Picture`."""
    return losses.named.by_sample["log"] if isinstance(loss, Picture) else loss


def assign_blocks(wi: FloatArray, wo: FloatArray, anisotropic: bool) -> IntArray:
    """Return the block of similar directions (n,) to which each pair `wi`, `wo` (n, 3) belongs.

    Blocks are numbered in the order of the half angle theta_h. They are about 15° wide, and
    narrower where theta_h is small.
    """
    theta_h, theta_d, phi_d = to_half_difference(wi, wo)
    ring = np.floor(RINGS * np.sqrt(theta_h / (np.pi / 2)))
    band = np.floor(BANDS * theta_d / (np.pi / 2))
    if anisotropic:
        phi_h = half_azimuth(wi, wo)
        # The azimuth of the difference vector about the normal, modulo π, so that exchanging wi and
        # wo does not change it
        turned = np.mod(phi_d + phi_h, np.pi)
        others = [
            _find_sector(phi_h / (2 * np.pi), 2 * ring + 1),
            _find_sector(turned / np.pi, band + 1),
        ]
    else:
        others = [np.floor(STEPS * np.abs(wi[:, 2] - wo[:, 2]))]
    return _number_groups(ring, band, *others)


def assign_regions(pixels: Pixels) -> IntArray:
    """Return the region of the ball (n,) that each of the `Pixels` shows.

    Regions are numbered from the middle of the ball's disc outwards.
    """
    # A pixel stores several direction pairs, all with the same direction to the eye. Unused pairs
    # have the normal in its place, so the lowest of the directions belongs to a used pair
    wo = pixels.wo.reshape(-1, pixels.pairs, 3)
    x, y, z = wo[np.arange(len(wo)), wo[..., 2].argmin(axis=1)].T
    ring = np.minimum(np.floor(DISC_RINGS * (1 - z**2)), DISC_RINGS - 1)
    return _number_groups(ring, _find_sector(np.arctan2(y, x) / (2 * np.pi) % 1, DISC_SECTORS))


def assign_folds(blocks: IntArray, folds: int, rng: np.random.Generator, what: str) -> IntArray:
    """Return the fold (n,) of each sample or pixel from its block (n,).

    Each group of `folds` consecutive blocks is distributed at random over all folds, so that every
    fold gets its share of the highlight and of grazing angles. `what`, "samples" or "pixels", is
    for the error message. Raises `BrdfkitError` if there are fewer blocks than folds.
    """
    count = blocks.max() + 1
    if count < folds:
        raise BrdfkitError(
            f"folds = {folds}: the {what} lie in {count} blocks of directions; give fewer "
            "folds, at least 2, or measure more directions."
        )
    rounds = -(-count // folds)
    return np.concatenate([rng.permutation(folds) for _ in range(rounds)])[:count][blocks]


def _to_samples_at_normal(pixels: Pixels) -> Samples:
    """Return the values of `Pixels` as samples, for a loss that does not use their directions."""
    up = np.broadcast_to((0.0, 0.0, 1.0), (len(pixels.values), 3))
    return Samples(up, up, pixels.values, np.ones(len(up), bool), pixels.weights)


def _number_groups(*keys: FloatArray) -> IntArray:
    """Return for each row the number (n,) of its group of rows with equal `keys` (n,).

    The groups are in the order of their keys.
    """
    return np.unique(np.stack(keys, axis=1), axis=0, return_inverse=True)[1].ravel()


def _find_sector(share: FloatArray, count: float | FloatArray) -> FloatArray:
    """Return the index of that of `count` equal sectors which contains an angle.

    `share`: the angle, as a share of the range that the sectors divide.
    """
    return np.floor(share * count)
