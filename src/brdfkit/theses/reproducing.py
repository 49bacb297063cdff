"""Runs the claims of a thesis and writes them to a page, by the public function `reproduce`."""

from __future__ import annotations

import importlib
import pkgutil
import sys
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from brdfkit.core.documents import Document, Shown, Table
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.files import make_folder, require_writable
from brdfkit.core.progress_bar import Progress
from brdfkit.theses.claims import Claim, describe_counts
from brdfkit.theses.page import write_page
from brdfkit.theses.sources import Sources, find_sources


@dataclass(frozen=True, repr=False)
class Reproduction(Shown):
    """The claims of a thesis with their results, made by `reproduce`; prints as a list.

    Attributes
    ----------
    name : str
        The thesis.
    claims : tuple of Claim
        The claims with the printed figures, the figures here and the verdicts, in the order of the
        page.
    written : tuple of Path
        The page, and its figures.
    unfinished : tuple of str
        Parts that Ctrl-C left out.
    """

    name: str
    claims: tuple[Claim, ...]
    written: tuple[Path, ...] = ()
    unfinished: tuple[str, ...] = ()

    def document(self) -> Document:
        """Return a table of the claims: verdict, claim, printed figures, figures here."""
        rows = tuple((c.verdict, f"{c.says} ({c.where})", c.printed, c.ours) for c in self.claims)
        title = f"{self.name}: {describe_counts(self.claims)}"
        return Document(title, (Table(rows, ("verdict", "claim", "printed", "here")),))


def list_theses() -> dict[str, str]:
    """Return the titles of the theses that can be reproduced, by name.

    >>> list(list_theses())
    ['balint2019', 'ergun2008', 'ergun2015', 'kurt2007', 'lesar2018']
    """
    modules = pkgutil.iter_modules(sys.modules[__package__].__path__)
    return {m.name: _import_thesis(m.name).TITLE for m in modules if m.ispkg}


def reproduce(
    name: str,
    *,
    path: str | Path | None = None,
    data: str | Path | None = None,
    tables: str | Path | None = None,
    parts: list[str] | None = None,
    progress: Progress | None = None,
) -> Reproduction:
    """Check the claims of a thesis by running them, and write the results as a page.

    The measurements are third-party files, which brdfkit does not contain. Ctrl-C ends with the
    parts that are finished.

    Parameters
    ----------
    name : str
        The thesis, such as ``"kurt2007"``.
    path : str or Path, optional
        A folder for the page, ``kurt2007.md``, and its figures; by default none is written.
    data : str or Path, optional
        The folder of measurements, by default the one that the variable BRDFKIT_DATA names.
    tables : str or Path, optional
        The folder of tables transcribed from theses, by default ``thesis`` beside `data`. Claims
        that need one are not run where it is missing.
    parts : list of str, optional
        Only these parts, such as ``["table_9_1"]``; by default all.
    progress : callable, optional
        Called with (done, total) as the claims are run.

    Returns
    -------
    Reproduction
        The claims with their verdicts; prints as a list.

    Raises
    ------
    BrdfkitError
        For an unknown thesis or part, and for a measured file that is missing.

    Examples
    --------
    >>> print(reproduce("kurt2007", path="docs/reproduce"))    # doctest: +SKIP
    """
    if name not in list_theses():
        raise no_such_error("thesis", name, list_theses())
    thesis = _import_thesis(name)
    for part in parts or ():
        if part not in thesis.PARTS:
            raise no_such_error("part", part, thesis.PARTS, where=name)
    sources = find_sources(data, tables, thesis.NEEDS)
    _require_packages(thesis, sources)
    if path is not None:
        make_folder(path)
        require_writable(Path(path) / f"{name}.md")

    chosen = [part for part in thesis.PARTS if parts is None or part in parts]
    modules = [importlib.import_module(f"{thesis.__name__}.{part}") for part in chosen]
    total, sections, written = sum(m.SECONDS for m in modules), [], []
    report = progress or (lambda done, total: None)
    try:
        for number, module in enumerate(modules):
            before = sum(m.SECONDS for m in modules[:number])
            report(before, total)
            sections.append(
                module.check_claims(sources, _scale_progress(report, before, module.SECONDS, total))
            )
    except KeyboardInterrupt:
        if not sections:
            raise
    if path is not None:
        page, left = Path(path) / f"{name}.md", chosen[len(sections) :]
        written = write_page(page, thesis.TITLE, thesis.INTRODUCTION, sections, left)
    claims = tuple(claim for section in sections for claim in section.claims)
    return Reproduction(name, claims, tuple(written), tuple(chosen[len(sections) :]))


def _require_packages(thesis: ModuleType, sources: Sources) -> None:
    """Raise `BrdfkitError` if a package that one of the measured files needs is not installed.

    Without this check, a claim in the middle of a long run would fail.
    """
    for file, package in getattr(thesis, "PACKAGES", {}).items():
        if sources.find_beside(file) and find_spec(package) is None:
            raise BrdfkitError(
                f'{file}: needs the package {package}; pip install "brdfkit[volumes]" brings it.'
            )


def _import_thesis(name: str) -> ModuleType:
    """Import the package of a thesis, whose claims are its modules."""
    return importlib.import_module(f"{__package__}.{name}")


def _scale_progress(report: Progress, before: int, seconds: int, total: int) -> Progress:
    """Return a progress function for one part of a thesis, which reports the progress of all parts.

    Progress is counted in seconds: the part takes `seconds`, the earlier parts took `before`, and
    all parts take `total`.
    """
    return lambda done, of: report(before + seconds * done / of, total)  # type: ignore[arg-type]  # counts fractions of seconds
