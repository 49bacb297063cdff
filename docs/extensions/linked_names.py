"""Names in the text lead to their pages: `bk.fit`, `Measured`, `brdfkit render`.

So texts stay as plain as a forge shows them, and no link needs to be kept.
"""

import re

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.transforms import SphinxTransform
from sphinx.util.osutil import relative_uri

from extensions import api, commands

COMMAND = re.compile(r"brdfkit (\w+)")
PYTHON = re.compile(r"(?:bk|brdfkit)\.(\w+)")


def setup(app):
    app.add_transform(LinkedNames)


class LinkedNames(SphinxTransform):
    """Makes a link of every literal that begins with a public name or a command."""

    default_priority = 400

    def apply(self, **_):
        for literal in list(self.document.findall(nodes.literal)):
            page = page_of(literal.astext())
            if page and page != self.env.docname and not isinstance(literal.parent, LINKS):
                uri = relative_uri(f"{self.env.docname}.html", f"{page}.html")
                link = nodes.reference("", "", internal=True, refuri=uri)
                literal.replace_self(link)
                link += literal


LINKS = (nodes.reference, nodes.title, pending_xref)


def page_of(text):
    """The page that a literal text is about, or None."""
    if (found := COMMAND.match(text)) and found[1] in commands.main.commands:
        return f"commands/{found[1]}"
    if (found := PYTHON.match(text)) and found[1] in api.PUBLIC:
        return f"api/{found[1]}"
    return f"api/{text}" if isinstance(api.PUBLIC.get(text), type) else None
