"""`Ranked`, a row of a ranking; and the rows of all models, in the order of their errors."""

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

# A smaller difference of pictures is rounding
ROUNDING = 1e-6


@dataclass(frozen=True)
class Ranked:
    """How well one model predicts what it was not fitted to, or why it cannot be fitted.

    Attributes
    ----------
    model : str
        The model's label.
    error : float
        E of the ranking's loss where the model was not fitted; nan where it cannot be.
    behind : float
        By how much E is larger than the best model's.
    uncertainty : float
        The standard error of `behind`, of the differences in each block of directions.
    albedo : Albedo, optional
        The light that the fit to all samples that were drawn reflects, beside the data's.
    picture : float
        RMS difference of pictures of a ball, of the fit to all samples that were drawn and of the
        measurement, as a screen shows them, over the brightest of the measurement's, as in
        `Rendering.psnr`; nan where there is no fit.
    pareto : bool
        Whether no other model has a better picture and an error that is less by more than the
        noise.
    doubt : str
        A clause on the light of the fit to all samples, or on what it does at 85° that the material
        hardly does; or nothing.
    parameters : int
        How many numbers were sought: the weights of each channel, and the shape parameters.
    bic : float
        The Bayesian criterion of the fit to all samples that were drawn, N ln(E²) + k ln N: less
        is better. It takes N samples for independent, which neighbours are not.
    seconds : float
        Wall-clock time of that fit.
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
        """Whether the model is no worse than the best by its error, within the noise."""
        return is_tied(self.error, self.behind, self.uncertainty)

    @property
    def psnr(self) -> float:
        """The picture's peak signal-to-noise ratio [dB], at most 120."""
        return to_decibels(self.picture)


def to_decibels(error: float) -> float:
    """The PSNR [dB] of the error of a picture, over the peak; at most 120.

    >>> to_decibels(0.1)
    20.0
    """
    return -20 * math.log10(max(error, ROUNDING))


def rows_of(results: Mapping[str, Any], shares: FloatArray) -> tuple[Ranked, ...]:
    """The `Ranked` of every model, the best first; `results`: by label what came out, a `Validated`
    or an error; `shares` (blocks,): how much each block counts."""
    fitted = {label: one for label, one in results.items() if not isinstance(one, BrdfkitError)}
    best = min(fitted.values(), key=lambda one: one.errors.sum())
    rows = []
    for label, one in fitted.items():
        error, behind, uncertainty = compare_with_best(one.errors, best.errors, shares)
        pareto = not any(_beats(other, one, shares) for other in fitted.values())
        looks = one.albedo, one.picture, pareto, one.doubt
        fit = one.parameters, one.bic, one.seconds
        rows.append(Ranked(label, error, behind, uncertainty, *looks, *fit))
    failed = [
        Ranked(label, message=to_printable(str(one)))
        for label, one in results.items()
        if isinstance(one, BrdfkitError)
    ]
    return (*sorted(rows, key=lambda row: (row.error, row.parameters)), *failed)


def _beats(one: Validated, other: Validated, shares: FloatArray) -> bool:
    """Return whether `one` has a better picture and a smaller error, beyond the noise."""
    if one.picture >= other.picture:
        return False
    return not is_tied(*compare_with_best(other.errors, one.errors, shares))
