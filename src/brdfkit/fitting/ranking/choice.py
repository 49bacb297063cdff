"""Chooses the model that a ranking recommends, and explains the choice.

The choice starts from the Pareto set: the models that no other model surpasses in both error and
picture. It keeps those with pictures as good as the best one, and of these the ones with errors
tied for the least. From the rest it takes the model with the fewest parameters. A model with
implausible values at grazing angles is only chosen if there is no other.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from brdfkit.fitting.ranking.ranked import Ranked

# Pictures within this PSNR of the best [dB] count as equally good: other random pixels may reverse
# their order
NEAR = 0.5
ROUNDED = 59.0  # pictures with a higher PSNR [dB] than this differ by less than 8-bit rounding
LINES = 3  # number of alternatives to the recommended model that are described


@dataclass(frozen=True)
class Choice:
    """The steps that chose one row of a `Ranking`: the rows that remained after each step.

    `pareto`: rows that no other row surpasses in both error and picture.
    `sound`: those of them whose fits are plausible at grazing angles; if there are none, plausible
        rows with a tied error, and if there are none either, all of `pareto`.
    `near`: those of `sound` whose picture is as good as the best.
    `tied`: those of `near` whose error is tied for the least.
    """

    pareto: list[Ranked]
    sound: list[Ranked]
    near: list[Ranked]
    tied: list[Ranked]

    @classmethod
    def from_rows(cls, rows: Sequence[Ranked]) -> "Choice":
        """Return the choice among rows, at least one of which must be a fitted model."""
        pareto = [row for row in rows if row.pareto]
        certain = [row for row in rows if not row.doubt and not row.message]
        sound = [row for row in certain if row.pareto] or [row for row in certain if row.tied]
        sound = sound or pareto
        best = min(max(row.psnr for row in sound), ROUNDED)
        near = [row for row in sound if row.psnr >= best - NEAR]
        tied = [row for row in near if row.tied] or [min(near, key=lambda row: row.error)]
        return cls(pareto, sound, near, tied)

    @property
    def row(self) -> Ranked:
        """The row of the recommended model."""
        return min(self.tied, key=lambda row: (row.parameters, row.error))

    @property
    def why(self) -> str:
        """The reason for the recommendation, as a clause."""
        if self.pareto == [self.row]:
            return "no other model has a lesser error or a better picture"
        among = f"among the {len(self.pareto)} models that no other beats in both error and picture"
        if not self.row.pareto:
            return "it is tied in error, and all models that no other beats are doubtful"
        if len(self.sound) == 1:
            return f"{among} it alone is without a doubt"
        if len(self.sound) < len(self.pareto):
            among += f", of which {len(self.sound)} are without a doubt,"
        if len(self.near) == 1:
            return f"{among} it has the best picture, by more than {NEAR:g} dB"
        pictures = f"pictures are within {NEAR:g} dB of the best"
        if len(self.tied) == 1:
            return f"{among} it has the least error of the {len(self.near)} whose {pictures}"
        equals = f"the {len(self.tied)} that are tied in error and whose {pictures}"
        return f"{among} it has the fewest parameters of {equals}"

    def describe_alternatives(self, rows: Sequence[Ranked]) -> str:
        """Return a sentence on the best models besides the recommended one, or "" for none."""
        own = self.row
        others = [row for row in self.pareto if row is not own]
        if not others:
            after = [row for row in rows if row is not own and not row.message]
            return f"Next is {_describe_alternative(after[0], own)}." if after else ""
        lines = [_describe_alternative(row, own) for row in others[:LINES]]
        if len(others) > LINES:
            lines.append(f"and {len(others) - LINES} more")
        return f"No other model beats these either: {'; '.join(lines)}."


def _describe_alternative(row: Ranked, own: Ranked) -> str:
    """Compare a row with the recommended one, `own`, in words."""
    more = row.parameters - own.parameters
    number = f"{abs(more)} {'more' if more > 0 else 'fewer'}" if more else "as many"
    gap = row.error - own.error
    error = (
        f"an error {abs(gap):.2g} {'above' if gap > 0 else 'below'} its own" if gap else "its error"
    )
    picture = "as good a picture"
    if abs(better := row.psnr - own.psnr) >= 0.05:
        picture = f"a picture {abs(better):.1f} dB {'better' if better > 0 else 'worse'}"
    return f"{row.model}, with {number} parameter{'s' * (abs(more) != 1)}, {error} and {picture}"
