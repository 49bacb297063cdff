"""How the fits stand: their errors by every loss, how far off they are in plain words, and which of
them cannot be told from the best."""

from dataclasses import dataclass

import numpy as np

from brdfkit.fitting import losses
from brdfkit.fitting.loss import squares
from brdfkit.geometry.directions import to_angles
from brdfkit.measured.selection import select_samples
from brdfkit.ranking.held_out import number_blocks
from brdfkit.ranking.result import TIED, paired_standard_error
from brdfkit.verbs.compare import compare

SHOWN = "cosine", "log", "cbrt", "plain"  # and the loss that was fitted
MOST_SAMPLES = 50_000  # of which quantiles and ties are told; of more, so many are drawn
BAND, LEAST = 15.0, 20  # degrees of θi over which a deviation is told; samples that it needs


@dataclass(frozen=True)
class Standing:
    """How a fit stands.

    `errors`: E by loss; `typical`, `most`: the factors within which half, and 95 %, of the measured
    values are met; `worst`: the factor for half of them in the band of incidences (from, to)
    [degrees] `worst_at` where it is largest; `numbers`: how many were sought; `tied`: no worse than
    the best, within the noise between blocks of directions.
    """

    errors: dict[str, float]
    typical: float
    most: float
    worst: float
    worst_at: tuple[float, float]
    numbers: int
    tied: bool


def ranked_by(fits):
    """The loss by which fits are ranked: that of all of them, or "log" where it is none of samples
    or not the same."""
    names = {fit.loss_name for fit in fits}
    return names.pop() if len(names) == 1 and names <= {*losses.by_sample} else "log"


def standings(material, fits, loss):
    """The `Standing` of each of the `fits` to a `Measured`, in their order, by the name of a
    loss."""
    max_angle = fits[0].settings.get("max_angle", 80.0)
    errors = _errors(material, fits, max_angle)
    samples = _some(select_samples(material, max_angle))
    blocks = number_blocks(samples.wi, samples.wo, material.anisotropic)
    weight = losses[loss].importance(samples)
    sums, deviations = [], []
    for fit in fits:
        values = np.broadcast_to(fit.rgb.eval(samples.wi, samples.wo), samples.values.shape)
        sums.append(np.bincount(blocks, weight * squares(losses[loss], values, samples)))
        square = squares(losses["log"], values, samples) / samples.values.shape[1]
        deviations.append(np.sqrt(square))
    best = min(sums, key=np.sum)
    shares = np.bincount(blocks, weight)
    return [
        Standing(
            {name: found[name] for name in losses.by_sample if name in {*SHOWN, loss}},
            *_factors(deviation, samples),
            _count_numbers(fit),
            _is_tied(own - best, shares),
        )
        for fit, found, own, deviation in zip(fits, errors, sums, deviations, strict=True)
    ]


def _errors(material, fits, max_angle):
    """The errors by loss of each fit, in their order."""
    return [next(iter(compare(material, fit, max_angle).errors.values())) for fit in fits]


def _some(samples):
    """All samples, or `MOST_SAMPLES` of them."""
    count = len(samples.wi)
    if count <= MOST_SAMPLES:
        return samples
    drawn = np.random.default_rng(0).choice(count, MOST_SAMPLES, replace=False)
    return samples.at(np.sort(drawn))


def _factors(deviation, samples):
    """`typical`, `most`, `worst` and `worst_at` of a `Standing`; `deviation`: of logarithms."""
    theta_i = np.degrees(to_angles(samples.wi)[0])
    bands = np.floor(theta_i / BAND)
    found = {
        band: _quantile(deviation[bands == band], samples.weight[bands == band], 0.5)
        for band in np.unique(bands)
        if (bands == band).sum() >= min(LEAST, len(bands))
    }
    worst = max(found, key=found.get) if found else 0.0
    typical, most = (_quantile(deviation, samples.weight, share) for share in (0.5, 0.95))
    factors = (float(np.exp(x)) for x in (typical, most, found.get(worst, typical)))
    return *factors, (worst * BAND, (worst + 1) * BAND)


def _quantile(values, weights, share):
    """The value below which a `share` of the weight lies."""
    order = np.argsort(values)
    sums = np.cumsum(weights[order])
    return values[order][np.searchsorted(sums, share * sums[-1])]


def _is_tied(differences, shares):
    """Whether the sum of differences (blocks,) to the best is no more than noise."""
    if len(differences) < 2:
        return not differences.any()
    return bool(differences.sum() <= TIED * paired_standard_error(differences, shares))


def _count_numbers(fit):
    """How many numbers were sought for a fit."""
    if fit.certainty:
        return fit.certainty.parameters
    return sum(len(v) if isinstance(v, tuple) else 1 for v in fit.model.free_values.values())
