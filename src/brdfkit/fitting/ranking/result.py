"""`Ranking`, what `rank` returns: a row for every model; prints as a table, with the choice."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from brdfkit.core.discovery.plugin_pages import read_page
from brdfkit.core.documents import Cell, Document, Paragraph, Shown, Table
from brdfkit.core.documents.parts import BAD, STRONG
from brdfkit.core.names import join_words
from brdfkit.fitting.ranking.choice import Choice
from brdfkit.fitting.ranking.ranked import Ranked
from brdfkit.model import labels

TAKE = "take"
COLUMNS = (
    "model",
    ">error",
    ">behind [%]",
    ">picture [dB]",
    ">parameters",
    ">BIC",
    ">time [s]",
    "",
)


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
    requested : int
        How many models were asked for; more than there are rows after Ctrl-C.
    seconds : float
        Wall-clock time.
    """

    material: str
    loss: str
    rows: tuple[Ranked, ...]
    requested: int
    seconds: float = field(default=math.nan, compare=False)

    @property
    def best(self) -> str:
        """The recommended model: of those that no other beats in both error and picture, and whose
        picture is within 0.5 dB of the best, the one with the fewest parameters of those that are
        tied for the least error."""
        return self._choice.row.model

    @property
    def why(self) -> str:
        """Why it is recommended, in a few words."""
        return self._choice.why

    @property
    def reason(self) -> str:
        """Why it is recommended, in words, and how near the others are."""
        choice = self._choice
        though = f", though {choice.row.doubt}" if choice.row.doubt else ""
        recommended = f"{choice.row.model} is recommended{though}: {choice.why}."
        said = " ".join(filter(None, [recommended, choice.others(self.rows)]))
        if len(self.rows) == self.requested:
            return said
        ranked = f"{len(self.rows)} of {self.requested} models are ranked"
        return f"Interrupted: {ranked}. Of these, {said}"

    @property
    def suits(self) -> str:
        """Which materials the recommended model is meant for, as its page says; or nothing."""
        sentence = read_page(labels.model(self.best)).shows
        return f"{self.best}: {sentence}" if sentence else ""

    @property
    def doubts(self) -> list[str]:
        """Sentences on the fits that do at 85° what the material hardly does: where measurements
        end, a formula goes on."""
        models: dict[str, list[str]] = {}
        for row in self.rows:
            if row.doubt:
                models.setdefault(row.doubt, []).append(row.model)
        return [f"Doubtful: {doubt}, of {join_words(names)}." for doubt, names in models.items()]

    @property
    def problems(self) -> list[str]:
        """The sentences on the models that cannot be fitted."""
        return [row.message for row in self.rows if row.message]

    @property
    def _choice(self) -> Choice:
        return Choice.of(self.rows)

    def table(self) -> list[tuple[str, ...]]:
        """The rows of the models that could be fitted as texts, under `COLUMNS`."""
        own = self._choice.row
        return [_format_row(row, row is own) for row in self.rows if not row.message]

    def document(self) -> Document:
        """The models in their order, which is recommended, and why."""
        said = [Paragraph(text) for text in (self.reason, *self.doubts, self.suits) if text]
        failed = [Paragraph(problem, BAD) for problem in self.problems]
        return Document(
            f"{self.material}: {self.loss} loss where the models were not fitted",
            (Table(tuple(map(_stress, self.table())), COLUMNS), *said, *failed),
        )


def _stress(texts: tuple[str, ...]) -> tuple[Cell, ...]:
    """Return a row of cells, in bold where the model is recommended."""
    return tuple(Cell(text, STRONG if texts[-1] == TAKE else "") for text in texts)


def _format_row(row: Ranked, recommended: bool) -> tuple[str, ...]:
    """Return the texts of a row; `recommended` is whether its model is the one to take."""
    behind = "-"
    if row.behind:
        least = (row.error - row.behind) or math.nan
        digits = 0 if row.behind > least else 1
        behind = " ± ".join(f"{100 * x / least:.{digits}f}" for x in (row.behind, row.uncertainty))
    marks = {"tied": row.tied, "Pareto": row.pareto, "doubtful": row.doubt}
    verdict = TAKE if recommended else ", ".join(mark for mark, holds in marks.items() if holds)
    errors = f"{row.error:.4g}", behind, f"{row.psnr:.1f}"
    return row.model, *errors, str(row.parameters), f"{row.bic:.0f}", f"{row.seconds:.1f}", verdict
