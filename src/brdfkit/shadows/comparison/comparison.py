"""`ShadowComparison`, the result of `compare`: scores by technique, printed as a table."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from brdfkit.core.documents import Cell, Document, Paragraph, Shown, Table
from brdfkit.core.documents.parts import STRONG
from brdfkit.shadows.comparison.pictures import Pictures
from brdfkit.shadows.comparison.scores import (
    COLUMNS,
    Scores,
    average_light_differences,
    average_scores,
    format_scores,
)


@dataclass(frozen=True, repr=False)
class ShadowComparison(Shown):
    """Scores of shadow techniques against exact shadows; prints as a table.

    Attributes
    ----------
    scores : dict
        For each technique, its `Scores` in each view and light: first in all lights of the first
        view, then in all lights of the second view, and so on.
    lights : int
        The number of lights.
    requested : int
        The number of scores that were requested, over all techniques, views and lights; after
        Ctrl-C fewer are finished.
    pictures : tuple of Pictures
        The pictures of each view and light for the page, in the order of the scores.
    """

    scores: dict[str, tuple[Scores, ...]]
    lights: int
    requested: int
    pictures: tuple[Pictures, ...] = field(compare=False)

    @property
    def means(self) -> dict[str, Scores]:
        """The mean scores of each technique over views and lights, the best PSNR first."""
        means = {label: average_scores(scores) for label, scores in self.scores.items()}
        return dict(sorted(means.items(), key=lambda item: -np.nan_to_num(item[1].psnr, nan=-99)))

    @property
    def relative(self) -> dict[str, Scores]:
        """The mean absolute difference between the scores in light 1 and in light 2, by technique.

        It shows how much a small move of the light changes. The techniques have the order of
        `means`. The dictionary is empty unless there are two lights, and a view in which both
        shine.
        """
        both = zip(self.pictures[::2], self.pictures[1::2], strict=False)
        if self.lights != 2 or not any(one.is_lit and other.is_lit for one, other in both):
            return {}
        return {label: average_light_differences(self.scores[label]) for label in self.means}

    @property
    def best(self) -> str:
        """The name of the technique with the best PSNR."""
        return next(iter(self.means))

    @property
    def columns(self) -> tuple[str, ...]:
        """The headings of the table; ">" in front marks columns that are aligned to the right."""
        return ("technique", *(f">{head}" for _, head, *_ in COLUMNS))

    @property
    def interrupted(self) -> bool:
        """True if Ctrl-C ended the comparison before all requested scores were finished."""
        return self.finished < self.requested

    @property
    def finished(self) -> int:
        """The number of finished scores, over all techniques, views and lights."""
        return sum(map(len, self.scores.values()))

    def table(self) -> list[tuple[str, ...]]:
        """Return the mean scores as a table of texts, with a row for each technique."""
        return format_scores(self.means)

    @property
    def meaning(self) -> str:
        """A few sentences that explain the columns of the table."""
        places = len(next(iter(self.scores.values())))
        pairs = "the only pair" if places == 1 else f"{places} pairs"
        return (
            f"{self.cut_short}Means over {pairs} of view and light, each against exact shadows. "
            f"{self.unlit}"
            "Use is the share of texels that the view needs (Q1), aliasing how fine they are "
            "beside its pixels (Q2), flicker the change of the error from picture to picture while "
            "the camera or the light moves."
        )

    @property
    def unlit(self) -> str:
        """A sentence that counts the views in which no light reaches a surface; else empty."""
        count = sum(not each.is_lit for each in self.pictures)
        return f"In {count} of them nothing is in the light: they do not count. " if count else ""

    @property
    def cut_short(self) -> str:
        """A sentence on how much is finished after Ctrl-C, or an empty text."""
        if not self.interrupted:
            return ""
        return f"Interrupted: {self.finished} of {self.requested} scores are finished. "

    def write(self, path: str | Path, progress: Callable[[int, int], object] | None = None) -> None:
        """Write an HTML page with all pictures, and with the table, which readers can sort.

        For each view in each light, it shows the exact shadows. For each technique it shows the
        shadows, the errors, and how the texels of the maps are spread over the scene.

        Parameters
        ----------
        path : str or Path
            The file of the page, NAME.html; it needs no other file.
        progress : callable, optional
            Called with (done, total); see `brdfkit.progress`.

        Raises
        ------
        BrdfkitError
            For another suffix, and if the file cannot be written.

        Examples
        --------
        >>> bk.shadows.compare("street").write("shadows.html")    # doctest: +SKIP
        """
        from brdfkit.shadows.comparison.page import write_page

        write_page(self, path, progress)

    def document(self) -> Document:
        """Return the table of mean scores as a document, with the best of each column in bold."""
        means, texts = list(self.means.values()), self.table()
        best = []
        for name, *_, more in COLUMNS:
            values = [getattr(scores, name) for scores in means]
            known = [value for value in values if not math.isnan(value)]
            best.append((max if more else min)(known, default=math.nan))
        rows = [
            (
                Cell(label),
                *(
                    Cell(text, STRONG if getattr(scores, name) == least else "")
                    for text, (name, *_), least in zip(its, COLUMNS, best, strict=True)
                ),
            )
            for (label, *its), scores in zip(texts, means, strict=True)
        ]
        parts = Table(tuple(rows), self.columns), Paragraph(self.meaning)
        return Document("Shadow techniques", parts)
