"""Computes the errors of a report's fits, and chooses the fit to recommend.

Errors are losses, and factors between measured and fitted values. Fits are tied if the best one is
not better by more than noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import to_angles
from brdfkit.fitting.compare import choose_losses_to_show, compare, format_error
from brdfkit.fitting.ranking.held_out import assign_blocks
from brdfkit.fitting.ranking.result import TAKE
from brdfkit.fitting.ranking.ties import compare_with_best, is_tied
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.albedos import ANGLES
from brdfkit.materials.measured.selection import select_samples
from brdfkit.regression import Fit, losses
from brdfkit.regression.albedo import WRONG_FACTOR
from brdfkit.regression.albedo_cells import format_albedo, is_wrong_albedo
from brdfkit.regression.losses.loss import sum_squared_differences
from brdfkit.regression.losses.named_losses import DEFAULT

# Quantiles and ties are computed from at most this number of samples, drawn at random
SAMPLE_LIMIT = 200_000
# Width of a band of angles of incidence [degrees], in which errors are compared
BAND_WIDTH = 15.0
# A band with fewer samples is left out, unless all bands have fewer
FEWEST_IN_BAND = 20
# A larger factor between measured and fitted values is not printed, because the fit has failed
LARGEST_FACTOR = 1000


@dataclass(frozen=True)
class FitErrors:
    """The errors of one fit, compared with the measurement.

    A fit meets a measured value within a factor if measured / fitted and fitted / measured do not
    exceed this factor. Measured values above 0 count, each channel separately.

    by_loss : the loss E of the fit, by the name of the loss.
    albedos : the albedos of the fit, at the angles of `compare`.
    typical_factor : the factor within which half of the values are met.
    large_factor : the factor within which 95 % of the values are met.
    worst_factor : the factor within which half of the values in the worst band are met.
    worst_band : the band of angles of incidence [degrees] in which this factor is largest.
    numbers : the number of parameters that the fit searched.
    is_tied : whether the fit is no worse than the best one by more than noise.
    """

    by_loss: dict[str, float]
    albedos: tuple[float, ...]
    typical_factor: float
    large_factor: float
    worst_factor: float
    worst_band: tuple[float, float]
    numbers: int
    is_tied: bool


def choose_ranking_loss(fits: Sequence[Fit]) -> str:
    """Return the name of the loss that ranks the fits of a report.

    It is the loss that all of them minimised, or the default loss if they minimised different ones
    or a loss of pictures.
    """
    names = {fit.loss_name for fit in fits}
    return names.pop() if len(names) == 1 and names <= {*losses.named.by_sample} else DEFAULT


def compute_fit_errors(material: Measured, fits: Sequence[Fit], loss: str) -> list[FitErrors]:
    """Return the `FitErrors` of each fit; `loss`: the name of the loss that decides ties."""
    max_angle = fits[0].settings.get("max_angle", 80.0)
    compared = [compare(material, fit, max_angle=max_angle) for fit in fits]
    samples = _select_random_samples(select_samples(material, max_angle))
    if not (samples.values > 0).any():
        raise BrdfkitError(
            f"{material.name}: no measured value is above 0, so a report cannot compare fits with "
            "it; give a material with positive values."
        )
    blocks = assign_blocks(samples.wi, samples.wo, material.anisotropic)
    by_sample = losses.named.by_sample[loss]
    weight = by_sample.importance(samples)
    sums, factors = [], []
    for fit in fits:
        values = np.broadcast_to(fit.rgb.eval(samples.wi, samples.wo), samples.values.shape)
        sums.append(
            np.bincount(blocks, weight * sum_squared_differences(by_sample, values, samples))
        )
        factors.append(_compute_factors(values, samples))
    best = min(sums, key=np.sum)
    shares = np.bincount(blocks, weight)
    return [
        FitErrors(
            {name: one.errors[one.best][name] for name in choose_losses_to_show(loss)},
            one.albedos[one.best],
            *own_factors,
            _count_searched_parameters(fit),
            is_tied(*compare_with_best(own, best, shares)),
        )
        for fit, one, own, own_factors in zip(fits, compared, sums, factors, strict=True)
    ]


def order_fits(errors: Sequence[FitErrors], loss: str) -> list[int]:
    """Return the indices of the fits, the recommended fit first, then the others by their error.

    The recommended fit is the one with the fewest parameters among those tied with the best.
    """
    by_error = sorted(range(len(errors)), key=lambda k: errors[k].by_loss[loss])
    tied = [k for k in by_error if errors[k].is_tied]
    taken = min(tied, key=lambda k: errors[k].numbers)
    return [taken, *(k for k in by_error if k != taken)]


def _select_random_samples(samples: Any) -> Any:
    """Return the samples, or if there are more, `SAMPLE_LIMIT` of them drawn at random."""
    count = len(samples.wi)
    if count <= SAMPLE_LIMIT:
        return samples
    drawn = np.random.default_rng(0).choice(count, SAMPLE_LIMIT, replace=False)
    return samples.at(np.sort(drawn))


def _compute_factors(
    values: AnyArray, samples: Any
) -> tuple[float, float, float, tuple[float, float]]:
    """Return the factors between measured and fitted values that `FitErrors` needs.

    They are (typical_factor, large_factor, worst_factor, worst_band), as explained there.
    `values` (n, channels): the fitted BRDF at the `samples`.
    """
    known = samples.values > 0
    with np.errstate(divide="ignore"):  # a fitted value of 0 has an infinite factor
        off = np.abs(np.log(np.maximum(values[known], 0) / samples.values[known]))
    theta_i = np.broadcast_to(np.degrees(to_angles(samples.wi)[0])[:, None], known.shape)[known]
    bands = np.floor(theta_i / BAND_WIDTH)
    numbers, counts = np.unique(bands, return_counts=True)
    numbers = numbers[counts >= min(FEWEST_IN_BAND, counts.max())]
    medians = {float(band): _find_quantile(off[bands == band], 0.5) for band in numbers}
    worst = max(medians, key=medians.__getitem__)
    logarithms = _find_quantile(off, 0.5), _find_quantile(off, 0.95), medians[worst]
    typical, large, worst_factor = (float(np.exp(x)) for x in logarithms)
    return typical, large, worst_factor, (worst * BAND_WIDTH, (worst + 1) * BAND_WIDTH)


def _find_quantile(values: FloatArray, share: float) -> float:
    """Return the value that a `share` of the values do not exceed, without interpolation."""
    return float(np.quantile(values, share, method="inverted_cdf"))


def _count_searched_parameters(fit: Fit) -> int:
    """Return the number of parameters that a fit searched."""
    if fit.certainty:
        return fit.certainty.parameters
    return sum(len(v) if isinstance(v, tuple) else 1 for v in fit.model.free_values.values())


def make_errors_table(
    errors: Sequence[FitErrors], loss: str, measured: Sequence[float]
) -> dict[str, Any]:
    """Return the table of errors for the template, with a row for each fit.

    The columns are losses, the loss that ranks the fits first, and albedos. A cell of a loss is a
    text and whether the value is the best of its column. A cell of an albedo is a text and whether
    the albedo is wrong compared with the `measured` albedo at the same angle.
    """
    by_loss = sorted(errors[0].by_loss, key=lambda name: name != loss)
    best = {name: min(one.by_loss[name] for one in errors) for name in by_loss}
    rows = [
        {
            "cells": [(format_error(one.by_loss[n]), one.by_loss[n] == best[n]) for n in by_loss],
            "albedos": [
                (format_albedo(own), is_wrong_albedo(own, known))
                for own, known in zip(one.albedos, measured, strict=True)
            ],
            "numbers": one.numbers,
            "typical": format_factor(one.typical_factor),
            "large": format_factor(one.large_factor),
            "verdict": TAKE if not number else "tied" if one.is_tied else "",
        }
        for number, one in enumerate(errors)
    ]
    return {
        "losses": by_loss,
        "angles": [f"{angle:g}°" for angle in ANGLES],
        "factor": WRONG_FACTOR,
        "measured": [(format_albedo(known), is_wrong_albedo(known)) for known in measured],
        "rows": rows,
    }


def format_factor(factor: float) -> str:
    """Return a factor between two values as text, with three digits or less.

    >>> format_factor(1.057), format_factor(23.4)
    ('1.06', '23')
    """
    if factor >= LARGEST_FACTOR:
        return f"{LARGEST_FACTOR:,} or more"
    return f"{factor:.2f}" if factor < 10 else f"{factor:.0f}"
