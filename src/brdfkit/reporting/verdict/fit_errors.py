"""How the fits stand: their errors by every loss, how far off their values are, their light, which
cannot be told from the best, and which one to take."""

from dataclasses import dataclass

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import to_angles
from brdfkit.fitting.compare import compare, told
from brdfkit.fitting.ranking.held_out import number_blocks
from brdfkit.fitting.ranking.ties import beside, is_tied
from brdfkit.materials.measured.selection import select_samples
from brdfkit.regression import losses
from brdfkit.regression.losses.loss import squares
from brdfkit.regression.losses.named_losses import DEFAULT

MOST_SAMPLES = 200_000  # of which quantiles and ties are told; of more, so many are drawn
BAND, LEAST = 15.0, 20  # degrees of θi over which a deviation is told; samples that it needs


@dataclass(frozen=True)
class Standing:
    """How a fit stands.

    `errors`: E by loss; `albedos`: as `compare` finds them; `typical`, `most`: the factors within
    which half, and 95 %, of the measured values are met, those above 0 of every channel, each
    counted once; `worst`: the factor for half of them in the band of incidences (from, to)
    [degrees] `worst_at` where it is largest; `numbers`: how many were sought; `tied`: no worse than
    the best, within the noise between blocks of directions.
    """

    errors: dict[str, float]
    albedos: tuple[float, ...]
    typical: float
    most: float
    worst: float
    worst_at: tuple[float, float]
    numbers: int
    tied: bool


def ranked_by(fits):
    """The loss by which fits are ranked: that of all of them, or the default where it is none of
    samples or not the same."""
    names = {fit.loss_name for fit in fits}
    return names.pop() if len(names) == 1 and names <= {*losses.named.by_sample} else DEFAULT


def standings(material, fits, loss):
    """The `Standing` of each of the `fits` to a `Measured`, in their order, by the name of a
    loss."""
    max_angle = fits[0].settings.get("max_angle", 80.0)
    compared = [compare(material, fit, max_angle=max_angle) for fit in fits]
    samples = _some(select_samples(material, max_angle))
    if not (samples.values > 0).any():
        raise BrdfkitError(
            f"{material.name}: no measured value is above 0, by which a fit could be off by a "
            "factor; a report needs some."
        )
    blocks = number_blocks(samples.wi, samples.wo, material.anisotropic)
    weight = losses.named[loss].importance(samples)
    sums, factors = [], []
    for fit in fits:
        values = np.broadcast_to(fit.rgb.eval(samples.wi, samples.wo), samples.values.shape)
        sums.append(np.bincount(blocks, weight * squares(losses.named[loss], values, samples)))
        factors.append(_factors(values, samples))
    best = min(sums, key=np.sum)
    shares = np.bincount(blocks, weight)
    return [
        Standing(
            {name: one.errors[one.best][name] for name in told(loss)},
            one.albedos[one.best],
            *own_factors,
            _count_numbers(fit),
            is_tied(*beside(own, best, shares)),
        )
        for fit, one, own, own_factors in zip(fits, compared, sums, factors, strict=True)
    ]


def in_order(standings, loss):
    """The places of the fits: that of the one to take, then the others by their error.

    To take is, of those that are tied with the best, the one with the fewest numbers.
    """
    by_error = sorted(range(len(standings)), key=lambda place: standings[place].errors[loss])
    tied = [place for place in by_error if standings[place].tied]
    taken = min(tied, key=lambda place: standings[place].numbers)
    return [taken, *(place for place in by_error if place != taken)]


def _some(samples):
    """All samples, or `MOST_SAMPLES` of them."""
    count = len(samples.wi)
    if count <= MOST_SAMPLES:
        return samples
    drawn = np.random.default_rng(0).choice(count, MOST_SAMPLES, replace=False)
    return samples.at(np.sort(drawn))


def _factors(values, samples):
    """`typical`, `most`, `worst` and `worst_at` of a `Standing`; `values`: the fit's, of the
    measured `samples` (n, channels)."""
    known = samples.values > 0
    with np.errstate(divide="ignore"):  # a fit of 0 is off by any factor
        off = np.abs(np.log(np.maximum(values[known], 0) / samples.values[known]))
    theta_i = np.broadcast_to(np.degrees(to_angles(samples.wi)[0])[:, None], known.shape)[known]
    bands = np.floor(theta_i / BAND)
    some, counts = np.unique(bands, return_counts=True)
    some = some[counts >= min(LEAST, counts.max())]  # of few samples, the fullest bands
    found = {band: _quantile(off[bands == band], 0.5) for band in some}
    worst = max(found, key=found.get)
    factors = (float(np.exp(x)) for x in (_quantile(off, 0.5), _quantile(off, 0.95), found[worst]))
    return *factors, (worst * BAND, (worst + 1) * BAND)


def _quantile(values, share):
    """The value of which a `share` of the others are no larger; itself one of them."""
    return np.quantile(values, share, method="inverted_cdf")


def _count_numbers(fit):
    """How many numbers were sought for a fit."""
    if fit.certainty:
        return fit.certainty.parameters
    return sum(len(v) if isinstance(v, tuple) else 1 for v in fit.model.free_values.values())
