"""Measures the BRDF of microgeometry with a virtual goniometer, which traces paths.

The result is a table. Each cell holds the mean of BRDF samples for the pair of directions at its
centre, and the standard error of this mean. A sample is the light along one path (`specimen.py`).
A pilot run estimates how many samples each cell needs. The samples of the pilot are thrown away,
because a mean is biased where its own samples decide how many of them are drawn.

By reciprocity the light may come from either direction of a pair. It comes from the one nearer to
the normal, so that more of the visible surface is lit, and fewer samples are 0.
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

# Default numbers of cells of the table along [phi_h,] theta_h, theta_d and phi_d
ISOTROPIC = (30, 30, 60)
ANISOTROPIC = (16, 20, 12, 24)
PILOT_SAMPLES = 64  # number of samples per cell in the pilot run
# Smallest number of samples of a cell; with fewer, the standard error is too uncertain
FEWEST_SAMPLES = 256
# Number of passes over all cells in which the samples are drawn: if Ctrl-C ends the measurement,
# all cells have about the same share of their samples
PASSES = 8
BATCH = 2**20  # number of paths that are traced at once, which bounds the memory
MOST_CELLS = 2**22  # largest number of cells of a table, which bounds the memory to 1 GB
MOST_SPP, LEAST_ERROR = 10**9, 1e-5  # limits of `spp` and `error`, at which a cell takes weeks


class Tally:
    """Collects BRDF samples of m pairs of directions, for their means and standard errors.

    `n`: number of samples of each pair (m,); `sums` and `squares`: sums of the samples, and of
    their squares, in R, G and B (m, 3).
    """

    def __init__(self, pairs: int) -> None:
        self.n = np.zeros(pairs, int)
        self.sums, self.squares = np.zeros((2, pairs, 3))

    def add(self, pair: IntArray, samples: FloatArray) -> None:
        """Add `samples` (n, 3); `pair` (n,), ascending, is the index of each sample's pair."""
        first = np.flatnonzero(np.diff(pair, prepend=-1))
        rows = pair[first]
        self.n[rows] += np.diff(first, append=len(pair))
        self.sums[rows] += np.add.reduceat(samples, first)
        self.squares[rows] += np.add.reduceat(samples**2, first)

    @property
    def mean(self) -> FloatArray:
        """The mean of the samples of each pair, (m, 3)."""
        return self.sums / self.n[:, None]

    @property
    def standard_error(self) -> FloatArray:
        """The standard error of the mean of each pair, (m, 3)."""
        n = self.n[:, None]
        variance = np.maximum(self.squares / n - self.mean**2, 0) * n / (n - 1)
        return np.sqrt(variance / n)

    @property
    def relative_error(self) -> FloatArray:
        """The relative standard error of R + G + B for each pair, (m,); infinite for a mean of 0.

        The errors of R, G and B are added, not their squares, because they rise and fall together.
        """
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
    """Measure the BRDF of a rough surface as a table, with the standard error of every cell.

    A virtual goniometer traces paths between the surface's facets. Ctrl-C ends the measurement
    early, with larger errors; before every cell has samples, it raises `KeyboardInterrupt`.

    Parameters
    ----------
    surface : HeightField
        The surface, made by ``gaussian``, ``brushed`` or ``woven`` of
        `brdfkit.materials.goniometer.microgeometry`.
    facets : dict, or several
        The dictionary of the Mitsuba BSDF of the facets, or one for each part of the surface. The
        BSDFs must be reciprocal, opaque and no mirrors.
    shape : (int, int, int) or (int, int, int, int), optional
        Numbers of cells of the table along theta_h, theta_d and phi_d, by default 30×30×60. For an
        anisotropic surface the cells along phi_h come first, by default 16×20×12×24.
    error : float, default 0.05
        The relative standard error that a cell is to reach, in the sum of its channels.
    spp : int, default 16384
        The largest number of samples per cell.
    max_bounces : int, default 8
        Largest number of reflections between the facets; light that needs more is lost.
    name : str, default "specimen"
        Name of the material.
    info : dict of str to str, optional
        Notes to add to `Measured.info`, beside those on the samples and their errors.
    seed : int, default 0
        Seed of the random numbers; equal seeds give equal values on one machine.
    progress : callable, optional
        A function that is called with the number of paths done and the number of all paths.

    Returns
    -------
    Measured
        A table with the channels R, G, B. Cells with a direction below the surface's mean plane are
        NaN.

    Raises
    ------
    BrdfkitError
        For arguments out of bounds, and for facets that are mirrors or let light through.

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
    shape = _check_table_shape(shape, surface.isotropic)
    error = to_number("error", error, LEAST_ERROR, 1)
    spp, seed = to_whole_number("spp", spp, 2, MOST_SPP), to_whole_number("seed", seed, 0)
    specimen = Specimen(surface, facets, max_bounces)
    above, light, eye = _choose_directions(shape)
    rng = np.random.default_rng(seed)

    # A pilot run with few samples shows how many samples each cell needs in each pass
    pilot = Tally(len(light))
    _add_samples(specimen, light, eye, np.full(len(light), PILOT_SAMPLES), rng, pilot)
    share = -(-_plan_sample_counts(pilot, above, error, spp) // PASSES)

    # Measure. After Ctrl-C, continue with the samples so far if every cell has those of one pass
    tally, total = Tally(len(light)), PASSES * int(share.sum())
    try:
        for _ in range(PASSES):
            _add_samples(specimen, light, eye, share, rng, tally, progress, total)
    except KeyboardInterrupt:
        if (tally.n < share).any():
            raise

    # Cells with a direction below the surface's mean plane stay NaN
    values, errors = np.full((2, *shape, 3), np.nan)
    values[above], errors[above] = tally.mean, tally.standard_error
    notes = _describe_measurement(tally, total) | dict(info or {})
    return Measured.from_table(values, name=name, info=notes, standard_error=errors)


def _choose_directions(shape: tuple[int, ...]) -> tuple[BoolArray, FloatArray, FloatArray]:
    """Return which cells of a table can be measured, and the directions to light and eye for each.

    The first result is a mask of the table's `shape`, False where a direction lies below the
    surface's mean plane. The others are unit vectors (m, 3) for the m cells where it is True.
    """
    wi, wo = Table(np.empty((*shape, 0))).directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    wi, wo = wi[above], wo[above]
    steeper = wi[:, 2:] > wo[:, 2:]
    return above, np.where(steeper, wi, wo), np.where(steeper, wo, wi)


def _plan_sample_counts(pilot: Tally, above: BoolArray, error: float, spp: int) -> IntArray:
    """Return the number of samples (m,) that each cell needs for the relative standard `error`.

    The estimate pools each cell with its neighbours: where few samples are large, the pilot's
    samples of one cell often miss the large ones. `above` is the mask of the m cells in the table.
    """
    from scipy.ndimage import uniform_filter

    def average_neighbours(values: FloatArray | float) -> FloatArray:
        """Average values (m,) over each cell and its neighbours; unmeasured cells count as 0."""
        grid = np.zeros(above.shape)
        grid[above] = values
        return uniform_filter(grid, 3)[above]

    # The squared relative error of the pilot run, for each cell pooled with its neighbours. `share`
    # is the share of these cells that were measured, the others count as 0
    share, mean = average_neighbours(1.0), average_neighbours(pilot.mean.sum(axis=1))
    variance = share * average_neighbours(pilot.standard_error.sum(axis=1) ** 2)
    around = np.divide(variance, mean**2, out=np.ones_like(mean), where=mean > 0)

    # The squared error is inversely proportional to the number of samples. That number follows from
    # the larger of two errors of the pilot run: of the pooled cells, and of the cell itself
    squares = np.maximum(around, np.minimum(pilot.relative_error, 1) ** 2)
    samples = PILOT_SAMPLES * squares / error**2
    return np.ceil(np.clip(samples, min(FEWEST_SAMPLES, spp), spp)).astype(int)


def _add_samples(
    specimen: Specimen,
    light: FloatArray,
    eye: FloatArray,
    counts: IntArray,
    rng: np.random.Generator,
    tally: Tally,
    progress: Progress | None = None,
    total: int = 0,
) -> None:
    """Trace paths for each pair of directions, `light` and `eye` (m, 3), and add them to the tally.

    `counts` (m,) are the numbers of paths. `progress` is called with the number of samples in the
    tally and with the number that is planned, `total`.
    """
    ends = np.cumsum(counts)
    for first in range(0, ends[-1], BATCH):
        numbers = np.arange(first, min(first + BATCH, ends[-1]))
        batch = np.searchsorted(ends, numbers, side="right")
        tally.add(batch, specimen.draw_samples(light, eye, batch, int(rng.integers(2**32))))
        if progress:
            progress(tally.n.sum(), total)


def _describe_measurement(tally: Tally, total: int) -> dict[str, str]:
    """Return notes on how a table was measured; `total` samples were planned."""
    median, most = np.percentile(tally.relative_error, (50, 95))
    notes = {
        "made by": f"brdfkit {__version__}, virtual goniometer",
        "samples per cell": f"{tally.n.min():,} to {tally.n.max():,}",
        "relative error": f"{median:.1%} in the median, {most:.1%} or less in 95 of 100 cells",
    }
    if tally.n.sum() < total:
        notes["interrupted"] = f"{tally.n.sum() / total:.0%} of the samples"
    return notes


def _check_table_shape(shape: Sequence[int] | None, isotropic: bool) -> tuple[int, ...]:
    """Return the table's `shape`, or the default one if it is None.

    Raises `BrdfkitError` for another number of axes, and for too many cells.
    """
    shape = tuple(shape or (ISOTROPIC if isotropic else ANISOTROPIC))
    dimensions = 3 if isotropic else 4
    if len(shape) != dimensions or min(shape) < 1:
        raise BrdfkitError(f"The table's shape {shape} should be {dimensions} numbers above 0.")
    if math.prod(shape) > MOST_CELLS:
        raise BrdfkitError(f"The table's shape {shape} has over {MOST_CELLS:,} cells; give fewer.")
    return shape
