"""What is held out of a fit: blocks of directions, not single samples; of a picture, regions of it.

Neighbouring samples are alike. A model that follows the noise of one predicts the next one, too;
it does not predict a whole block that it did not see. Pairs of directions whose values a symmetry
makes equal are in one block, and where an azimuth means little, blocks span all of it. Pixels are
in one block where they show the same region of the ball, under whatever light.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import half_azimuth, to_half_difference
from brdfkit.images.ball import Pixels
from brdfkit.model.evaluation import make_model
from brdfkit.model.samples import Samples
from brdfkit.regression import Loss, Picture, losses, regress
from brdfkit.regression.losses.loss import squared_differences
from brdfkit.regression.problem.subset import draw_part

# Of more samples a part of so many is drawn
PART = 8_000
# Rings of theta_h, narrow at the highlight; bands of theta_d; steps of |cosθ_i - cosθ_o|
RINGS, BANDS, STEPS = 8, 6, 5
# Rings of the ball's disc, equal in area, and sectors of each
DISC_RINGS, DISC_SECTORS = 4, 12


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Samples, the block and the fold of each (n,), and how much each counts, by a loss; under a
    `Picture` the pixels behind them, too.

    Fits see what is not in a fold; `importance` (n,): of all samples, and pixels, in E².
    """

    samples: Samples
    pixels: Pixels | None
    loss: Loss | Picture
    importance: np.ndarray
    blocks: np.ndarray
    folds: np.ndarray

    @classmethod
    def draw(cls, samples, loss, anisotropic, folds, rng, pixels=None):
        """Of `Samples`, with so many folds, and of `Pixels` under a `Picture`; `rng`: a
        generator."""
        of_samples = loss if pixels is None else losses.named["log"]
        if len(samples.wi) > PART:
            black = squared_differences(of_samples, np.zeros_like(samples.values), samples)
            samples, _ = draw_part(samples, of_samples.importance(samples) * black, PART, rng)
        blocks = number_blocks(samples.wi, samples.wo, anisotropic)
        own = assign_folds(blocks, folds, rng, "samples")
        importance = of_samples.importance(samples)
        if pixels is not None:
            regions = number_regions(pixels)
            own = np.concatenate([own, assign_folds(regions, folds, rng, "pixels")])
            blocks = np.concatenate([blocks, regions + blocks.max() + 1])
            of_pixels = pixels.weights / (pixels.weights.sum() * pixels.values.shape[1])
            importance = np.concatenate([loss.share * importance, of_pixels])
        return cls(samples, pixels, loss, importance, blocks, own)

    def regress(self, model, rows, **how):
        """The `Solution` of a model class on these `rows`, a mask (n,); `how`: as of `regress`."""
        of_samples, of_pixels = self._split(rows)
        pixels = self.pixels and self.pixels.at(of_pixels)
        return regress(model, self.samples.at(of_samples), self.loss, pixels=pixels, **how)

    def squares(self, model, solution, rows):
        """The squared differences of a model's `Solution` from what was measured, channels summed,
        of these `rows`, a mask (n,)."""
        of_samples, of_pixels = self._split(rows)
        samples = self.samples.at(of_samples)
        values = solution.eval(model, samples)
        if self.pixels is None:
            return squared_differences(self.loss, values, samples)
        pixels = self.pixels.at(of_pixels)
        brdf = make_model(model, solution.shapes, solution.weights).eval
        apart = squared_differences(self.loss.pixel_loss, pixels.look(brdf), _as_samples(pixels))
        return np.concatenate([squared_differences(losses.named["log"], values, samples), apart])

    def sum_by_block(self, values):
        """The sums (blocks,) of `values` (n,), each times its importance."""
        return np.bincount(self.blocks, self.importance * values)

    def _split(self, rows):
        """The rows of the samples, and those of the pixels."""
        return np.split(rows, [len(self.samples.wi)])


def number_blocks(wi, wo, anisotropic):
    """The number (n,) of the block of each direction pair (n, 3), in the order of theta_h.

    Blocks are some 15° wide, and narrower where theta_h is small.
    """
    theta_h, theta_d, phi_d = to_half_difference(wi, wo)
    ring = np.floor(RINGS * np.sqrt(theta_h / (np.pi / 2)))
    band = np.floor(BANDS * theta_d / (np.pi / 2))
    if anisotropic:
        phi_h = half_azimuth(wi, wo)
        # The difference vector's azimuth about the normal, up to an exchange of wi and wo
        turned = np.mod(phi_d + phi_h, np.pi)
        others = _sector(phi_h / (2 * np.pi), 2 * ring + 1), _sector(turned / np.pi, band + 1)
    else:
        others = (np.floor(STEPS * np.abs(wi[:, 2] - wo[:, 2])),)
    return _number(ring, band, *others)


def number_regions(pixels):
    """The number (n,) of the region of the ball that each of the `Pixels` shows, from the middle
    of its disc outwards."""
    # The direction to the eye in the point's frame; pairs that do not count are along the normal
    wo = pixels.wo.reshape(-1, pixels.pairs, 3)
    x, y, z = wo[np.arange(len(wo)), wo[..., 2].argmin(axis=1)].T
    ring = np.minimum(np.floor(DISC_RINGS * (1 - z**2)), DISC_RINGS - 1)
    return _number(ring, _sector(np.arctan2(y, x) / (2 * np.pi) % 1, DISC_SECTORS))


def assign_folds(blocks, folds, rng, what):
    """The fold (n,) of each of the samples or pixels, `what` they are, by its block (n,): in every
    `folds` blocks, one after the other, each block has another one.

    So each fold has its share of the highlight and of grazing angles. Raises `BrdfkitError` for
    fewer blocks than folds.
    """
    count = blocks.max() + 1
    if count < folds:
        raise BrdfkitError(
            f"folds = {folds}: the {what} lie in {count} blocks of directions; give fewer "
            "folds, at least 2, or measure more directions."
        )
    rounds = -(-count // folds)
    return np.concatenate([rng.permutation(folds) for _ in range(rounds)])[:count][blocks]


def _as_samples(pixels):
    """`Pixels` in the place of samples, for a loss that asks for no direction."""
    up = np.broadcast_to((0.0, 0.0, 1.0), (len(pixels.values), 3))
    return Samples(up, up, pixels.values, np.ones(len(up), bool), pixels.weights)


def _number(*keys):
    """The number (n,) of each row of keys (n,), in their order."""
    return np.unique(np.stack(keys, axis=1), axis=0, return_inverse=True)[1].ravel()


def _sector(share, count):
    """The number of the sector, of `count`, in which a `share` of the circle ends."""
    return np.floor(share * count)
