"""`Ranking`, the result of `rank`: a row for every model; prints as a table with sentences."""

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
    """Models ranked on one measured material, made by `rank`; prints as a table with sentences.

    Attributes
    ----------
    material : str
        Name of the measured material.
    loss : str
        Name of the loss.
    rows : tuple of Ranked
        Rows of the models, the least held-out error first, and models that cannot be fitted last.
    requested : int
        Number of requested models; larger than the number of rows after Ctrl-C.
    seconds : float
        Wall-clock time of the ranking.
    """

    material: str
    loss: str
    rows: tuple[Ranked, ...]
    requested: int
    seconds: float = field(default=math.nan, compare=False)

    @property
    def best(self) -> str:
        """Label of the recommended model; `rank` describes how it is chosen."""
        return self._choice.row.model

    @property
    def why(self) -> str:
        """The reason for the recommendation, as a clause."""
        return self._choice.why

    @property
    def reason(self) -> str:
        """Sentences on the recommended model, the reason for it, and its alternatives."""
        choice = self._choice
        though = f", though {choice.row.doubt}" if choice.row.doubt else ""
        recommended = f"{choice.row.model} is recommended{though}: {choice.why}."
        said = " ".join(filter(None, [recommended, choice.describe_alternatives(self.rows)]))
        if len(self.rows) == self.requested:
            return said
        ranked = f"{len(self.rows)} of {self.requested} models are ranked"
        return f"Interrupted: {ranked}. Of these, {said}"

    @property
    def suits(self) -> str:
        """A sentence on the materials for which the recommended model is meant, or "" for none."""
        sentence = read_page(labels.model(self.best)).suitable_materials
        return f"{self.best}: {sentence}" if sentence else ""

    @property
    def doubts(self) -> list[str]:
        """Sentences on the models whose fits have implausible values at grazing angles."""
        models: dict[str, list[str]] = {}
        for row in self.rows:
            if row.doubt:
                models.setdefault(row.doubt, []).append(row.model)
        return [f"Doubtful: {doubt}, of {join_words(names)}." for doubt, names in models.items()]

    @property
    def problems(self) -> list[str]:
        """Sentences on the models that cannot be fitted."""
        return [row.message for row in self.rows if row.message]

    @property
    def _choice(self) -> Choice:
        """The steps in which the recommended model is chosen."""
        return Choice.from_rows(self.rows)

    def table(self) -> list[tuple[str, ...]]:
        """Return the texts of the table, under the heads `COLUMNS`, without models that failed."""
        own = self._choice.row
        return [_format_ranking_row(row, row is own) for row in self.rows if not row.message]

    def document(self) -> Document:
        """Return the table of the models, with the recommended one in bold, and sentences."""
        said = [Paragraph(text) for text in (self.reason, *self.doubts, self.suits) if text]
        failed = [Paragraph(problem, BAD) for problem in self.problems]
        rows = [
            tuple(Cell(text, STRONG if texts[-1] == TAKE else "") for text in texts)
            for texts in self.table()
        ]
        title = f"{self.material}: {self.loss} loss where the models were not fitted"
        return Document(title, (Table(tuple(rows), COLUMNS), *said, *failed))


def _format_ranking_row(row: Ranked, recommended: bool) -> tuple[str, ...]:
    """Return the texts of a row, with the verdict "take" if it is the `recommended` one."""
    behind = "-"
    if row.behind:
        least = (row.error - row.behind) or math.nan
        digits = 0 if row.behind > least else 1
        behind = " ± ".join(f"{100 * x / least:.{digits}f}" for x in (row.behind, row.uncertainty))
    marks = {"tied": row.tied, "Pareto": row.pareto, "doubtful": row.doubt}
    verdict = TAKE if recommended else ", ".join(mark for mark, holds in marks.items() if holds)
    errors = f"{row.error:.4g}", behind, f"{row.psnr:.1f}"
    return row.model, *errors, str(row.parameters), f"{row.bic:.0f}", f"{row.seconds:.1f}", verdict
