"""What comes with brdfkit, materials and environment maps: their origin, licence and files."""

from dataclasses import dataclass

from brdfkit.core import index
from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.core.files import sha256


@dataclass(frozen=True)
class MapCollection:
    """An entry of the index of environments.

    `licence` (a word) and `terms` (a sentence) are those of the owners; `page`: where the files
    are; `convention`: what `brdfkit convert --from` should be given, or why that is not known.
    """

    title: str
    citation: str
    licence: str
    terms: str
    page: str
    convention: str

    def __str__(self):
        return (
            f"{self.title}\nTerms: {self.terms}\nCite: {self.citation}\nPage: {self.page}\n"
            f"Convention: {self.convention}"
        )


def collections():
    """The public collections of environment maps by name.

    >>> collections()["debevec"].convention
    'debevec'
    """
    entries = index.entries(index.ENVIRONMENTS)["collections"]
    return {name: MapCollection(**entry) for name, entry in entries.items()}


@dataclass(frozen=True)
class Shipped:
    """A material or an environment map that comes with brdfkit.

    `name`: for `brdfkit.load`, or for ``envmap``; `title` and `what`: for people; `source`: the
    data and the command that made it; `file`: its name in the index's folder; `sha256`: the file's
    checksum.
    """

    name: str
    title: str
    what: str
    source: str
    licence: str
    file: str
    sha256: str

    def __str__(self):
        return f"{self.name}: {self.title}; {self.what}\n  {self.source} ({self.licence})"


def materials():
    """The materials that come with brdfkit, by name.

    >>> print(materials()["dusty_gold"].title)
    Dusty gold
    """
    return _shipped(index.MEASURED)


def environments():
    """The environment maps that come with brdfkit, by name.

    >>> print(environments()["studio"].file)
    studio.exr
    """
    return _shipped(index.ENVIRONMENTS)


def path(name):
    """The path of a shipped material's file, after its checksum was verified.

    Raises `BrdfkitError` for an unknown name, and for a file that is missing or was changed.

    >>> path("dusty_gold").name
    'dusty_gold.binary.xz'
    """
    return _verified_path("material", name, materials(), index.folder(index.MEASURED))


def environment_path(name):
    """The same of a shipped environment map.

    >>> environment_path("studio").name
    'studio.exr'
    """
    folder = index.folder(index.ENVIRONMENTS)
    return _verified_path("environment map", name, environments(), folder)


def _shipped(kind):
    entries = index.entries(kind).items()
    return {name: Shipped(name, **entry) for name, entry in entries if name != "collections"}


def _verified_path(what, name, known, folder):
    if name not in known:
        raise no_such(what, name, known)
    file = folder / known[name].file
    if not file.is_file():
        raise BrdfkitError(f"{file}: the file of {name!r} is missing; install brdfkit again.")
    if sha256(file) != known[name].sha256:
        raise BrdfkitError(
            f"{file}: is not the {name!r} that brdfkit came with (its checksum differs); "
            "install brdfkit again."
        )
    return file
