"""Public collections of measurements: who published them where, and their files.

brdfkit brings none of them. The index knows names, checksums and addresses; the files lie in the
user's cache folder, where `downloading.py` or the user put them.
"""

import csv
from dataclasses import dataclass, field
from pathlib import Path

from brdfkit import formats
from brdfkit.catalogue import index
from brdfkit.errors import BrdfkitError, no_such
from brdfkit.files import sha256

PART = ".part"  # the suffix of a file that is not all here


@dataclass(frozen=True)
class Listed:
    """A file of a collection.

    `name`: what `brdfkit.load` takes, as ``merl/alum-bronze``; `bytes`, `sha256`, `url`: where
    they are known. What follows # in the URL is the file's name in a zip archive.
    """

    name: str
    file: str
    bytes: int = 0
    sha256: str = ""
    url: str = ""

    @property
    def path(self):
        """Its place in the cache folder."""
        return cache() / self.name.partition("/")[0] / self.file


@dataclass(frozen=True)
class Collection:
    """An entry of the index.

    `licence` in a word, `terms` in a sentence, as the owners state them; `page`: where they
    publish the files; `note`: what else belongs to a file; `files`: the `Listed` by name, none
    where the index knows none.
    """

    name: str
    title: str
    citation: str
    licence: str
    terms: str
    page: str
    note: str = ""
    files: dict[str, Listed] = field(default_factory=dict, repr=False)

    @property
    def folder(self):
        """Where its files lie."""
        return cache() / self.name

    def here(self):
        """The files that lie there by the names of their materials, with those that the index
        does not know: a person may put more into the folder. Other files are no materials."""
        there = sorted(self.folder.iterdir()) if self.folder.is_dir() else []
        return {_named(self.name, f.name): f for f in there if f.is_file() and _is_material(f)}

    def by_hand(self, file=""):
        """Which file to fetch from which page, and where to put it: the end of a sentence."""
        note = f", {self.note}" if self.note else ""
        return f"fetch {file or 'its file'} from {self.page} and put it into {self.folder}{note}"

    def __str__(self):
        return f"Terms: {self.terms}\nCite: {self.citation}\nPage: {self.page}"


def collections():
    """The public collections by name.

    >>> collections()["merl"].files["merl/alum-bronze"].file
    'alum-bronze.binary'
    """
    entries = index.entries()["collections"]
    return {name: _collection(name, entry) for name, entry in entries.items()}


def collection(name):
    """The `Collection` of that name, or that of a material, ``merl`` or ``merl/alum-bronze``."""
    first = name.partition("/")[0]
    if first not in collections():
        raise no_such("collection", first, collections(), where=name)
    return collections()[first]


def path(name):
    """The file of a material in a collection, once its checksum is right.

    Raises `BrdfkitError`, which says how to get it, for a file that is not here or was changed.
    """
    owner = collection(name)
    listed = owner.files.get(name)
    if listed is None:
        if name in owner.here():
            return owner.here()[name]
        known = f"'brdfkit data list {owner.name}' names what is known, or " if owner.files else ""
        raise BrdfkitError(f"{name}: is not here; {known}{owner.by_hand()}.")
    remedy = f"run 'brdfkit data get {name}'" if listed.url else owner.by_hand(listed.file)
    if not listed.path.is_file():
        raise BrdfkitError(f"{name}: is not here; {remedy}.")
    if listed.sha256 and sha256(listed.path) != listed.sha256:
        raise BrdfkitError(
            f"{listed.path}: is not the {name} that was published (its checksum differs); "
            f"delete it and {remedy}."
        )
    return listed.path


def cache():
    """The user's cache folder; it has a folder for each collection."""
    import pooch

    return Path(pooch.os_cache("brdfkit"))


def _is_material(file):
    return formats.has_format(file) and not file.name.startswith(".")


def _named(collection, file):
    return f"{collection}/{file.partition('.')[0]}"


def _collection(name, entry):
    rows, url = entry.pop("files"), entry.pop("url", "")
    if isinstance(rows, str):
        with (index.folder() / rows).open(encoding="utf-8", newline="") as stream:
            rows = list(csv.DictReader(stream, delimiter="\t"))
    listed = [_listed(name, url=row.get("url", url), row=row) for row in rows]
    return Collection(name, **entry, files={found.name: found for found in listed})


def _listed(collection, url, row):
    file = row["file"]
    return Listed(
        name=_named(collection, file),
        file=file,
        bytes=int(row.get("bytes") or 0),
        sha256=row.get("sha256", ""),
        url=url.format(**row),
    )
