"""`Prior`: what a set of known materials says about a material before it is measured.

Every channel of every known material is a row of logarithms y over the cells of `prior_cells.py`.
Their mean and first principal components are a linear model with Gaussian weights:

    y = μ + Q z + r,    z ~ N(0, I),    r ~ N(0, ℓ) independent in every cell

ℓ is estimated twice: from what the components leave of the materials that they were made from, and,
by folds, of materials that they were not made from. A completion takes its mean with the first and
its intervals with the second.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from math import sqrt

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.errors import BrdfkitError

VISIBLE = 450.0, 650.0  # wavelengths of linear sRGB [nm]
MARGIN = 100.0  # so far beyond a prior's wavelengths materials are still alike [nm]
RANK = 40  # number of principal components
FOLDS = 5
# The share of a base in a mixture with other materials. With 0.3, priors of 60 reconstructions left
# less error of 20 others than alone (0.107 for 0.111 at 20 directions), and of other databases
BASE_SHARE = 0.3
SEED = 0


@dataclass(frozen=True, eq=False)
class Prior:
    """Mean, components and remainders of the logarithms of known materials, in CELLS cells.

    `name`: what it was made from, in words. `mean` (CELLS,): μ plus the logarithm of the reference,
    so that completions need no reference. `components` (CELLS, rank): Q. `remainder`,
    `new_remainder` (CELLS,): ℓ on the materials of the prior and on others. `materials`: their
    number. `sources`: a line for each file, with its checksum. `terms`: the terms of use of the
    files. `wavelengths`: the shortest and the longest one of the materials [nm]; (0, 0) if their
    wavelengths do not matter.
    """

    name: str
    mean: FloatArray
    components: FloatArray
    remainder: FloatArray
    new_remainder: FloatArray
    materials: int
    sources: tuple[str, ...] = field(default=(), repr=False)
    terms: tuple[str, ...] = field(default=(), repr=False)
    wavelengths: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        if self.materials < 2 or self.rank < 1:
            raise BrdfkitError(
                f"the prior {self.name} was made of one material, which tells nothing of others; "
                "make it again of 30 or more, with brdfkit prior."
            )

    @property
    def rank(self) -> int:
        """The number of components."""
        return self.components.shape[1]

    def notes(self) -> dict[str, str]:
        """Return notes for `Measured.info`: what the prior was made from, and its terms of use.

        The checksum is that of the list of `sources`, by which the files can be recognised.
        """
        notes = {"prior": f"{self.name} ({self.materials} materials)"}
        if self.sources:
            digest = hashlib.sha256("\n".join(self.sources).encode()).hexdigest()
            notes["prior sources"] = f"{len(self.sources)} files, sha256 of their list {digest}"
        if self.terms:
            notes["prior terms"] = "; ".join(self.terms)
        return notes

    def require_wavelengths(self, name: str, wavelengths: AnyArray) -> None:
        """Raise `BrdfkitError` if a material was measured far from the prior's wavelengths [nm].

        `name` is the material's name. `wavelengths` are empty for colours, which are visible light.
        """
        low, high = self.wavelengths
        own = np.asarray(wavelengths, float) if len(wavelengths) else np.array(VISIBLE)
        if high and (own.min() < low - MARGIN or own.max() > high + MARGIN):
            raise BrdfkitError(
                f"{name} was measured from {own.min():g} to {own.max():g} nm, but the prior "
                f"{self.name} knows materials from {low:g} to {high:g} nm; use the prior that "
                "comes with brdfkit, or make one of materials at these wavelengths."
            )


def learn(
    logarithms: AnyArray, groups: AnyArray, base: Prior | None = None, rank: int = RANK
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return mean, components, remainder and new remainder of rows of `logarithms` (m, CELLS).

    `groups` (m,) are the rows' materials: channels of one material are in one fold. The components
    are each multiplied by their standard deviation. The materials of a `base` count as well, by
    `BASE_SHARE`.
    """
    mean, components = find_components(logarithms, rank, base)
    names = np.unique(groups)
    fold = np.random.default_rng(SEED).permutation(len(names)) % FOLDS
    squares = np.zeros_like(mean)
    for k in range(FOLDS):
        out = np.isin(groups, names[fold == k])
        others = find_components(logarithms[~out], rank, base)
        squares += np.sum(leave(logarithms[out], *others) ** 2, axis=0)
    remainder = np.mean(leave(logarithms, mean, components) ** 2, axis=0)
    new_remainder = squares / len(logarithms)
    if base is not None:
        # What the new components leave of the base's materials, beside what its own left of them
        left = leave(base.mean[None], mean, components)[0] ** 2
        left = left + np.sum(leave(base.components.T, np.zeros_like(mean), components) ** 2, axis=0)
        share = BASE_SHARE
        remainder = (1 - share) * remainder + share * (base.remainder + left)
        new_remainder = (1 - share) * new_remainder + share * (base.new_remainder + left)
    return mean, components, remainder, new_remainder


def find_components(
    logarithms: AnyArray, rank: int, base: Prior | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return the mean (CELLS,) and the first principal components (CELLS, rank), scaled."""
    mean = logarithms.mean(axis=0)
    rows = (logarithms - mean) / np.sqrt(max(len(logarithms) - 1, 1))
    if base is not None:
        # The covariance of a mixture of two distributions
        own, other = sqrt(1 - BASE_SHARE), sqrt(BASE_SHARE)
        between = own * other * (base.mean - mean)
        rows = np.concatenate([own * rows, other * base.components.T, between[None]])
        mean = (1 - BASE_SHARE) * mean + BASE_SHARE * base.mean
    # The Gram matrix of the rows is far smaller than the covariance of the cells
    _, vectors = np.linalg.eigh(rows @ rows.T)
    return mean, rows.T @ vectors[:, ::-1][:, : min(rank, len(rows) - 1)]


def leave(logarithms: AnyArray, mean: AnyArray, components: AnyArray) -> FloatArray:
    """Return what the least-squares combination of the components leaves of each row."""
    lengths = np.maximum(np.sum(components**2, axis=0), 1e-12)
    unit = components / np.sqrt(lengths)
    rows = logarithms - mean
    return rows - (rows @ unit) @ unit.T
