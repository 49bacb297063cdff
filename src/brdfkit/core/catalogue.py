"""Finds the materials and environment maps that come with brdfkit: files, origins and licences.

Each folder, `data/measured` and `data/environments`, has an `index.toml` that describes its files
by name. An installed package contains both folders; a checkout has them at its top.
"""

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.core.files import compute_sha256

MEASURED, ENVIRONMENTS, PRIORS = "measured", "environments", "priors"


def read_index(kind: str = MEASURED) -> dict[str, Any]:
    """Return the content of `data/KIND/index.toml`: the description of each file by its name.

    Under the key "collections" are public collections, which do not come with brdfkit. All callers
    share the content, because to read it takes longer than most files of samples.
    """
    return _read_index_file(find_data_folder(kind) / "index.toml")


@cache
def _read_index_file(file: Path) -> dict[str, Any]:
    """Return the content of an index, which does not change while a program runs."""
    with file.open("rb") as stream:
        return tomllib.load(stream)


def find_data_folder(kind: str = MEASURED) -> Path:
    """Return the folder `data/KIND` of the installed package, or at the top of a checkout."""
    package = Path(__file__).resolve().parents[1]
    installed, checkout = (place / "data" / kind for place in (package, package.parents[1]))
    return installed if installed.is_dir() else checkout


@dataclass(frozen=True)
class MapCollection:
    """A public collection of environment maps, which users download themselves.

    `licence` (a word) and `terms` (a sentence) are the owners' conditions, `citation` is the work
    to cite, and `page` the web page with the files. `convention` is the word for `brdfkit convert
    --source`, or says why it is unknown.
    """

    title: str
    citation: str
    licence: str
    terms: str
    page: str
    convention: str

    def __str__(self) -> str:
        return (
            f"{self.title}\nTerms: {self.terms}\nCite: {self.citation}\nPage: {self.page}\n"
            f"Convention: {self.convention}"
        )


def list_map_collections() -> dict[str, MapCollection]:
    """Return the public collections of environment maps by name.

    >>> list_map_collections()["debevec"].convention
    'debevec'
    """
    entries = read_index(ENVIRONMENTS)["collections"]
    return {name: MapCollection(**entry) for name, entry in entries.items()}


@dataclass(frozen=True)
class Shipped:
    """A material or an environment map that comes with brdfkit.

    `name` is what `brdfkit.load` or the argument ``environment`` takes; `title` and `what` describe
    it for people; `source` names the data and the command that made it; `file` is the file's name
    in its folder, and `sha256` its checksum.
    """

    name: str
    title: str
    what: str
    source: str
    licence: str
    file: str
    sha256: str

    def __str__(self) -> str:
        return f"{self.name}: {self.title}; {self.what}\n  {self.source} ({self.licence})"


def list_materials() -> dict[str, Shipped]:
    """Return the materials that come with brdfkit, by name.

    >>> print(list_materials()["dusty_gold"].title)
    Dusty gold
    """
    return _list_shipped(MEASURED)


def list_environments() -> dict[str, Shipped]:
    """Return the environment maps that come with brdfkit, by name.

    >>> print(list_environments()["studio"].file)
    studio.exr
    """
    return _list_shipped(ENVIRONMENTS)


def find_material_file(name: str) -> Path:
    """Return the file of a material that comes with brdfkit, after a check of its checksum.

    Raises `BrdfkitError` for an unknown name, and for a file that is missing or was changed.

    >>> find_material_file("dusty_gold").name
    'dusty_gold.binary.xz'
    """
    return _find_verified_file("material", name, list_materials(), find_data_folder(MEASURED))


def find_environment_file(name: str) -> Path:
    """Return the file of an environment map that comes with brdfkit, after a check of its checksum.

    Raises `BrdfkitError` for an unknown name, and for a file that is missing or was changed.

    >>> find_environment_file("studio").name
    'studio.exr'
    """
    folder = find_data_folder(ENVIRONMENTS)
    return _find_verified_file("environment map", name, list_environments(), folder)


def _list_shipped(kind: str) -> dict[str, Shipped]:
    """Return the materials ("measured") or "environments" that come with brdfkit, by name."""
    entries = read_index(kind).items()
    return {name: Shipped(name, **entry) for name, entry in entries if name != "collections"}


def _find_verified_file(what: str, name: str, known: dict[str, Shipped], folder: Path) -> Path:
    """Return the path of one of the `known` files in a folder, after a check of its checksum.

    `what` is the kind of thing in an error, such as "material".
    """
    if name not in known:
        raise no_such_error(what, name, known)
    file = folder / known[name].file
    if not file.is_file():
        raise BrdfkitError(f"{file}: the file of {name!r} is missing; install brdfkit again.")
    if compute_sha256(file) != known[name].sha256:
        raise BrdfkitError(
            f"{file}: is not the {name!r} that brdfkit came with (its checksum differs); "
            "install brdfkit again."
        )
    return file
