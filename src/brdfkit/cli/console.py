"""Prints the results of commands: tables for people, or JSON; and a progress bar."""

import json
import os
from contextlib import nullcontext
from dataclasses import dataclass
from functools import cached_property

from brdfkit.cli import tables
from brdfkit.core.json_values import to_json
from brdfkit.core.progress_bar import progress

NARROWEST, WIDEST = 20, 10_000  # characters


@dataclass(frozen=True)
class Console:
    """Prints results. `as_json`: as JSON, for programs; `quiet`: no tables and no progress bar."""

    as_json: bool = False
    quiet: bool = False

    @cached_property
    def out(self):
        """Rich's console, which prints on standard output."""
        from rich.console import Console

        # no markup: names from files may hold brackets
        found = Console(
            quiet=self.quiet, highlight=False, markup=False, emoji=False, soft_wrap=True
        )
        found.width = max(found.width, NARROWEST)  # a terminal may say that it has 0 columns
        return found

    def progress(self, what):
        """Within the block a bar shows the progress of `what`; gives a function (done, total)."""
        return nullcontext(lambda done, total: None) if self.quiet else progress(what)

    def json(self, record):
        """Print a result as JSON; `record`: dictionaries, lists, arrays, paths and dataclasses."""
        print(json.dumps(to_json(record), indent=2))

    def table(self, columns, *sections, title=None):
        """Print a table. `columns`: their names; `sections`: lists of rows of texts.

        A column whose name begins with ">" is flush right, for numbers. On a terminal that is too
        narrow each row becomes a block of lines; a pipe or a file gets lines as long as they are.
        """
        found = tables.table(columns, sections, self.out.width, title)
        if found is None and not self.out.is_terminal and "COLUMNS" not in os.environ:
            self.out.width = WIDEST
            found = tables.table(columns, sections, self.out.width, title)
        if found is not None:
            self.out.print(found, soft_wrap=False)
            return
        lines = tables.blocks(columns, sections, self.out.width)
        self.out.print(title or "", *lines, "", sep="\n")

    def print_image_errors(self, errors):
        """Print `ImageErrors` as a table."""
        *rows, floor = errors.table()
        self.table(errors.columns, rows, [floor], title=f"{errors.reference}: errors of pictures")
        self.out.print("\n".join(errors.remarks))

    def list_doubts(self, findings):
        """Print a line for each of the `findings` of an audit."""
        for finding in findings:
            self.out.print(f"The measurement is doubtful: {finding}.")

    def list_written(self, paths):
        """Print a line for each file that was written."""
        for path in paths:
            self.out.print(f"written: {path}")
