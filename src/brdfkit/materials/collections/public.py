"""Lists the public collections of measured materials, and finds their files in the cache folder.

brdfkit ships none of these files. An index lists their names, checksums and addresses;
`downloading.py` or the user puts the files into the user's cache folder. A collection may also have
folders of files, which are photographs of one object.
"""

import csv
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from brdfkit.core import catalogue
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.files import compute_sha256
from brdfkit.materials import formats

PART = ".part"  # suffix of a file while its download is incomplete


@dataclass(frozen=True)
class ListedFile:
    """A file of a public collection, as the index lists it.

    `name`: name of the material for `brdfkit.load`, such as ``merl/alum-bronze``, or of a file in a
    folder of photographs, with its suffix; `file`: name of the file in the collection's folder,
    perhaps behind that of a folder in it; `bytes`: size, or 0 where it is unknown; `sha256`:
    checksum, or "" where it is unknown; `url`: address, or "" where it is unknown. An address with
    # is that of a zip archive, followed by the file's name in the archive.
    """

    name: str
    file: str
    bytes: int = 0
    sha256: str = ""
    url: str = ""

    @property
    def path(self) -> Path:
        """The path of the file in the user's cache folder, where it may not exist yet."""
        return find_cache_folder() / self.name.partition("/")[0] / self.file


@dataclass(frozen=True)
class Collection:
    """A public collection of measured materials, as the index describes it.

    `name`: word before the slash in its materials' names; `title`: name for people; `citation`:
    work to cite; `licence`: the owners' conditions in a word; `terms`: the conditions in a
    sentence; `page`: address of the web page of the files; `note`: hint on what to fetch together
    with a file; `files`: listed files by the names of their materials, empty where none is listed.
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
    def folders(self) -> dict[str, tuple[ListedFile, ...]]:
        """The files of each folder of photographs, by names such as ``captures/cat``."""
        found: dict[str, list[ListedFile]] = {}
        for listed in self.files.values():
            first, slash, _ = listed.file.partition("/")
            if slash:
                found.setdefault(f"{self.name}/{first}", []).append(listed)
        return {name: tuple(files) for name, files in found.items()}

    @property
    def folder(self) -> Path:
        """The folder of the collection's files in the user's cache folder."""
        return find_cache_folder() / self.name

    def list_files_on_disk(self) -> dict[str, Path]:
        """Return the paths of the collection's files on this disk, by their materials' names.

        Files that the user has put there are included, except those with an unknown suffix.
        """
        files = sorted(self.folder.iterdir()) if self.folder.is_dir() else []
        return {
            _name_material(self.name, f.name): f
            for f in files
            if f.is_file() and _is_material_file(f)
        }

    def explain_manual_fetch(self, file: str = "") -> str:
        """Return words for an error: which file to fetch, from which page, and where to put it."""
        note = f", {self.note}" if self.note else ""
        return f"fetch {file or 'its file'} from {self.page} and put it into {self.folder}{note}"

    def __str__(self) -> str:
        return f"Terms: {self.terms}\nCite: {self.citation}\nPage: {self.page}"


def list_collections() -> dict[str, Collection]:
    """Return the public collections of the index by their names.

    >>> list_collections()["merl"].files["merl/alum-bronze"].file
    'alum-bronze.binary'
    """
    entries = catalogue.read_index()["collections"]
    return {name: _make_collection(name, entry) for name, entry in entries.items()}


def find_collection(name: str) -> Collection:
    """Return the collection with the `name` ``merl``, or of the material ``merl/alum-bronze``.

    Raises `BrdfkitError`, which proposes the closest name, where there is none.
    """
    collections, first = list_collections(), name.partition("/")[0]
    if first not in collections:
        raise no_such_error("collection", first, collections, where=name)
    return collections[first]


def find_file(name: str) -> Path:
    """Return the path of a collection's material, such as ``merl/alum-bronze``, on this disk.

    Its checksum is verified. Raises `BrdfkitError`, which says how to get the file, where it is
    missing or was changed.
    """
    owner = find_collection(name)
    listed = owner.files.get(name)
    if name in owner.folders:
        raise BrdfkitError(
            f"{name}: is no material, but photographs of an object; 'brdfkit svbrdf {name}' fits "
            "materials to them."
        )
    if listed is None:
        if name in owner.list_files_on_disk():
            return owner.list_files_on_disk()[name]
        known = f"'brdfkit data list {owner.name}' names what is known, or " if owner.files else ""
        raise BrdfkitError(f"{name}: is not known; {known}{owner.explain_manual_fetch()}.")
    remedy = (
        f"run 'brdfkit data get {name}'" if listed.url else owner.explain_manual_fetch(listed.file)
    )
    if not listed.path.is_file():
        raise BrdfkitError(f"{name}: is not downloaded yet; {remedy}.")
    if listed.sha256 and compute_sha256(listed.path) != listed.sha256:
        raise BrdfkitError(
            f"{listed.path}: is not the {name} that was published (its checksum differs); "
            f"delete it and {remedy}."
        )
    return listed.path


def find_folder(name: str) -> Path:
    """Return the path of a folder of photographs, such as ``captures/cat``, on this disk.

    Raises `BrdfkitError`, which says how to get it, where a file of it is missing.
    """
    owner = find_collection(name)
    if name not in owner.folders:
        raise no_such_error("folder of photographs", name, owner.folders)
    if not all(listed.path.is_file() for listed in owner.folders[name]):
        raise BrdfkitError(f"{name}: is not downloaded yet; run 'brdfkit data get {name}'.")
    return owner.folder / name.partition("/")[2]


def find_cache_folder() -> Path:
    """Return the user's cache folder for brdfkit, which has a folder for each collection."""
    import pooch

    return Path(pooch.os_cache("brdfkit"))


def _is_material_file(file: Path) -> bool:
    return formats.has_format(file) and not file.name.startswith(".")


def _name_material(collection: str, file: str) -> str:
    return f"{collection}/{file if '/' in file else file.partition('.')[0]}"


def _make_collection(name: str, entry: dict[str, Any]) -> Collection:
    """Make a `Collection` from its index `entry`.

    The entry lists the collection's files, or it names a table of text that lists them.
    """
    described = entry.copy()  # the index is shared by all who read it
    rows, url = described.pop("files"), described.pop("url", "")
    if isinstance(rows, str):
        with (catalogue.find_data_folder() / rows).open(encoding="utf-8", newline="") as stream:
            rows = list(csv.DictReader(stream, delimiter="\t"))
    listed = [_make_listed_file(name, url=row.get("url", url), row=row) for row in rows]
    return Collection(name, **described, files={file.name: file for file in listed})


def _make_listed_file(collection: str, url: str, row: dict[str, Any]) -> ListedFile:
    """Make a `ListedFile` from a row of the index.

    `url` is a pattern of the address, with names of the row's columns in braces.
    """
    file = row["file"]
    return ListedFile(
        name=_name_material(collection, file),
        file=file,
        bytes=int(row.get("bytes") or 0),
        sha256=row.get("sha256", ""),
        url=url.format(**row),
    )
