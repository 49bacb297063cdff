"""What an object tells of itself, written once and shown as text and as HTML.

A class that derives from `Shown` says it in `document()`: a title and parts, which are in
`parts.py`. `text.py` makes text of them, for terminals, and `html.py` HTML, for notebooks.
"""

from brdfkit.core.documents.parts import Cell as Cell
from brdfkit.core.documents.parts import Document as Document
from brdfkit.core.documents.parts import Folded as Folded
from brdfkit.core.documents.parts import Paragraph as Paragraph
from brdfkit.core.documents.parts import Picture as Picture
from brdfkit.core.documents.parts import Table as Table
from brdfkit.core.documents.text import Shown as Shown
