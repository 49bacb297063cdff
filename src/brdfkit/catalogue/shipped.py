"""The known materials: where they come from, under which licence, and their files.

`data/measured/index.toml` lists those that come with brdfkit, and public collections
(`public_collections.py`). The wheel copies that folder into the package; in a checkout it lies at
the top.
"""

import hashlib
import tomllib
from dataclasses import dataclass
from pathlib import Path

from brdfkit.errors import BrdfkitError


@dataclass(frozen=True)
class Material:
    """A material that comes with brdfkit.

    `name`: what `brdfkit.load` takes; `title`, `what`: for people; `source`: what it was made
    from, and by which command; `file`: in the index's folder; `sha256`: of that file.
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
    entries = index().items()
    return {name: Material(name, **entry) for name, entry in entries if name != "collections"}


def path(name):
    """The file of a material that comes with brdfkit, once its checksum is right.

    Raises `BrdfkitError` for an unknown name, and for a file that is missing or was changed.

    >>> path("dusty_gold").name
    'dusty_gold.binary.xz'
    """
    if name not in materials():
        raise BrdfkitError(f"There is no material {name!r}; there are {', '.join(materials())}.")
    material = materials()[name]
    file = folder() / material.file
    if not file.is_file():
        raise BrdfkitError(f"{file}: the file of {name!r} is missing; install brdfkit again.")
    if sha256(file) != material.sha256:
        raise BrdfkitError(
            f"{file}: is not the {name!r} that brdfkit came with (its checksum differs); "
            "install brdfkit again."
        )
    return file


def folder():
    """The folder of the index: within the installed package, else that of the checkout."""
    package = Path(__file__).resolve().parents[1]
    installed, checkout = package / "data" / "measured", package.parents[1] / "data" / "measured"
    return installed if installed.is_dir() else checkout


def index():
    """The index as it is written, TOML's tables as dictionaries."""
    with (folder() / "index.toml").open("rb") as stream:
        return tomllib.load(stream)


def sha256(file):
    """The SHA-256 of a file, in hexadecimal."""
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
