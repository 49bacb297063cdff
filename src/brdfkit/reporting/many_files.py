"""Writes reports of many measured materials, and a page with links to them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import make_folder, require_writable
from brdfkit.core.names import make_unique, to_file_stem, to_printable
from brdfkit.core.pages import page
from brdfkit.core.progress_bar import Progress
from brdfkit.core.version import __version__
from brdfkit.fitting.compare import format_error
from brdfkit.fitting.settings import FitSettings
from brdfkit.materials.resolve import to_measured
from brdfkit.reporting.contents import Contents
from brdfkit.reporting.fits import fit_models
from brdfkit.reporting.report import write_report

PAGE = "index.html"


@dataclass(frozen=True)
class Entry:
    """A finished report of one material; `name`: name of its file, without the suffix."""

    name: str
    contents: Contents


@dataclass(frozen=True)
class Reports:
    """The reports of many materials, in one folder.

    folder : the folder of the reports.
    entries : the finished reports.
    problems : sentences on files and models that failed.
    interrupted : whether Ctrl-C ended the work early.
    """

    folder: Path
    entries: list[Entry]
    problems: list[str]
    interrupted: bool

    @property
    def finished_count(self) -> int:
        """The number of reports whose pictures have all requested samples per pixel."""
        return sum(entry.contents.spp >= entry.contents.requested for entry in self.entries)

    @property
    def written_files(self) -> list[Path]:
        """The files that were written, the page with links first."""
        files = [self.folder / f"{entry.name}.html" for entry in self.entries]
        return [self.folder / PAGE, *files] if files else []

    def make_table(self) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
        """Return a table of the reports: names of columns, and a row of texts for each report.

        The names of columns with numbers, which are aligned right, start with ">".
        """
        if not self.entries:
            return (), []
        errors = self.entries[0].contents.picture_errors
        columns = "material", "best", "verdict", ">error", *(f">{error.title}" for error in errors)
        rows = [
            (one.material, one.names[0], one.verdict, format_error(one.error), *one.picture_texts)
            for one in (entry.contents for entry in self.entries)
        ]
        return columns, rows


def write_reports(
    files: Sequence[str],
    models: Sequence[Any],
    folder: str | Path,
    settings: FitSettings,
    progress: Progress | None = None,
    **pictures: Any,
) -> Reports:
    """Write a report of each file, with fits of the `models`, and a page with links to them.

    Files that cannot be read and models that cannot be fitted do not stop the work; after Ctrl-C
    the page shows the finished reports. `settings`: arguments of the fits; `pictures`: arguments of
    `render_pictures`; `progress`: a function that is called with (done, total) before each file.
    """
    folder = Path(folder)
    make_folder(folder)
    require_writable(folder / PAGE)
    entries: dict[str, Entry] = {}
    problems: list[str] = []
    interrupted = False
    try:
        for number, file in enumerate(files):
            if progress:
                progress(number, len(files))
            try:
                material = to_measured(file)
                taken = {*entries, PAGE.removesuffix(".html")}
                name = make_unique(to_file_stem(material.name), taken)
                path = folder / f"{name}.html"
                require_writable(path)
                fits, errors = fit_models(models, material, settings)
                problems += [f"{material.name}: {error}" for error in errors]
                contents = write_report(material, fits, path, file, **pictures)
            except BrdfkitError as error:
                problems.append(str(error) if str(file) in str(error) else f"{file}: {error}")
                continue
            entries[name] = Entry(name, contents)
            if contents.spp < contents.requested:  # Ctrl-C ended this report's pictures
                interrupted = True
                break
    except KeyboardInterrupt:
        interrupted = True
        if not entries:
            raise
    reports = Reports(folder, [*entries.values()], problems, interrupted)
    if reports.entries:
        _write_links_page(reports)
    return reports


def _write_links_page(reports: Reports) -> None:
    """Write the page with a table of the reports and links to them."""
    columns, rows = reports.make_table()
    page.write_page(
        "gallery.html",
        reports.folder / PAGE,
        entries=[
            {"file": f"{entry.name}.html", "row": row, "contents": entry.contents}
            for entry, row in zip(reports.entries, rows, strict=True)
        ],
        columns=columns,
        problems=[to_printable(problem) for problem in reports.problems],
        version=__version__,
    )
