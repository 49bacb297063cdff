"""What comes with brdfkit, materials and environment maps: their origin, licence and files."""

import tomllib
from dataclasses import dataclass
from pathlib import Path

from brdfkit.core.errors import BrdfkitError, no_such
from brdfkit.core.files import sha256

MEASURED, ENVIRONMENTS = "measured", "environments"


def read_index(kind=MEASURED):
    """The content of an index, a dictionary by name; "collections" holds those of others."""
    with (find_folder(kind) / "index.toml").open("rb") as stream:
        return tomllib.load(stream)


def find_folder(kind=MEASURED):
    """The folder of an index: in the installed package, or at the top of a checkout."""
    package = Path(__file__).resolve().parents[1]
    installed, checkout = (place / "data" / kind for place in (package, package.parents[1]))
    return installed if installed.is_dir() else checkout


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


def list_map_collections():
    """The public collections of environment maps by name.

    >>> list_map_collections()["debevec"].convention
    'debevec'
    """
    entries = read_index(ENVIRONMENTS)["collections"]
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


def list_materials():
    """The materials that come with brdfkit, by name.

    >>> print(list_materials()["dusty_gold"].title)
    Dusty gold
    """
    return _list_shipped(MEASURED)


def list_environments():
    """The environment maps that come with brdfkit, by name.

    >>> print(list_environments()["studio"].file)
    studio.exr
    """
    return _list_shipped(ENVIRONMENTS)


def find_material_file(name):
    """The path of a shipped material's file, after its checksum was verified.

    Raises `BrdfkitError` for an unknown name, and for a file that is missing or was changed.

    >>> find_material_file("dusty_gold").name
    'dusty_gold.binary.xz'
    """
    return _verified_path("material", name, list_materials(), find_folder(MEASURED))


def find_environment_file(name):
    """The same of a shipped environment map.

    >>> find_environment_file("studio").name
    'studio.exr'
    """
    folder = find_folder(ENVIRONMENTS)
    return _verified_path("environment map", name, list_environments(), folder)


def _list_shipped(kind):
    entries = read_index(kind).items()
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
