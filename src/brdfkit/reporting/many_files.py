"""Reports of many materials, and the page that leads to them."""

from dataclasses import dataclass
from pathlib import Path

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import make_folder, require_writable
from brdfkit.core.names import make_unique, to_file_stem, to_printable
from brdfkit.core.pages import page
from brdfkit.core.version import __version__
from brdfkit.fitting.compare import format_error
from brdfkit.materials.resolve import to_measured
from brdfkit.reporting.contents import Contents
from brdfkit.reporting.fits import fit_each
from brdfkit.reporting.report import write_report

PAGE = "index.html"


@dataclass(frozen=True)
class Entry:
    """A report: the name of its file in the folder without suffix, and what it says."""

    name: str
    contents: Contents


@dataclass(frozen=True)
class Reports:
    """The reports in a `folder`; `problems`: sentences on what failed; `interrupted`: by Ctrl-C."""

    folder: Path
    entries: list[Entry]
    problems: list[str]
    interrupted: bool

    @property
    def finished(self):
        """How many reports have pictures of all samples that were requested."""
        return sum(entry.contents.spp >= entry.contents.requested for entry in self.entries)

    @property
    def written(self):
        """The files: the page first, if there is a report."""
        files = [self.folder / f"{entry.name}.html" for entry in self.entries]
        return [self.folder / PAGE, *files] if files else []

    def table(self):
        """The names of columns, and rows of texts; a column of numbers begins with ">"."""
        if not self.entries:
            return (), []
        errors = self.entries[0].contents.picture_errors
        columns = "material", "best", "verdict", ">error", *(f">{error.title}" for error in errors)
        rows = [
            (one.material, one.names[0], one.verdict, format_error(one.error), *one.picture_texts)
            for one in (entry.contents for entry in self.entries)
        ]
        return columns, rows


def report_many(files, things, folder, settings, progress=None, **pictures):
    """Write a report of each file, with the models `things`, and the page; returns the `Reports`.

    `settings`: of `fit`; `pictures`: spp, noise_floor, size, seed; `progress`: called with (done,
    total) before each file. A file that cannot be read, and a model that cannot be fitted, do not
    stop the others. Ctrl-C ends with the reports that are finished.
    """
    folder = Path(folder)
    make_folder(folder)
    require_writable(folder / PAGE)
    entries: dict[str, Entry] = {}
    problems, interrupted = [], False
    try:
        for number, file in enumerate(files):
            if progress:
                progress(number, len(files))
            try:
                material = to_measured(file)
                name = make_unique(
                    to_file_stem(material.name), {*entries, PAGE.removesuffix(".html")}
                )
                path = folder / f"{name}.html"
                require_writable(path)
                fits, failed = fit_each(things, material, settings)
                problems += [f"{material.name}: {error}" for error in failed]
                said = write_report(material, fits, path, file, **pictures)
            except BrdfkitError as error:
                problems.append(str(error) if str(file) in str(error) else f"{file}: {error}")
                continue
            entries[name] = Entry(name, said)
            if said.spp < said.requested:  # Ctrl-C during its pictures, which keeps it
                interrupted = True
                break
    except KeyboardInterrupt:
        interrupted = True
        if not entries:
            raise
    found = Reports(folder, [*entries.values()], problems, interrupted)
    if found.entries:
        _write_page(found)
    return found


def _write_page(found):
    """Write the page of a `Reports`."""
    columns, rows = found.table()
    page.write_page(
        "gallery.html",
        found.folder / PAGE,
        entries=[
            {"file": f"{entry.name}.html", "row": row, "said": entry.contents}
            for entry, row in zip(found.entries, rows, strict=True)
        ],
        columns=columns,
        problems=[to_printable(problem) for problem in found.problems],
        version=__version__,
    )
