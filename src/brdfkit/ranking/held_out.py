"""What is held out of a fit: blocks of directions, not single samples.

Neighbouring samples are alike. A model that follows the noise of one predicts the next one, too;
it does not predict a whole block that it did not see. Pairs of directions whose values a symmetry
makes equal are in one block, and where an azimuth means little, blocks span all of it.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.errors import BrdfkitError
from brdfkit.fitting.loss import Loss, squares
from brdfkit.fitting.part import draw_part
from brdfkit.geometry.directions import half_azimuth, to_half_difference
from brdfkit.samples import Samples

# Of more samples a part of so many is drawn
PART = 8_000
# Rings of theta_h, narrow at the highlight; bands of theta_d; steps of |cosθ_i - cosθ_o|
RINGS, BANDS, STEPS = 8, 6, 5


@dataclass(frozen=True, eq=False)
class HeldOut:
    """Samples, the block and the fold of each (n,), and how much each counts, by a loss.

    Fits see `samples` without those of a fold; `importance` (n,): of all samples, as
    `Loss.importance`.
    """

    samples: Samples
    loss: Loss
    importance: np.ndarray
    blocks: np.ndarray
    folds: np.ndarray

    @classmethod
    def draw(cls, samples, loss, anisotropic, folds, rng):
        """Of `Samples`, with so many folds; `rng`: a generator."""
        if len(samples.wi) > PART:
            black = squares(loss, np.zeros_like(samples.values), samples)
            samples, _ = draw_part(samples, loss.importance(samples) * black, PART, rng)
        blocks = number_blocks(samples.wi, samples.wo, anisotropic)
        count = blocks.max() + 1
        if count < folds:
            raise BrdfkitError(
                f"folds = {folds}: the samples lie in {count} blocks of directions; give fewer "
                "folds, at least 2, or measure more directions."
            )
        own = assign_folds(count, folds, rng)[blocks]
        return cls(samples, loss, loss.importance(samples), blocks, own)

    def sum_by_block(self, values):
        """The sums (blocks,) of `values` (n,), each times its sample's importance."""
        return np.bincount(self.blocks, self.importance * values)


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
    keys = np.stack([ring, band, *others], axis=1)
    return np.unique(keys, axis=0, return_inverse=True)[1].ravel()


def assign_folds(blocks, folds, rng):
    """The fold (blocks,) of each block: in every `folds` blocks, one after the other, another one.

    So each fold has its share of the highlight and of grazing angles.
    """
    rounds = -(-blocks // folds)
    return np.concatenate([rng.permutation(folds) for _ in range(rounds)])[:blocks]


def _sector(share, count):
    """The number of the sector, of `count`, in which a `share` of the circle ends."""
    return np.floor(share * count)
