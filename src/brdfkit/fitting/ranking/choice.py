"""Chooses the model that is recommended, and says why.

The choice starts from the Pareto set: the models that no other beats in both error and picture.
It keeps the models whose pictures look as good as the best one, then the models that are tied for
the least error, and takes the one with the fewest parameters. A model with a doubtful extrapolation
is taken only if no other can be.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from brdfkit.fitting.ranking.ranked import Ranked

# Pictures that are worse than the best by less [dB] may be better when pixels are drawn anew; and
# all that are as near as eight bits round to [dB] look the same
NEAR, ROUNDED = 0.5, 59.0
# Number of other models of the Pareto set that are described
LINES = 3


@dataclass(frozen=True)
class Choice:
    """How one of the rows of a `Ranking` was chosen.

    `pareto`: rows that no other beats; `sound`: those of them without a doubt, or else others that
    are tied, or all of them where each has one; `near`: of these, those whose picture is as good as
    the best; `tied`: of these, those with the least error.
    """

    pareto: list[Ranked]
    sound: list[Ranked]
    near: list[Ranked]
    tied: list[Ranked]

    @classmethod
    def of(cls, rows: Sequence[Ranked]) -> "Choice":
        """Return the choice from rows, of which at least one has to be a model that was fitted."""
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

    def others(self, rows: Sequence[Ranked]) -> str:
        """Return a sentence on the models next to the recommended one, or "" for none."""
        own = self.row
        others = [row for row in self.pareto if row is not own]
        if not others:
            after = [row for row in rows if row is not own and not row.message]
            return f"Next is {_compare(after[0], own)}." if after else ""
        lines = [_compare(row, own) for row in others[:LINES]]
        if len(others) > LINES:
            lines.append(f"and {len(others) - LINES} more")
        return f"No other model beats these either: {'; '.join(lines)}."


def _compare(row: Ranked, own: Ranked) -> str:
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
