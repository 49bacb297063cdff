"""Cited works, as [Ward 1992], lead to their entry in the references; addresses are links.

A forge shows the same text, and makes links of addresses by itself.
"""

import re

from docutils import nodes
from sphinx.transforms import SphinxTransform
from sphinx.util.osutil import relative_uri

from brdfkit.core.references import CITATION, read_references

PAGE = "references"
FOUND = re.compile(rf"{CITATION.pattern}|(?P<address>https?://[^\s)]*[\w/])")
PLAIN = (nodes.reference, nodes.literal_block, nodes.literal, nodes.title, nodes.math)


def setup(app):
    app.add_transform(Citations)


class Citations(SphinxTransform):
    """Makes links of citations and addresses in the text."""

    default_priority = 410

    def apply(self, **_):
        here = self.env.docname == PAGE
        for text in list(self.document.findall(nodes.Text)):
            if not has_parent(text, PLAIN):
                text.parent.replace(text, list(self.parts(str(text), here)))
        for item in self.document.findall(nodes.list_item) if here else ():
            if found := CITATION.match(item.astext()):
                item["ids"].append(nodes.make_id(found[1]))

    def parts(self, text, here):
        """The text as nodes; in the references themselves only addresses are links."""
        end = 0
        for found in FOUND.finditer(text):
            key = " ".join((found[1] or "").split())
            uri = found["address"]
            if key in read_references() and not here:
                page = relative_uri(f"{self.env.docname}.html", f"{PAGE}.html")
                uri = f"{page}#{nodes.make_id(key)}"
            if uri:
                yield nodes.Text(text[end : found.start()])
                yield nodes.reference("", found[0], internal=not found["address"], refuri=uri)
                end = found.end()
        yield nodes.Text(text[end:])


def has_parent(node, kinds):
    while node := node.parent:
        if isinstance(node, kinds):
            return True
    return False
