"""Shows the summary of a result as text in terminals and as HTML in notebooks.

A class that derives from `Shown` returns its summary from `document()`: a title and the parts of
`parts.py`. `text.py` converts the summary to text, and `html.py` to HTML.
"""

from brdfkit.core.documents.parts import Cell as Cell
from brdfkit.core.documents.parts import Document as Document
from brdfkit.core.documents.parts import Folded as Folded
from brdfkit.core.documents.parts import Paragraph as Paragraph
from brdfkit.core.documents.parts import Picture as Picture
from brdfkit.core.documents.parts import Table as Table
from brdfkit.core.documents.text import Shown as Shown
