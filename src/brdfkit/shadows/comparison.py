"""`ShadowComparison`, what `compare` returns: scores by technique; prints as a table."""

from dataclasses import dataclass

from brdfkit.documents import Cell, Document, Paragraph, Shown, Table
from brdfkit.documents.parts import STRONG
from brdfkit.shadows.scores import Scores, between_lights, mean

# Name, heading, scale, decimals, and whether more is better
COLUMNS = (
    ("psnr", "PSNR [dB]", 1, 1, True),
    ("wrong", "wrong [%]", 100, 2, False),
    ("acne", "acne [%]", 100, 2, False),
    ("texture_use", "use [%]", 100, 1, True),
    ("aliasing", "aliasing [dB]", 1, 1, True),
    ("flicker", "flicker [%]", 100, 3, False),
    ("build", "build [ms]", 1e3, 0, False),
    ("look_up", "look-up [ms]", 1e3, 0, False),
)


@dataclass(frozen=True, repr=False)
class ShadowComparison(Shown):
    """Scores of shadow techniques against exact shadows; prints as a table.

    Attributes
    ----------
    scores : dict
        Technique → its `Scores` in each view and light: all lights of the first view, then of the
        next.
    lights : int
        How many lights there are.
    """

    scores: dict[str, tuple[Scores, ...]]
    lights: int

    @property
    def means(self) -> dict[str, Scores]:
        """Technique → the means over views and lights, the best PSNR first."""
        found = {label: mean(scores) for label, scores in self.scores.items()}
        return dict(sorted(found.items(), key=lambda item: -item[1].psnr))

    @property
    def relative(self) -> dict[str, Scores]:
        """Technique → the mean differences between the two lights of each view: how much a light
        that hardly moves changes. Empty where there are not two lights."""
        if self.lights != 2:
            return {}
        return {label: between_lights(scores) for label, scores in self.scores.items()}

    @property
    def best(self) -> str:
        """The technique with the best PSNR."""
        return next(iter(self.means))

    @property
    def columns(self) -> tuple[str, ...]:
        """The heads of the table."""
        return ("technique", *(f">{head}" for _, head, *_ in COLUMNS))

    def table(self) -> list[tuple[str, ...]]:
        """The means as texts, a row for each technique."""
        return [
            (
                label,
                *(
                    f"{getattr(row, name) * scale:.{digits}f}"
                    for name, _, scale, digits, _ in COLUMNS
                ),
            )
            for label, row in self.means.items()
        ]

    @property
    def meaning(self) -> str:
        """What the columns are, in a sentence or two."""
        places = len(next(iter(self.scores.values())))
        pairs = "the only pair" if places == 1 else f"{places} pairs"
        return (
            f"Means over {pairs} of view and light, each against exact shadows. Use is the share "
            "of texels that the view needs (Q1), aliasing how fine they are beside its pixels "
            "(Q2), flicker the change of the error from picture to picture while the camera moves."
        )

    def document(self) -> Document:
        """The means, a row for each technique, the best of each column strong."""
        means, texts = list(self.means.values()), self.table()
        best = []
        for name, *_, more in COLUMNS:
            values = [getattr(scores, name) for scores in means]
            best.append((max if more else min)(values))
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
