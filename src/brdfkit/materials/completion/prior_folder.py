"""Makes a prior of a folder of measured materials, and keeps their sources and terms of use."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.files import compute_sha256
from brdfkit.core.progress_bar import Progress
from brdfkit.materials.collections.public import list_collections
from brdfkit.materials.completion.prior import VISIBLE, Prior
from brdfkit.materials.completion.prior_cells import CELLS, get_cells, to_logarithm
from brdfkit.materials.completion.prior_choice import get_default_prior
from brdfkit.materials.completion.prior_making import make_prior
from brdfkit.materials.loading import load
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.albedos import make_measured_test
from brdfkit.materials.measured.evidence import is_completed
from brdfkit.materials.measured.spectrum_to_rgb import has_wavelengths, wavelengths

FEWEST_MATERIALS = 30  # of fewer, a prior tells less than that of models
# Of a spectrum, so many wavelengths are taken: those between them tell nothing more
MOST_CHANNELS = 3
LEAST_MEASURED = 0.5  # share of the cells that were measured; values between them are interpolated
DOCUMENTS = re.compile(r"licen[cs]e|copying|terms|readme|index|checksums|sha256", re.I)
WITH_TERMS = re.compile(r"licen[cs]e|copying|terms|readme", re.I)
TERMS = re.compile(r"licen[cs]e|terms|permission|copyright|\bCC0\b|\bCC.BY|public domain", re.I)
LONGEST_TERMS = 300  # characters


@dataclass(frozen=True)
class FolderPrior:
    """A prior that was made of a folder.

    `skipped`: for each file that was left out, its name and the reason.
    """

    prior: Prior
    skipped: dict[str, str]


@dataclass(frozen=True)
class FileRows:
    """A material of a folder.

    `logarithms` (channels, CELLS); `wavelengths`: shortest and longest [nm]; `source`: its line.
    """

    logarithms: FloatArray
    wavelengths: tuple[float, float]
    source: str


def make_folder_prior(
    folder: str | Path,
    *,
    terms: str | None = None,
    with_models: bool = True,
    progress: Progress | None = None,
) -> FolderPrior:
    """Make a prior of all materials in a folder that `brdfkit.load` reads.

    Anisotropic materials, files that cannot be read, copies, and materials that were measured in
    less than half of the hemisphere are left out. Measured values are interpolated.

    Parameters
    ----------
    folder : str or Path
        The folder, with at least 30 such materials, directly in it.
    terms : str, optional
        Terms of use of the files. By default those of the collection that the folder belongs to, or
        of a file such as LICENSE or README in the folder.
    with_models : bool, default True
        Whether the random materials of the prior that comes with brdfkit count as well, by 30 %.
        This helps with materials unlike those in the folder, and even with others like them.
    progress : callable, optional
        A function (done, total) that is called after each file.

    Returns
    -------
    FolderPrior
        The prior, and the files that were left out, with reasons.

    Raises
    ------
    BrdfkitError
        If the folder has too few such materials, or does not exist.

    Examples
    --------
    >>> made = make_folder_prior("merl", terms="research only")    # doctest: +SKIP
    >>> complete("twenty.csv", prior=made.prior)    # doctest: +SKIP
    """
    place = Path(folder)
    if not place.is_dir():
        raise BrdfkitError(f"{folder}: there is no such folder; name one with measured materials.")
    files, skipped = list(list_files(place)), {}
    rows: list[FileRows] = []
    known: dict[str, str] = {}  # names of the files by their checksums
    for k, file in enumerate(files):
        try:
            rows.append(read_rows(file, known))
            known[rows[-1].source.rpartition(" ")[2]] = file.name
        except BrdfkitError as error:
            # What follows in the error is advice that does not matter here
            skipped[file.name] = str(error).removeprefix(f"{file}: ").partition(";")[0].rstrip(".")
        if progress:
            progress(k + 1, len(files))
    if len(rows) < FEWEST_MATERIALS:
        raise BrdfkitError(describe_lack(place, len(rows), skipped))
    prior = make_prior(
        f"{place.resolve().name}, with brdfkit's models" if with_models else place.resolve().name,
        np.concatenate([row.logarithms for row in rows]),
        np.repeat(np.arange(len(rows)), [len(row.logarithms) for row in rows]),
        base=get_default_prior() if with_models else None,
        sources=tuple(row.source for row in rows),
        terms=(terms or find_terms(place),),
        wavelengths=(
            min(row.wavelengths[0] for row in rows),
            max(row.wavelengths[1] for row in rows),
        ),
    )
    return FolderPrior(prior, skipped)


def list_files(folder: Path) -> Iterator[Path]:
    """Yield the files in a folder by name, except those that describe the others."""
    for file in sorted(folder.iterdir()):
        if file.is_file() and not file.name.startswith(".") and not DOCUMENTS.search(file.name):
            yield file


def read_rows(file: Path, known: dict[str, str]) -> FileRows:
    """Read a material; raise `BrdfkitError`, with the reason, if it does not suit a prior.

    `known` are the names of files that were read, by their checksums.
    """
    checksum = compute_sha256(file)
    if checksum in known:
        raise BrdfkitError(f"it is a copy of {known[checksum]}")
    data = load(file)
    if not isinstance(data, Measured):
        raise BrdfkitError("it is a fit, not a measurement")
    if is_completed(data):
        raise BrdfkitError("it is completed, not measured")
    if data.anisotropic:
        raise BrdfkitError("it is anisotropic")
    cells = get_cells()
    measured = np.mean(make_measured_test(data)(cells.wi[cells.own], cells.wo[cells.own]))
    if measured < LEAST_MEASURED:
        raise BrdfkitError(f"it was measured in only {measured:.0%} of the hemisphere")
    count = len(data.channels)
    columns = np.unique(np.linspace(0, count - 1, min(count, MOST_CHANNELS)).round().astype(int))
    values = data.eval(cells.wi, cells.wo)[:, columns]
    if not np.isfinite(values).all() or values.max() <= 0:
        raise BrdfkitError("it has no values above 0, or not in all directions")
    span = wavelengths(data)[columns] if has_wavelengths(data) else np.array(VISIBLE)
    rows = to_logarithm(values.T, cells.cosine).reshape(-1, CELLS)
    return FileRows(rows, (span.min(), span.max()), f"{file.name} sha256 {checksum}")


def describe_lack(folder: Path, count: int, skipped: dict[str, str]) -> str:
    """Return the sentence of the error about a folder of too few materials."""
    reasons = "".join(f"; {name}: {reason}" for name, reason in list(skipped.items())[:3])
    return (
        f"{folder} has {count} materials that suit a prior, which needs {FEWEST_MATERIALS} or more"
        f"{reasons}; add others, or use the prior that comes with brdfkit."
    )


def find_terms(folder: Path) -> str:
    """Return the terms of use of the files in a folder, as far as it states them."""
    for collection in list_collections().values():
        if collection.folder.resolve() == folder.resolve():
            return collection.terms
    documents = [f for f in sorted(folder.iterdir()) if f.is_file() and WITH_TERMS.search(f.name)]
    # A file that is named after its terms comes before one that may mention them
    for file in sorted(documents, key=lambda f: "readme" in f.name.lower()):
        text = file.read_bytes()[:100_000].decode(errors="replace")
        for paragraph in re.split(r"\n\s*\n", text):
            if TERMS.search(paragraph):
                words = " ".join(paragraph.split())
                cut = words if len(words) <= LONGEST_TERMS else f"{words[:LONGEST_TERMS]}…"
                return f"{file.name}: {cut}"
    return f"the terms of use of the files in {folder.resolve().name} are not stated"
