"""`Ranked`, a row of a ranking, and `rank_results`, which sorts the rows of all models."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.names import to_printable
from brdfkit.fitting.ranking.cross_validation import Validated
from brdfkit.fitting.ranking.ties import compare_with_best, is_tied
from brdfkit.regression.albedo import Albedo

# Least error of a picture that is not a rounding error
ROUNDING = 1e-6


@dataclass(frozen=True)
class Ranked:
    """How well one model predicts directions that it was not fitted to, or why it cannot be fitted.

    Attributes
    ----------
    model : str
        The model's label.
    error : float
        Error E of the ranking's loss in directions held out of the fit; nan for a failed fit.
    behind : float
        Difference of `error` from the best model's error, at least 0.
    uncertainty : float
        Standard error of `behind`, from its spread over the blocks of directions.
    albedo : Albedo, optional
        Albedos of the fit to all drawn samples, and of the data.
    picture : float
        RMS difference, in sRGB, of a ball's picture with the fit to all drawn samples from the
        picture with the measurement, divided by the brightest measured pixel; nan for a failed
        fit.
    pareto : bool
        Whether no other model has both a better picture and an error that is smaller by more than
        the noise.
    doubt : str
        A clause on implausible albedos of the fit to all drawn samples, or on its implausible
        colour at 85°; empty if it is plausible.
    parameters : int
        Number of searched parameters: the weights of each channel, and the shape parameters.
    bic : float
        Bayesian information criterion of the fit to all N drawn samples, N ln(E²) + k ln N with
        k parameters: the less the better. It assumes that samples are independent, but neighbours
        are not.
    seconds : float
        Wall-clock time of the fit to all drawn samples.
    message : str
        One sentence on why the model cannot be fitted.
    """

    model: str
    error: float = math.nan
    behind: float = math.nan
    uncertainty: float = math.nan
    albedo: Albedo | None = None
    picture: float = math.nan
    pareto: bool = False
    doubt: str = ""
    parameters: int = 0
    bic: float = math.nan
    seconds: float = field(default=math.nan, compare=False)
    message: str = ""

    @property
    def tied(self) -> bool:
        """Whether the model's error is as small as the best model's, within the noise."""
        return is_tied(self.error, self.behind, self.uncertainty)

    @property
    def psnr(self) -> float:
        """Peak signal-to-noise ratio [dB] of the picture, at most 120."""
        return to_decibels(self.picture)


def to_decibels(error: float) -> float:
    """Convert the RMS error of a picture, divided by its peak, to a PSNR [dB] of at most 120.

    >>> to_decibels(0.1)
    20.0
    """
    return -20 * math.log10(max(error, ROUNDING))


def rank_results(results: Mapping[str, Any], shares: FloatArray) -> tuple[Ranked, ...]:
    """Return a `Ranked` for every model, the one with the least error first and failures last.

    `results` has a `Validated` or a `BrdfkitError` by the model's label; `shares` (blocks,) are the
    weights of the blocks of directions.
    """
    fitted = {label: one for label, one in results.items() if not isinstance(one, BrdfkitError)}
    best = min(fitted.values(), key=lambda one: one.errors.sum())
    rows = []
    for label, one in fitted.items():
        error, behind, uncertainty = compare_with_best(one.errors, best.errors, shares)
        pareto = not any(_is_clearly_better(other, one, shares) for other in fitted.values())
        looks = one.albedo, one.picture, pareto, one.doubt
        fit = one.parameters, one.bic, one.seconds
        rows.append(Ranked(label, error, behind, uncertainty, *looks, *fit))
    failed = [
        Ranked(label, message=to_printable(str(one)))
        for label, one in results.items()
        if isinstance(one, BrdfkitError)
    ]
    return (*sorted(rows, key=lambda row: (row.error, row.parameters)), *failed)


def _is_clearly_better(one: Validated, other: Validated, shares: FloatArray) -> bool:
    """Return whether `one` has a better picture than `other` and a smaller error, beyond the noise.

    `shares` (blocks,) are the weights of the blocks of directions.
    """
    if one.picture >= other.picture:
        return False
    return not is_tied(*compare_with_best(other.errors, one.errors, shares))
