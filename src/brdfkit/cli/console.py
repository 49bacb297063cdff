"""Prints the results of commands as tables or as JSON, and shows progress bars."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from brdfkit.cli import tables
from brdfkit.core.progress_bar import Progress, progress

if TYPE_CHECKING:
    import rich.console

MINIMUM_WIDTH, UNLIMITED_WIDTH = 20, 10_000  # smallest and largest length of a line [characters]


@dataclass(frozen=True)
class Console:
    """Prints results: as JSON if `as_json`; without tables and progress bars if `quiet`."""

    as_json: bool = False
    quiet: bool = False

    @cached_property
    def output(self) -> rich.console.Console:
        """The console of Rich that prints on standard output."""
        from rich.console import Console

        # No markup, because names in files may contain brackets
        out = Console(quiet=self.quiet, highlight=False, markup=False, emoji=False, soft_wrap=True)
        out.width = max(out.width, MINIMUM_WIDTH)  # a terminal may report 0 columns
        return out

    def progress(self, what: str) -> AbstractContextManager[Progress]:
        """Show a progress bar in a block, which gets a function (steps done, in all) to move it."""
        return nullcontext(lambda done, total: None) if self.quiet else progress(what)

    def print_json(self, record: Any) -> None:
        """Print a record of dictionaries, lists, arrays, paths and dataclasses as JSON."""
        from brdfkit.core.json_values import to_json  # imported here because it loads NumPy

        print(json.dumps(to_json(record), indent=2))

    def print_table(
        self, columns: Sequence[str], *sections: Sequence[Sequence[str]], title: str | None = None
    ) -> None:
        """Print a table from the columns' names and `sections`, which are lists of rows of texts.

        A column whose name begins with ">" is right-aligned, for numbers. On a terminal that is too
        narrow, each row becomes a block of lines. In a pipe or a file, lines have any length.
        """
        table = tables.make_table(columns, sections, self.output.width, title)
        if table is None and not self.output.is_terminal and "COLUMNS" not in os.environ:
            self.output.width = UNLIMITED_WIDTH
            table = tables.make_table(columns, sections, self.output.width, title)
        if table is not None:
            self.output.print(table, soft_wrap=False)
            return
        lines = tables.format_blocks(columns, sections, self.output.width)
        self.output.print(title or "", *lines, "", sep="\n")

    def print_image_errors(self, errors: Any) -> None:
        """Print the `ImageErrors` of a rendering as a table."""
        *rows, floor = errors.table()
        title = f"{errors.reference}: errors of pictures"
        self.print_table(errors.columns, rows, [floor], title=title)
        self.output.print("\n".join(errors.remarks))

    def print_doubts(self, findings: Iterable[str]) -> None:
        """Print a line for each of the `findings` of an audit."""
        for finding in findings:
            self.output.print(f"The measurement is doubtful: {finding}.")

    def print_written(self, paths: Iterable[str | Path]) -> None:
        """Print a line for each file that was written."""
        for path in paths:
            self.output.print(f"written: {path}")
