"""`Ranking`, what `rank` returns: a row for every model; prints as a table, with the choice."""

import math
from dataclasses import dataclass, field

import numpy as np

from brdfkit.documents import Cell, Document, Paragraph, Shown, Table
from brdfkit.documents.parts import BAD, STRONG
from brdfkit.errors import BrdfkitError
from brdfkit.model import labels
from brdfkit.names import printable
from brdfkit.plugins.pages import page

# A model is tied with the best where it is behind by at most so many standard errors: so large a
# difference comes about by chance once in twenty times
TIED = 2.0
# Errors that differ by less, as shares of them, differ by rounding
EQUAL = 1e-9
TAKE = "take"
COLUMNS = "model", ">error", ">behind [%]", ">parameters", ">BIC", ">time [s]", ""


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
    parameters: int = 0
    bic: float = math.nan
    seconds: float = field(default=math.nan, compare=False)
    message: str = ""

    @property
    def tied(self) -> bool:
        """Whether the model is no worse than the best, within the noise."""
        return is_tied(self.error, self.behind, self.uncertainty)


@dataclass(frozen=True, repr=False)
class Ranking(Shown):
    """Models ranked on one measured material; prints as a table. Made by `rank`.

    Attributes
    ----------
    material : str
        Name of the measured material.
    loss : str
        Name of the loss.
    rows : tuple of Ranked
        The models, the least held-out error first; those that cannot be fitted last.
    asked : int
        How many models were asked for; more than there are rows after Ctrl-C.
    seconds : float
        Wall-clock time.
    """

    material: str
    loss: str
    rows: tuple[Ranked, ...]
    asked: int
    seconds: float = field(default=math.nan, compare=False)

    @property
    def best(self) -> str:
        """The recommended model: of those that are tied, the one with the fewest parameters."""
        return self._recommended.model

    @property
    def why(self) -> str:
        """Why it is recommended, in a few words."""
        tied = sum(row.tied for row in self.rows)
        if tied == 1:
            return "its error is the least, by more than the noise"
        count = f"{tied} models that are tied" if tied > 2 else "the two that are tied"
        return f"it has the fewest parameters of {count}"

    @property
    def reason(self) -> str:
        """Why it is recommended, in words, and how near the others are."""
        if len(self.rows) == self.asked:
            return self._choice
        ranked = f"{len(self.rows)} of {self.asked} models are ranked"
        return f"Interrupted: {ranked}. Of these, {self._choice}"

    @property
    def _choice(self) -> str:
        own = self._recommended
        others = [_compare(row, own) for row in self.rows if row.tied and row is not own]
        reason = f"{own.model} is recommended: {self.why}."
        if others:
            return f"{reason} Tied with it: {'; '.join(others)}."
        after = [row for row in self.rows if row is not own and not row.message]
        return f"{reason} Next is {_compare(after[0], own)}." if after else reason

    @property
    def suits(self) -> str:
        """Which materials the recommended model is meant for, as its page says; or nothing."""
        sentence = page(labels.model(self.best)).shows
        return f"{self.best}: {sentence}" if sentence else ""

    @property
    def problems(self) -> list[str]:
        """The sentences on the models that cannot be fitted."""
        return [row.message for row in self.rows if row.message]

    @property
    def _recommended(self) -> Ranked:
        return min((row for row in self.rows if row.tied), key=lambda row: row.parameters)

    def table(self) -> list[tuple[str, ...]]:
        """The rows of the models that could be fitted as texts, under `COLUMNS`."""
        return [_texts(row, row is self._recommended) for row in self.rows if not row.message]

    def document(self) -> Document:
        """The models in their order, which is recommended, and why."""
        said = [Paragraph(text) for text in (self.reason, self.suits) if text]
        failed = [Paragraph(problem, BAD) for problem in self.problems]
        return Document(
            f"{self.material}: {self.loss} loss where the models were not fitted",
            (Table(tuple(map(_stress, self.table())), COLUMNS), *said, *failed),
        )


def order(found, shares):
    """The `Ranked` of every model, the best first; `found`: by label what came out, a `Validated`
    or an error; `shares` (blocks,): how much each block counts."""
    fitted = {label: one for label, one in found.items() if not isinstance(one, BrdfkitError)}
    best = min(fitted.values(), key=lambda one: one.errors.sum())
    rows = [
        Ranked(
            label,
            *beside(one.errors, best.errors, shares),
            one.parameters,
            one.bic,
            one.seconds,
        )
        for label, one in fitted.items()
    ]
    failed = [
        Ranked(label, message=printable(str(one)))
        for label, one in found.items()
        if isinstance(one, BrdfkitError)
    ]
    return (*sorted(rows, key=lambda row: (row.error, row.parameters)), *failed)


def beside(errors, best, shares):
    """A model's E, by how much it is above the best model's, and the standard error of that.

    `errors`, `best` (blocks,): what each block of directions adds to the E² of each; `shares`
    (blocks,): how much each block counts.
    """
    error, least = (math.sqrt(squares.sum()) for squares in (errors, best))
    noise = paired_standard_error(errors - best, shares)
    # Of E², whose difference is (E + least) (E - least)
    return error, error - least, noise / (error + least) if noise else 0.0


def is_tied(error, behind, uncertainty):
    """Whether an E is no worse than the best one, within the noise; see `beside`."""
    return behind <= TIED * uncertainty + EQUAL * error


def paired_standard_error(differences, shares):
    """The standard error of the sum of `differences` (blocks,), of blocks with these `shares`; 0 of
    one block, which tells nothing of noise."""
    count = len(differences)
    if count < 2:
        return 0.0
    apart = differences - differences.sum() * shares / shares.sum()
    return float(np.sqrt(count / (count - 1) * (apart**2).sum()))


def _compare(row, own):
    """A row beside the recommended one, in words."""
    more = row.parameters - own.parameters
    number = f"{abs(more)} {'more' if more > 0 else 'fewer'}" if more else "as many"
    gap = row.error - own.error
    error = (
        f"an error {abs(gap):.2g} {'above' if gap > 0 else 'below'} its own" if gap else "its error"
    )
    return f"{row.model}, with {number} parameter{'s' * (abs(more) != 1)} and {error}"


def _stress(texts):
    """A row of texts, strong where the model is recommended."""
    return tuple(Cell(text, STRONG if texts[-1] == TAKE else "") for text in texts)


def _texts(row, recommended):
    behind = "-"
    if row.behind:
        least = (row.error - row.behind) or math.nan
        digits = 0 if row.behind > least else 1
        behind = " ± ".join(f"{100 * x / least:.{digits}f}" for x in (row.behind, row.uncertainty))
    verdict = TAKE if recommended else "tied" if row.tied else ""
    numbers = f"{row.error:.4g}", behind, str(row.parameters), f"{row.bic:.0f}"
    return row.model, *numbers, f"{row.seconds:.1f}", verdict
