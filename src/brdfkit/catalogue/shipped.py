"""The materials that come with brdfkit: their origin, licence and files."""

from dataclasses import dataclass

from brdfkit.catalogue import index
from brdfkit.errors import BrdfkitError, no_such
from brdfkit.files import sha256


@dataclass(frozen=True)
class Material:
    """A material that comes with brdfkit.

    `name`: for `brdfkit.load`; `title` and `what`: for people; `source`: the data and the command
    that made it; `file`: its name in the index's folder; `sha256`: the file's checksum.
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
    entries = index.entries().items()
    return {name: Material(name, **entry) for name, entry in entries if name != "collections"}


def path(name):
    """The path of a shipped material's file, after its checksum was verified.

    Raises `BrdfkitError` for an unknown name, and for a file that is missing or was changed.

    >>> path("dusty_gold").name
    'dusty_gold.binary.xz'
    """
    if name not in materials():
        raise no_such("material", name, materials())
    material = materials()[name]
    file = index.folder() / material.file
    if not file.is_file():
        raise BrdfkitError(f"{file}: the file of {name!r} is missing; install brdfkit again.")
    if sha256(file) != material.sha256:
        raise BrdfkitError(
            f"{file}: is not the {name!r} that brdfkit came with (its checksum differs); "
            "install brdfkit again."
        )
    return file
