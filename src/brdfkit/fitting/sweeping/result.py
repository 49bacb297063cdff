"""`Sweep`, the result of `sweep`: a row for every fit, which is printed and written as tables."""

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
    """One fit of a sweep, or the reason why it failed.

    Attributes
    ----------
    material : str
        The material's name, which is unique in the sweep.
    file : str
        The file, as the user named it.
    model : str
        The model's label.
    loss : str
        The name of the loss, one of `brdfkit.losses.named`.
    error : float
        The error E of that loss, in its units; nan if the fit failed.
    seconds : float
        The wall-clock time of the fit; a saved fit keeps its original time.
    parameters : int
        The number of fitted numbers: the weights of each channel and the shape parameters.
    samples : int
        The number of fitted samples.
    at_bounds : tuple of str
        The parameters that ended on a bound.
    message : str
        The reason why the search stopped, or one sentence on why the fit failed.
    fit : Fit or None
        The fit; None if it failed.
    saved : Path or None
        The file of the saved fit; None if it was not saved.
    held_out : float
        The error E of the loss in directions held out of the fit, all in turn; nan if the sweep
        does not judge its fits, or if there are too few samples.
    psnr : float
        The PSNR [dB] of a ball's picture with the fit to one with the measurement, as in `Ranked`;
        nan if the sweep does not judge its fits.
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
    """The fits of several models to many materials; prints as a table. `sweep` returns it.

    Attributes
    ----------
    rows : tuple of Row
        One row for every fit that finished or failed, ordered by file, then by model.
    requested : int
        The number of planned fits; larger than the number of rows after Ctrl-C.
    found : int
        The number of fits that an earlier sweep had saved.
    seconds : float
        The wall-clock time of the sweep.
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
        """The rows of the fits that failed; the attribute `message` of each gives the reason."""
        return [row for row in self.rows if not row.fit]

    @property
    def warned(self) -> list[Row]:
        """The rows of the fits whose albedo is wrong; ``fit.warnings`` of each describes it."""
        return [row for row in self.rows if row.fit and row.fit.warnings]

    @property
    def best(self) -> dict[str, Fit]:
        """The fit with the least error for each material, by the material's name."""
        best = {
            m: tables.ERROR.find_best_row(found.values())
            for m, found in tables.group_by_material(self).items()
        }
        return {material: row.fit for material, row in best.items() if row}

    @property
    def problems(self) -> list[str]:
        """The messages of the failed fits, each once."""
        return list(dict.fromkeys(row.message for row in self.failed))

    @property
    def summary(self) -> str:
        """A sentence with the number of fits, of failures and of fits with wrong albedos."""
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
        """Return the tables of errors and judgements, the failures and a summary as a document."""
        shown: list[Table | Paragraph] = []
        for quantity in tables.list_quantities(self):
            columns, rows, foot = tables.compare_models(self, quantity)
            table = Table(tuple(map(tuple, rows)), tuple(columns), tuple(map(tuple, foot)))
            shown += [*([Paragraph(quantity.title)] if shown else []), table]
        failed = [Paragraph(problem, BAD) for problem in self.problems]
        return Document(tables.ERROR.title, (*shown, *failed, Paragraph(self.summary, SOFT)))
