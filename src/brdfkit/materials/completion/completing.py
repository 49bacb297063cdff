"""`complete`: a full table of a material from few measurements, or a part of the hemisphere."""

from __future__ import annotations

from dataclasses import replace
from math import log, radians

import numpy as np

from brdfkit.core.arguments import to_number
from brdfkit.core.array_types import AnyArray, BoolArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.materials.completion.albedo_guard import limit_albedo
from brdfkit.materials.completion.noise import choose_noise
from brdfkit.materials.completion.observations import Lookup, Observations, observe
from brdfkit.materials.completion.posterior import Posterior, solve
from brdfkit.materials.completion.prior_cells import SHAPE, from_logarithm, to_logarithm
from brdfkit.materials.completion.prior_choice import PriorLike, to_prior
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.albedos import make_measured_test
from brdfkit.materials.measured.coverage import is_near_sample
from brdfkit.materials.measured.evidence import (
    GUESSED,
    INFERRED,
    MEASURED,
    NORMAL_95,
    is_completed,
)
from brdfkit.materials.measured.spectrum_to_rgb import has_wavelengths, wavelengths
from brdfkit.materials.resolve import MaterialLike, to_measured
from brdfkit.model.samples import Table

FEWEST_VALUES = 4
MOST_SAMPLES = 6_000  # of more samples, so many are drawn; they count as few anyway
# A value that was not measured is a guess if its 95 % interval is wider than a factor of 2 each way
GUESS_DEVIATION = log(2) / NORMAL_95
# Factors by which the limit of the albedo makes values smaller: from the first on, a note tells it;
# from the second on, the values have surely another unit than 1/sr
DIMMED, OTHER_UNIT = 1.5, 5.0
LARGEST_VALUE = 1e9  # [sr⁻¹]; beyond it, logarithms overflow
UNLIKE_SCALE = 2.0  # from this scale s on, a material is unlike those of the prior
SEED = 0


@in_turn
def complete(
    material: MaterialLike,
    *,
    prior: PriorLike = None,
    noise: float | None = None,
    alignment: float = 0.0,
    aperture: float = 0.0,
) -> Measured:
    """Complete a material that was measured at few directions, or in a part of the hemisphere.

    What other materials have in common, a `Prior`, tells what a few values imply everywhere else.
    The result is reciprocal, and its albedo is at most 1 at every angle.

    Parameters
    ----------
    material : Measured, str or Path
        The measured, isotropic material, or its name or path; at least 4 values.
    prior : Prior, str or Path, optional
        The prior, or a file that `brdfkit prior` wrote. By default the one that comes with brdfkit,
        which is made of its own models.
    noise : float, optional
        Relative standard deviation of a measured value, above 0 and at most 1. By default the
        standard errors of the material, or the scatter of repeated directions, else 0.05.
    alignment : float, default 0
        Angle [degrees] by which directions may be off, from 0 to 5. Values in highlights then
        count less.
    aperture : float, default 0
        Half angle [degrees] of the cone over which the instrument averages, from 0 to 15.

    Returns
    -------
    Measured
        A full table. `standard_error` has a standard error for each cell, `evidence` says whether
        its value was measured, inferred or guessed, and `info` what it was made from.

    Raises
    ------
    BrdfkitError
        For an anisotropic material, for fewer than 4 values, for values in one direction alone or
        none above 0, for values in another unit than 1/sr, and for a prior that is damaged.

    Examples
    --------
    >>> print(complete("twenty.csv"))    # doctest: +SKIP
    twenty: 90×30×32 table, 53,184 of 86,400 valid, channels R G B
    """
    data = to_measured(material)
    known = to_prior(prior)
    known.require_wavelengths(
        data.name, wavelengths(data) if has_wavelengths(data) else np.empty(0)
    )
    alignment = to_number("alignment", alignment, least=0, most=5)
    aperture = to_number("aperture", aperture, least=0, most=15)
    wi, wo, values, errors = list_values(data)
    sigma, words = choose_noise(wi, wo, values, errors, noise)
    observed = observe(wi, wo, values, sigma, radians(alignment), radians(aperture))
    posterior = solve(known, observed)
    notes = {"completed": describe(data, posterior, words)}
    if posterior.scale > UNLIKE_SCALE:
        notes["unlike"] = (
            f"its values are {posterior.scale:.1f} times as far from the prior as those of the "
            "materials that the prior was made from: all intervals are wider by this factor"
        )
    completed = make_table(data, posterior, sigma, {**data.info, **notes, **known.notes()})
    dimming = find_dimming(completed, posterior, observed, wi, wo)
    if dimming > DIMMED:
        completed.info["dimmed"] = (
            f"its values were divided by {dimming:.2g}, so that it reflects at most all light; are "
            "they in 1/sr, without a cosine?"
        )
    return completed


def list_values(data: Measured) -> tuple[AnyArray, AnyArray, AnyArray, AnyArray | None]:
    """Return the valid directions (n, 3) each, values and standard errors (n, channels) of `data`.

    Of many samples, `MOST_SAMPLES` are drawn. Raises `BrdfkitError` for a material that cannot be
    completed.
    """
    if is_completed(data):
        raise BrdfkitError(
            f"{data.name} is completed already, {data.info.get('completed', 'from few values')}; "
            "complete what was measured."
        )
    if data.anisotropic:
        raise BrdfkitError(
            f"{data.name} is anisotropic, and the prior knows only isotropic materials; measure it "
            "at more azimuths, or fit a model such as ward to it."
        )
    samples = data.samples
    (rows,) = np.nonzero(samples.valid)
    if len(rows) > MOST_SAMPLES:
        rows = np.sort(np.random.default_rng(SEED).choice(rows, MOST_SAMPLES, replace=False))
    wi, wo, values = samples.wi[rows], samples.wo[rows], samples.values[rows]
    if len(rows) < FEWEST_VALUES:
        raise BrdfkitError(
            f"{data.name} has {len(rows)} values; measure at least {FEWEST_VALUES} pairs of "
            "directions (brdfkit plan says which)."
        )
    cosines = np.stack([wi[:, 2], wo[:, 2], np.sum(wi * wo, axis=1)])
    if np.ptp(np.arccos(np.clip(cosines, -1, 1)), axis=1).max() < radians(1):
        raise BrdfkitError(
            f"{data.name}: all values were measured at the same directions, to within 1°; measure "
            "others as well (brdfkit plan says which)."
        )
    for channel, column in zip(data.channels, values.T, strict=True):
        if column.max() <= 0:
            raise BrdfkitError(
                f"{data.name}: no value of the channel {channel} is above 0; give the others alone."
            )
    if values.max() > LARGEST_VALUE:
        raise BrdfkitError(
            f"{data.name}: a value is {values.max():.2g}, which no BRDF has; leave it out, or give "
            "values in 1/sr."
        )
    errors = None if data.standard_error is None else data.standard_error[rows]
    return wi, wo, values, errors


def make_table(
    data: Measured, posterior: Posterior, noise: AnyArray | float, info: dict[str, str]
) -> Measured:
    """Return the `Measured` of a posterior, with its albedo limited to 1.

    Cells of a measured table keep their values, which are no surer than by their relative `noise`.
    All others have those of the posterior, and so have all cells if the material was measured by
    scattered samples.
    """
    keeps = data.is_table and data.table.phi_d_period == np.pi
    table = Table(np.full((*(data.table.shape if keeps else SHAPE), len(data.channels)), np.nan))
    wi, wo = table.directions()
    above = (wi[..., 2] > 0) & (wo[..., 2] > 0)
    wi, wo = wi[above], wo[above]
    lookup = Lookup.at(wi, wo)
    logarithm = lookup.interpolate(posterior.logarithm.T)
    deviation = lookup.interpolate(posterior.deviation.T)
    values = from_logarithm(logarithm.T, lookup.cosine).T
    # The standard error of f is that of ln(f c + e) times f + e / c
    errors = deviation * np.exp(logarithm) / lookup.cosine[:, None]
    measured = is_measured(data, wi, wo)
    if keeps:
        values[measured] = data.table.values[above][measured]
        if data.standard_error is not None:
            errors[measured] = data.standard_error.reshape(table.values.shape)[above][measured]
        elif np.ndim(noise) == 0:
            errors[measured] = np.maximum(errors[measured], noise * values[measured])
    table.values[above] = values
    factors = limit_albedo(table)
    standard_error = np.full(table.values.shape, np.nan)
    standard_error[above] = errors
    evidence = np.full(table.shape, GUESSED, np.uint8)
    sure = deviation.mean(axis=1) < GUESS_DEVIATION
    evidence[above] = np.where(measured, MEASURED, np.where(sure, INFERRED, GUESSED))
    completed = Measured.from_table(
        table.values * factors,
        channels=data.channels,
        name=data.name,
        info=info,
        standard_error=standard_error * factors,
    )
    return replace(completed, evidence=evidence.reshape(-1))


def find_dimming(
    completed: Measured, posterior: Posterior, observed: Observations, wi: AnyArray, wo: AnyArray
) -> float:
    """Return the factor by which the limit of the albedo made values at `wi`, `wo` (n, 3) smaller.

    It is a median of the measured values, or of those of the posterior where these are smaller.
    Raises `BrdfkitError` if it is so large that the values have another unit.
    """
    lookup = observed.lookup
    least = np.minimum(observed.logarithm, lookup.interpolate(posterior.logarithm.T))
    limited = to_logarithm(completed.eval(wi, wo).T, lookup.cosine).T
    dimming = float(np.exp(np.median((least - limited).mean(axis=1))))
    if dimming > OTHER_UNIT:
        raise BrdfkitError(
            f"{completed.name}: its values reflect more light than arrives, and would have to be "
            f"divided by {dimming:.2g}; give them in 1/sr, without a cosine."
        )
    return dimming


def is_measured(data: Measured, wi: AnyArray, wo: AnyArray) -> BoolArray:
    """Return a mask (n,) of the pairs of directions that lie near a sample or in a valid cell."""
    return make_measured_test(data)(wi, wo) if data.is_table else is_near_sample(data, wi, wo)


def describe(data: Measured, posterior: Posterior, noise: str) -> str:
    """Return a sentence that says from how many values the material was completed."""
    count = int(data.samples.valid.sum())
    return f"from {count:,} measured values with a noise of {noise}, by a prior"
