"""A virtual goniometer: measures the BRDF of microgeometry by tracing paths.

A cell of the table holds the mean of the samples at the directions of its centre, and the standard
error of this mean, from the samples' variance. `specimen.py` explains one sample. A pilot run
estimates how many samples each cell needs. Its samples are thrown away: a mean is biased where its
own samples decided how many there are.

By reciprocity the light may come from either direction of a pair. It comes from the steeper one:
then more of what the eye sees is lit, and fewer samples are 0.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress
from brdfkit.core.version import __version__
from brdfkit.materials.goniometer.microgeometry import HeightField
from brdfkit.materials.goniometer.specimen import Specimen
from brdfkit.materials.goniometer.tally import Tally
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Table

ISOTROPIC = (30, 30, 60)
ANISOTROPIC = (16, 20, 12, 24)
PILOT = 64  # samples a cell
LEAST = 256  # samples a cell: the standard error of fewer is itself too uncertain
PASSES = 8  # over all cells: after Ctrl-C each cell has the same part of its samples
BATCH = 2**20  # paths at once: bounds the memory
MOST_CELLS = 2**22  # bounds the memory to 1 GB; three times the cells of a MERL table
MOST_SPP, LEAST_ERROR = 10**9, 1e-5  # bounds of the arguments; there, a cell takes weeks


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
    errors; before every cell has its share it is raised.

    Parameters
    ----------
    surface : HeightField
        As `brdfkit.materials.goniometer.microgeometry` makes them: ``gaussian``, ``brushed``,
        ``woven``.
    facets : dict, or several
        The dictionary of a BSDF of Mitsuba's, or one for each part of the surface: reciprocal,
        opaque and no mirror.
    shape : (int, int, int) or (int, int, int, int), optional
        Cells of the table: 30×30×60 (theta_h, theta_d, phi_d) where the surface is isotropic, else
        16×20×12×24 (phi_h before them).
    error : float, default 0.05
        The relative standard error, of the channels together, that a cell is to reach.
    spp : int, default 16384
        Samples per cell, at most.
    max_bounces : int, default 8
        Largest number of reflections between the facets; light that needs more is lost.
    name : str, default "specimen"
        Name of the material.
    info : dict of str to str, optional
        Notes to add to those of the measurement.
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
        raise BrdfkitError(f"surface = {surface!r} should be a HeightField, such as gaussian().")
    if isinstance(facets, str):
        raise BrdfkitError(f"facets = {facets!r} should be the dictionary of a BSDF.")
    shape = tuple(shape or (ISOTROPIC if surface.isotropic else ANISOTROPIC))
    _require_valid(surface, shape, error, spp, seed)
    specimen = Specimen(surface, facets, max_bounces)
    above, light, eye = _place_light_and_eye(shape)
    rng = np.random.default_rng(seed)

    # the pilot run, and the samples that each cell gets in a pass
    pilot = Tally(len(light))
    _trace(specimen, light, eye, np.full(len(light), PILOT), rng, pilot)
    share = -(-_plan_samples(pilot, above, error, spp) // PASSES)

    # the measurement
    tally, total = Tally(len(light)), PASSES * share.sum()
    try:
        for _ in range(PASSES):
            _trace(specimen, light, eye, share, rng, tally, progress, total)
    except KeyboardInterrupt:
        if (tally.n < share).any():
            raise

    # the table; NaN below the plane
    values, errors = np.full((2, *shape, 3), np.nan)
    values[above], errors[above] = tally.mean, tally.standard_error
    notes = _notes(tally, total) | dict(info or {})
    return Measured.from_table(values, name=name, info=notes, standard_error=errors)


def _place_light_and_eye(shape):
    """Which cells of a table are above the plane; of these, the light and the eye, both (m, 3)."""
    wi, wo = Table(np.empty((*shape, 0))).directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    wi, wo = wi[above], wo[above]
    steeper = wi[:, 2:] > wo[:, 2:]
    return above, np.where(steeper, wi, wo), np.where(steeper, wo, wi)


def _plan_samples(pilot, above, error, spp):
    """The number of samples (m,) that each cell needs for the relative standard error `error`.

    Where a sample is rarely large, the few samples of the pilot in one cell often miss the large
    ones: the cells around it are pooled with it.
    """
    from scipy.ndimage import uniform_filter

    def pool(values):
        """The mean over 3 × 3 × ... cells; cells below the plane count as 0."""
        grid = np.zeros(above.shape)
        grid[above] = values
        return uniform_filter(grid, 3)[above]

    # squared relative error of the pilot in the pooled cells; `share` of them is above the plane
    share, mean = pool(1.0), pool(pilot.mean.sum(axis=1))
    # the errors of the channels rise and fall together: they add up, not their squares
    variance = share * pool(pilot.standard_error.sum(axis=1) ** 2)
    around = np.divide(variance, mean**2, out=np.ones_like(mean), where=mean > 0)

    # the larger of it and of the cell's own falls as 1 / number of samples
    squares = np.maximum(around, np.minimum(pilot.relative_error, 1) ** 2)
    return np.ceil(np.clip(PILOT * squares / error**2, min(LEAST, spp), spp)).astype(int)


def _trace(specimen, light, eye, counts, rng, tally, progress=None, total=None):
    """Add `counts` (m,) samples of each pair of directions to the tally."""
    ends = np.cumsum(counts)
    for first in range(0, ends[-1], BATCH):
        numbers = np.arange(first, min(first + BATCH, ends[-1]))
        batch = np.searchsorted(ends, numbers, side="right")
        tally.add(batch, specimen.samples(light, eye, batch, int(rng.integers(2**32))))
        if progress:
            progress(tally.n.sum(), total)


def _notes(tally, total):
    """Notes on a measurement for which `total` samples were planned."""
    median, most = np.percentile(tally.relative_error, (50, 95))
    notes = {
        "made by": f"brdfkit {__version__}, virtual goniometer",
        "samples a cell": f"{tally.n.min():,} to {tally.n.max():,}",
        "relative error": f"{median:.1%} in the median, {most:.1%} or less in 95 of 100 cells",
    }
    if tally.n.sum() < total:
        notes["interrupted"] = f"{tally.n.sum() / total:.0%} of the samples"
    return notes


def _require_valid(surface, shape, error, spp, seed):
    """Raise `BrdfkitError` for the first argument that is out of bounds."""
    dimensions = 3 if surface.isotropic else 4
    if len(shape) != dimensions or min(shape) < 1:
        raise BrdfkitError(f"The table's shape {shape} should be {dimensions} numbers above 0.")
    if math.prod(shape) > MOST_CELLS:
        raise BrdfkitError(f"The table's shape {shape} is above {MOST_CELLS:,} cells; give fewer.")
    if not 2 <= spp <= MOST_SPP:
        raise BrdfkitError(f"spp = {spp} is out of bounds; give one from 2 to {MOST_SPP:,}.")
    if seed < 0:
        raise BrdfkitError(f"seed = {seed} is out of bounds; give at least 0.")
    if not LEAST_ERROR <= error < 1:
        raise BrdfkitError(
            f"error = {error:g} is out of bounds; give one from {LEAST_ERROR:g} to below 1."
        )
