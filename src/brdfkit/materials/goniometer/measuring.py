"""A virtual goniometer: measures the BRDF of microgeometry by tracing paths.

A cell of the table holds the mean of the samples at the directions of its centre, and the standard
error of this mean, from the samples' variance. `specimen.py` explains one sample. A pilot run
estimates how many samples each cell needs. Its samples are thrown away, because a mean is biased
where its own samples decide how many of them there are.

By reciprocity the light may come from either direction of a pair. It comes from the steeper one,
so that more of the visible surface is lit, and fewer samples are 0.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_number, to_whole_number, wrong_value_error
from brdfkit.core.array_types import BoolArray, FloatArray, IntArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress
from brdfkit.core.version import __version__
from brdfkit.materials.goniometer.microgeometry import HeightField
from brdfkit.materials.goniometer.specimen import Specimen
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Table

ISOTROPIC = (30, 30, 60)
ANISOTROPIC = (16, 20, 12, 24)
PILOT_SAMPLES = 64  # for each cell
FEWEST_SAMPLES = 256  # for each cell: the standard error of fewer is itself too uncertain
PASSES = 8  # over all cells: after Ctrl-C each cell has the same part of its samples
BATCH = 2**20  # paths at once, to bound the memory
MOST_CELLS = 2**22  # to bound the memory to 1 GB; three times the cells of a MERL table
MOST_SPP, LEAST_ERROR = 10**9, 1e-5  # with these, a cell takes weeks


class Tally:
    """The samples of m pairs of directions: their number (m,), sum and sum of squares (m, 3)."""

    def __init__(self, pairs: int) -> None:
        self.n = np.zeros(pairs, int)
        self.sums, self.squares = np.zeros((2, pairs, 3))

    def add(self, pair: IntArray, samples: FloatArray) -> None:
        """Add `samples` (n, 3); `pair` (n,) is the index of each sample's pair, ascending."""
        first = np.flatnonzero(np.diff(pair, prepend=-1))
        rows = pair[first]
        self.n[rows] += np.diff(first, append=len(pair))
        self.sums[rows] += np.add.reduceat(samples, first)
        self.squares[rows] += np.add.reduceat(samples**2, first)

    @property
    def mean(self) -> FloatArray:
        """The mean of the samples, (m, 3)."""
        return self.sums / self.n[:, None]

    @property
    def standard_error(self) -> FloatArray:
        """The standard error of the mean, (m, 3)."""
        n = self.n[:, None]
        variance = np.maximum(self.squares / n - self.mean**2, 0) * n / (n - 1)
        return np.sqrt(variance / n)

    @property
    def relative_error(self) -> FloatArray:
        """The relative error of the sum of the channels, (m,); infinite where the sum is 0."""
        errors, means = self.standard_error.sum(axis=1), self.mean.sum(axis=1)
        return np.divide(errors, means, out=np.full(len(means), np.inf), where=means > 0)


@in_turn
def measure(
    surface: HeightField,
    facets: dict[str, Any] | Sequence[dict[str, Any]],
    *,
    shape: Sequence[int] | None = None,
    error: float = 0.05,
    spp: int = 16384,
    max_bounces: int = 8,
    name: str = "specimen",
    info: Mapping[str, str] | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Measured:
    """Measure a table of a surface's BRDF, with the standard error of every cell.

    A virtual goniometer path-traces the surface's microgeometry. Ctrl-C ends it early, with larger
    errors; before every cell has some samples, Ctrl-C raises `KeyboardInterrupt`.

    Parameters
    ----------
    surface : HeightField
        The surface, made by ``gaussian``, ``brushed`` or ``woven`` of
        `brdfkit.materials.goniometer.microgeometry`.
    facets : dict, or several
        The dictionary of one of Mitsuba's BSDFs, or one for each part of the surface. The BSDFs
        must be reciprocal, opaque and no mirrors.
    shape : (int, int, int) or (int, int, int, int), optional
        Cells of the table: 30×30×60 (theta_h, theta_d, phi_d) where the surface is isotropic, else
        16×20×12×24 (phi_h before them).
    error : float, default 0.05
        The relative standard error that a cell is to reach, in the sum of its channels.
    spp : int, default 16384
        The largest number of samples per cell.
    max_bounces : int, default 8
        Largest number of reflections between the facets; light that needs more is lost.
    name : str, default "specimen"
        Name of the material.
    info : dict of str to str, optional
        Notes to add to the notes of the measurement.
    seed : int, default 0
        Seed of the samples; equal seeds give equal values on one machine.
    progress : callable, optional
        Called with (paths done, paths in all).

    Returns
    -------
    Measured
        A table with the channels R, G, B; cells with a direction below the plane are NaN.

    Raises
    ------
    BrdfkitError
        For arguments out of bounds, and for facets that cannot be measured.

    Examples
    --------
    >>> from brdfkit.materials.goniometer.microgeometry import gaussian
    >>> measure(gaussian(slope=0.3), {"type": "diffuse"}).standard_error.shape  # doctest: +SKIP
    (54000, 3)
    """
    if not isinstance(surface, HeightField):
        raise wrong_value_error("surface", surface, "a HeightField, such as gaussian()")
    if isinstance(facets, str):
        raise wrong_value_error("facets", facets, "the dictionary of a BSDF")
    shape = _check_shape(shape, surface.isotropic)
    error = to_number("error", error, LEAST_ERROR, 1)
    spp, seed = to_whole_number("spp", spp, 2, MOST_SPP), to_whole_number("seed", seed, 0)
    specimen = Specimen(surface, facets, max_bounces)
    above, light, eye = _place_light_and_eye(shape)
    rng = np.random.default_rng(seed)

    # The pilot run, and the samples that each cell gets in a pass
    pilot = Tally(len(light))
    _trace(specimen, light, eye, np.full(len(light), PILOT_SAMPLES), rng, pilot)
    share = -(-_plan_samples(pilot, above, error, spp) // PASSES)

    # The measurement
    tally, total = Tally(len(light)), PASSES * int(share.sum())
    try:
        for _ in range(PASSES):
            _trace(specimen, light, eye, share, rng, tally, progress, total)
    except KeyboardInterrupt:
        if (tally.n < share).any():
            raise

    # The table, NaN below the plane
    values, errors = np.full((2, *shape, 3), np.nan)
    values[above], errors[above] = tally.mean, tally.standard_error
    notes = _describe(tally, total) | dict(info or {})
    return Measured.from_table(values, name=name, info=notes, standard_error=errors)


def _place_light_and_eye(shape: tuple[int, ...]) -> tuple[BoolArray, FloatArray, FloatArray]:
    """Return a mask of the cells of a table above the plane, and the light and the eye of each.

    The light and the eye are directions (m, 3).
    """
    wi, wo = Table(np.empty((*shape, 0))).directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    wi, wo = wi[above], wo[above]
    steeper = wi[:, 2:] > wo[:, 2:]
    return above, np.where(steeper, wi, wo), np.where(steeper, wo, wi)


def _plan_samples(pilot: Tally, above: BoolArray, error: float, spp: int) -> IntArray:
    """Return the number of samples (m,) that each cell needs for the relative standard `error`.

    Where a sample is rarely large, the few samples of the pilot in one cell often miss the large
    ones, so that the cells around it are pooled with it.
    """
    from scipy.ndimage import uniform_filter

    def pool(values: FloatArray | float) -> FloatArray:
        """Average over 3 × 3 × ... cells; cells below the plane count as 0."""
        grid = np.zeros(above.shape)
        grid[above] = values
        return uniform_filter(grid, 3)[above]

    # Squared relative error of the pilot in the pooled cells; a `share` of them is above the plane
    share, mean = pool(1.0), pool(pilot.mean.sum(axis=1))
    # The errors of the channels rise and fall together, so that they add up, not their squares
    variance = share * pool(pilot.standard_error.sum(axis=1) ** 2)
    around = np.divide(variance, mean**2, out=np.ones_like(mean), where=mean > 0)

    # The larger of it and the cell's own error falls as 1 / number of samples
    squares = np.maximum(around, np.minimum(pilot.relative_error, 1) ** 2)
    samples = PILOT_SAMPLES * squares / error**2
    return np.ceil(np.clip(samples, min(FEWEST_SAMPLES, spp), spp)).astype(int)


def _trace(
    specimen: Specimen,
    light: FloatArray,
    eye: FloatArray,
    counts: IntArray,
    rng: np.random.Generator,
    tally: Tally,
    progress: Progress | None = None,
    total: int = 0,
) -> None:
    """Add `counts` (m,) samples of each pair of directions, light and eye (m, 3), to the tally.

    `progress` is called with the number of samples in the tally, and with the `total`.
    """
    ends = np.cumsum(counts)
    for first in range(0, ends[-1], BATCH):
        numbers = np.arange(first, min(first + BATCH, ends[-1]))
        batch = np.searchsorted(ends, numbers, side="right")
        tally.add(batch, specimen.draw_samples(light, eye, batch, int(rng.integers(2**32))))
        if progress:
            progress(tally.n.sum(), total)


def _describe(tally: Tally, total: int) -> dict[str, str]:
    """Return notes on a measurement for which `total` samples were planned."""
    median, most = np.percentile(tally.relative_error, (50, 95))
    notes = {
        "made by": f"brdfkit {__version__}, virtual goniometer",
        "samples a cell": f"{tally.n.min():,} to {tally.n.max():,}",
        "relative error": f"{median:.1%} in the median, {most:.1%} or less in 95 of 100 cells",
    }
    if tally.n.sum() < total:
        notes["interrupted"] = f"{tally.n.sum() / total:.0%} of the samples"
    return notes


def _check_shape(shape: Sequence[int] | None, isotropic: bool) -> tuple[int, ...]:
    """Return the shape of the table, by default the usual one; raise `BrdfkitError` if unfit."""
    shape = tuple(shape or (ISOTROPIC if isotropic else ANISOTROPIC))
    dimensions = 3 if isotropic else 4
    if len(shape) != dimensions or min(shape) < 1:
        raise BrdfkitError(f"The table's shape {shape} should be {dimensions} numbers above 0.")
    if math.prod(shape) > MOST_CELLS:
        raise BrdfkitError(f"The table's shape {shape} is above {MOST_CELLS:,} cells; give fewer.")
    return shape
