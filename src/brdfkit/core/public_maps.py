"""Public collections of environment maps: who published them, where, and in which convention.

brdfkit neither ships nor downloads them: their pages let one choose by eye, size and format.
"""

from dataclasses import dataclass

from brdfkit.core import index


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
