"""`Sweep`, what a sweep returns: a row for every fit; prints as a table, and writes it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

from brdfkit.core.documents import Document, Paragraph, Shown, Table
from brdfkit.core.documents.parts import BAD, SOFT
from brdfkit.fitting.sweeping import tables
from brdfkit.fitting.sweeping.page import write_sweep_page
from brdfkit.regression import Fit


@dataclass(frozen=True)
class Row:
    """One fit of a sweep, or why there is none.

    Attributes
    ----------
    material : str
        The name of the file's material in the sweep, unlike all others.
    file : str
        The file, as it was named.
    model : str
        The model's label.
    loss : str
        Name of the loss, one of `brdfkit.losses.named`.
    error : float
        E of that loss, in its units; nan where the fit failed.
    seconds : float
        Wall-clock time; of a saved fit, what it took then.
    parameters : int
        How many numbers were sought: the weights of each channel, and the shape parameters.
    samples : int
        How many samples were fitted.
    at_bounds : tuple of str
        Parameters that ended on a bound.
    message : str
        Why the search stopped, or one sentence on why the fit failed.
    fit : Fit or None
        The fit; None where it failed.
    saved : Path or None
        Its file, where it was saved.
    held_out : float
        E of the loss in directions that were held out of the fit, all in turn; nan where the sweep
        does not judge, and where there are too few.
    psnr : float
        PSNR [dB] of a picture of a ball of the fit beside the measurement's, as in `Ranked`; nan
        where the sweep does not judge.
    """

    material: str
    file: str
    model: str
    loss: str
    error: float = math.nan
    seconds: float = field(default=math.nan, compare=False)
    parameters: int = 0
    samples: int = 0
    at_bounds: tuple[str, ...] = ()
    message: str = ""
    fit: Fit | None = field(default=None, repr=False)
    saved: Path | None = field(default=None, repr=False, compare=False)
    held_out: float = math.nan
    psnr: float = math.nan


@dataclass(frozen=True, repr=False)
class Sweep(Shown):
    """The fits of several models to many materials; prints as a table. Made by `sweep`.

    Attributes
    ----------
    rows : tuple of Row
        One for every fit that is finished or failed: by file, then by model.
    requested : int
        How many fits were asked for; more than there are rows after Ctrl-C.
    found : int
        How many of the fits had been saved by an earlier sweep.
    seconds : float
        Wall-clock time.
    """

    rows: tuple[Row, ...]
    requested: int
    found: int = 0
    seconds: float = field(default=math.nan, compare=False)

    @property
    def fits(self) -> list[Fit]:
        """The fits that succeeded."""
        return [row.fit for row in self.rows if row.fit]

    @property
    def failed(self) -> list[Row]:
        """The rows of the fits that failed; their `message` says why."""
        return [row for row in self.rows if not row.fit]

    @property
    def warned(self) -> list[Row]:
        """The rows of the fits whose light is wrong; their ``fit.warnings`` say how."""
        return [row for row in self.rows if row.fit and row.fit.warnings]

    @property
    def best(self) -> dict[str, Fit]:
        """The fit with the least error of every material that has one, by the material's name."""
        best = {
            m: tables.ERROR.best(found.values()) for m, found in tables.by_material(self).items()
        }
        return {material: row.fit for material, row in best.items() if row}

    @property
    def problems(self) -> list[str]:
        """The sentences on what failed, each once: a file that cannot be read has one."""
        return list(dict.fromkeys(row.message for row in self.failed))

    @property
    def summary(self) -> str:
        """How many fits there are, and of how many the light is wrong, in words."""
        before = f", {self.found} of them saved before" if self.found else ""
        failed = f"; {len(self.failed)} failed" if self.failed else ""
        wrong = f"; the light of {len(self.warned)} is wrong (!)" if self.warned else ""
        done = f"{len(self.fits)} of {self.requested} fits{before}"
        return f"{done}{failed}{wrong}; {self.seconds:.1f} s"

    def to_csv(self, path: str | Path) -> None:
        """Write the rows as comma-separated values, in UTF-8.

        Parameters
        ----------
        path : str or Path
            The file. The parameters' values are in one column, as JSON; the albedos of a fit and
            of its measurement, the mean over the channels, in one for each angle [degrees].

        Raises
        ------
        BrdfkitError
            Where the file cannot be written.

        Examples
        --------
        >>> sweep(["a.binary", "b.binary"], "ggx").to_csv("table.csv")    # doctest: +SKIP
        """
        tables.write_csv(self, path)

    def to_parquet(self, path: str | Path) -> None:
        """Write the rows as an Apache Parquet table; needs the package pyarrow.

        Parameters
        ----------
        path : str or Path
            The file. Its columns are those of `to_csv`.

        Raises
        ------
        BrdfkitError
            Where pyarrow is not installed or the file cannot be written.

        Examples
        --------
        >>> sweep(["a.binary", "b.binary"], "ggx").to_parquet("table.parquet")    # doctest: +SKIP
        """
        tables.write_parquet(self, path)

    def to_html(self, path: str | Path) -> None:
        """Write a page with the errors, the failures and all fits; its tables can be sorted.

        Parameters
        ----------
        path : str or Path
            The file. It links to the saved fits.

        Raises
        ------
        BrdfkitError
            Where the file cannot be written.

        Examples
        --------
        >>> sweep(["a.binary", "b.binary"], "ggx").to_html("index.html")    # doctest: +SKIP
        """
        write_sweep_page(self, path)

    def document(self) -> Document:
        """The errors, materials by models, and how they were judged; what failed, and how many fits
        there are."""
        shown: list[Table | Paragraph] = []
        for quantity in tables.quantities(self):
            columns, rows, foot = tables.compare(self, quantity)
            table = Table(tuple(map(tuple, rows)), tuple(columns), tuple(map(tuple, foot)))
            shown += [*([Paragraph(quantity.title)] if shown else []), table]
        failed = [Paragraph(problem, BAD) for problem in self.problems]
        return Document(tables.ERROR.title, (*shown, *failed, Paragraph(self.summary, SOFT)))
