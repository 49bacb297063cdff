"""The directive `gallery`: a ball of every material that brdfkit brings, over the ball of its fit.

The fit's ball shows under the pointer or the keyboard's focus, by CSS alone.
"""

from docutils import nodes
from sphinx.util.docutils import SphinxDirective
from sphinx.util.osutil import relative_uri

from brdfkit.core import catalogue


class Gallery(SphinxDirective):
    """Links to the pages of the materials, each with two pictures."""

    def run(self):
        figures = [self.figure(name, m.title) for name, m in catalogue.list_materials().items()]
        return [nodes.container("", *figures, classes=["gallery"])]

    def figure(self, name, title):
        uri = relative_uri(f"{self.env.docname}.html", f"materials/{name}.html")
        link = nodes.reference("", "", internal=True, refuri=uri)
        for word, file in ("measured", f"{name}.jpg"), ("fitted", f"{name}_fit.jpg"):
            link += nodes.image(uri=f"/materials/{file}", alt=f"{title}, {word}")
        link += nodes.inline("", title, classes=["caption"])
        return nodes.container("", nodes.paragraph("", "", link), classes=["ball"])


def setup(app):
    app.add_directive("gallery", Gallery)
