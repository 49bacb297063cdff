"""`Origin`: where the numbers of a user's table come from, for the errors about them."""

from collections.abc import Sequence
from dataclasses import dataclass

from brdfkit.core.errors import BrdfkitError


@dataclass(frozen=True)
class Origin:
    """Where numbers come from: `name` of the file or the material; `lines`: of a file, the number
    of the line of each row.

    >>> Origin("mine.csv", [2, 3]).row(1)
    'line 3'
    """

    name: str
    lines: Sequence[int] | None = None

    def error(self, problem: str) -> BrdfkitError:
        """A `BrdfkitError`; `problem`: what is wrong and what to do, without a full stop."""
        return BrdfkitError(f"{self.name}: {problem}.")

    def row(self, index: int) -> str:
        """A row in words; rows that are no lines of a file are counted from 0."""
        return f"row {index}" if self.lines is None else f"line {self.lines[index]}"

    @property
    def how_to_say_units(self) -> str:
        """What a person does to say the unit of angles."""
        if self.lines is None:
            return "say unit='degrees' or unit='radians'"
        return "say so in the columns' names, as theta_i [deg] or theta_i [rad]"
