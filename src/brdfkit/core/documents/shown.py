"""`Shown`: the base class of what prints as text and appears in notebooks as HTML."""

from brdfkit.core.documents.html import to_html
from brdfkit.core.documents.parts import Document
from brdfkit.core.documents.text import to_text


class Shown:
    """What tells of itself in `document()`; terminals show it as text, notebooks as HTML."""

    def document(self) -> Document:
        """What the object tells of itself."""
        raise NotImplementedError

    def __str__(self) -> str:
        return to_text(self.document())

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        """What notebooks show; without scripts, and without addresses from elsewhere."""
        return to_html(self.document())
