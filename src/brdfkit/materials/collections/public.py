"""Public collections of measurements: who published them, where, and their files.

brdfkit ships none of these files. The index has their names, checksums and addresses; the files lie
in the user's cache folder, where `downloading.py` or the user put them.
"""

import csv
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from brdfkit.core import catalogue
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.files import compute_sha256
from brdfkit.materials import formats

PART = ".part"  # suffix of a file whose download is not complete


@dataclass(frozen=True)
class ListedFile:
    """A file of a collection, as the index lists it.

    `name`: for `brdfkit.load`, such as ``merl/alum-bronze``; `file`: its name in the collection's
    folder; `bytes`, `sha256` and `url`: 0 or "" where the index does not have them. After # in the
    URL stands the file's name in a zip archive.
    """

    name: str
    file: str
    bytes: int = 0
    sha256: str = ""
    url: str = ""

    @property
    def path(self) -> Path:
        """The place of the file in the cache folder."""
        return cache_folder() / self.name.partition("/")[0] / self.file


@dataclass(frozen=True)
class Collection:
    """An entry of the index.

    `licence` (a word) and `terms` (a sentence): the conditions of the owners; `page`: the web page
    of the files; `note`: what to fetch together with a file; `files`: the listed files by name,
    empty where the index lists none.
    """

    name: str
    title: str
    citation: str
    licence: str
    terms: str
    page: str
    note: str = ""
    files: dict[str, ListedFile] = field(default_factory=dict, repr=False)

    @property
    def folder(self) -> Path:
        """The folder of its files in the user's cache folder."""
        return cache_folder() / self.name

    def files_on_disk(self) -> dict[str, Path]:
        """Return the paths of the files in `folder` by the names of their materials.

        Files that the user put there count, too, but no files with an unknown suffix.
        """
        files = sorted(self.folder.iterdir()) if self.folder.is_dir() else []
        return {
            _name_material(self.name, f.name): f for f in files if f.is_file() and _is_material(f)
        }

    def explain_by_hand(self, file: str = "") -> str:
        """Return the end of an error: which file to fetch by hand, from where, and its place."""
        note = f", {self.note}" if self.note else ""
        return f"fetch {file or 'its file'} from {self.page} and put it into {self.folder}{note}"

    def __str__(self) -> str:
        return f"Terms: {self.terms}\nCite: {self.citation}\nPage: {self.page}"


def list_collections() -> dict[str, Collection]:
    """Return the public collections by name.

    >>> list_collections()["merl"].files["merl/alum-bronze"].file
    'alum-bronze.binary'
    """
    entries = catalogue.read_index()["collections"]
    return {name: _make_collection(name, entry) for name, entry in entries.items()}


def find_collection(name: str) -> Collection:
    """Return the collection with a name, ``merl``, or with a material, ``merl/alum-bronze``."""
    collections, first = list_collections(), name.partition("/")[0]
    if first not in collections:
        raise no_such_error("collection", first, collections, where=name)
    return collections[first]


def find_file(name: str) -> Path:
    """Return the path of a material's file in a collection, after verifying its checksum.

    Raises `BrdfkitError`, which says how to get the file, where it is missing or was changed.
    """
    owner = find_collection(name)
    listed = owner.files.get(name)
    if listed is None:
        if name in owner.files_on_disk():
            return owner.files_on_disk()[name]
        known = f"'brdfkit data list {owner.name}' names what is known, or " if owner.files else ""
        raise BrdfkitError(f"{name}: is not here; {known}{owner.explain_by_hand()}.")
    remedy = f"run 'brdfkit data get {name}'" if listed.url else owner.explain_by_hand(listed.file)
    if not listed.path.is_file():
        raise BrdfkitError(f"{name}: is not here; {remedy}.")
    if listed.sha256 and compute_sha256(listed.path) != listed.sha256:
        raise BrdfkitError(
            f"{listed.path}: is not the {name} that was published (its checksum differs); "
            f"delete it and {remedy}."
        )
    return listed.path


def cache_folder() -> Path:
    """Return the user's cache folder, which has a folder for each collection."""
    import pooch

    return Path(pooch.os_cache("brdfkit"))


def _is_material(file: Path) -> bool:
    return formats.has_format(file) and not file.name.startswith(".")


def _name_material(collection: str, file: str) -> str:
    return f"{collection}/{file.partition('.')[0]}"


def _make_collection(name: str, entry: dict[str, Any]) -> Collection:
    """Make the `Collection` of an `entry` of the index; its files are there or in a table."""
    rows, url = entry.pop("files"), entry.pop("url", "")
    if isinstance(rows, str):
        with (catalogue.find_data_folder() / rows).open(encoding="utf-8", newline="") as stream:
            rows = list(csv.DictReader(stream, delimiter="\t"))
    listed = [_make_listed(name, url=row.get("url", url), row=row) for row in rows]
    return Collection(name, **entry, files={file.name: file for file in listed})


def _make_listed(collection: str, url: str, row: dict[str, Any]) -> ListedFile:
    """Make the `ListedFile` of a `row`; `url` is a pattern with the row's columns in braces."""
    file = row["file"]
    return ListedFile(
        name=_name_material(collection, file),
        file=file,
        bytes=int(row.get("bytes") or 0),
        sha256=row.get("sha256", ""),
        url=url.format(**row),
    )
