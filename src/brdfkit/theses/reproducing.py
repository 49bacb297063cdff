"""Runs the claims of a thesis and writes them to a page, by the public function `reproduce`."""

from __future__ import annotations

import importlib
import pkgutil
import sys
from collections.abc import Generator, Mapping
from contextlib import closing
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

from brdfkit.core.cluster import count_cluster_slots, require_result, run_tasks
from brdfkit.core.documents import Document, Shown, Table
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.files import make_folder, require_writable
from brdfkit.core.progress_bar import Progress
from brdfkit.theses.claims import Claim, describe_counts
from brdfkit.theses.page import Section, encode_pictures, write_page
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
    client: Any = None,
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
    client : distributed.Client, optional
        A cluster that checks the parts in place of this process, a task for each part. The folders
        must have the same paths there.
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
    if client is not None:
        count_cluster_slots(client)
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
    seconds = {part: _import_part(name, part).SECONDS for part in chosen}
    report = progress or (lambda done, total: None)
    check = _check_here if client is None else partial(_check_on_cluster, client)
    sections: dict[str, Section] = {}
    try:
        with closing(check(name, sources, seconds, report)) as checked:
            for part, section in checked:
                sections[part] = section
    except KeyboardInterrupt:
        if not sections:
            raise
    done = [sections[part] for part in chosen if part in sections]
    left, written = [part for part in chosen if part not in sections], []
    if path is not None:
        page = Path(path) / f"{name}.md"
        written = write_page(page, thesis.TITLE, thesis.INTRODUCTION, done, left)
    claims = tuple(claim for section in done for claim in section.claims)
    return Reproduction(name, claims, tuple(written), tuple(left))


def _check_here(
    name: str, sources: Sources, seconds: Mapping[str, int], report: Progress
) -> Generator[tuple[str, Section], None, None]:
    """Yield each part of a thesis and its section; `seconds` are about how long the parts take."""
    before, total = 0, sum(seconds.values())
    for part, own in seconds.items():
        report(before, total)
        own_report = _scale_progress(report, before, own, total)
        yield part, _import_part(name, part).check_claims(sources, own_report)
        before += own


def _check_on_cluster(
    client: Any, name: str, sources: Sources, seconds: Mapping[str, int], report: Progress
) -> Generator[tuple[str, Section], None, None]:
    """Yield each part of a thesis and its section, as the cluster of a `client` finishes them.

    The longest parts begin first, so that none is left alone at the end.
    """
    parts = sorted(seconds, key=seconds.__getitem__, reverse=True)
    done, total = 0, sum(seconds.values())
    report(done, total)
    with closing(run_tasks(_check_part, parts, client, shared=(name, sources))) as results:
        for part, result in results:
            yield part, require_result(result)
            done += seconds[part]
            report(done, total)


def _check_part(shared: tuple[str, Sources], part: str) -> Section:
    """Check the claims of a part of a thesis; `shared` are the thesis's name and its files."""
    name, sources = shared
    checked = _import_part(name, part).check_claims(sources, lambda done, total: None)
    return encode_pictures(checked)


def _import_part(name: str, part: str) -> ModuleType:
    """Import a part of a thesis."""
    return importlib.import_module(f"{_import_thesis(name).__name__}.{part}")


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
