"""The directive `gallery`: a ball of every model, or of every material that brdfkit brings.

Of a material the fit's ball lies upon the measured one and shows under the pointer, by CSS alone.
"""

from docutils import nodes
from make_models import models, picture
from sphinx.util.docutils import SphinxDirective
from sphinx.util.osutil import relative_uri

from brdfkit.core import catalogue


class Gallery(SphinxDirective):
    """Links to the pages of a folder, each with one picture or two."""

    required_arguments = 1

    def run(self):
        balls = {"models": model_balls, "materials": material_balls}[self.arguments[0]]()
        figures = [self.figure(self.arguments[0], *ball) for ball in balls]
        return [nodes.container("", *figures, classes=["gallery"])]

    def figure(self, folder, name, title, pictures):
        uri = relative_uri(f"{self.env.docname}.html", f"{folder}/{name}.html")
        link = nodes.reference("", "", internal=True, refuri=uri)
        for alt, file in pictures.items():
            link += nodes.image(uri=f"/{folder}/{file}", alt=alt)
        link += nodes.inline("", title, classes=["caption"])
        return nodes.container("", nodes.paragraph("", "", link), classes=["ball"])


def model_balls():
    """(name of the page, title, picture by alternative text) of every model."""
    for name, model in models().items():
        yield name, name, {f"A ball of {name}": picture(model())}


def material_balls():
    """The same of every material: the measured ball and a fit's."""
    for name, material in catalogue.materials().items():
        pictures = {f"{material.title}, measured": f"{name}.jpg"}
        yield name, material.title, pictures | {f"{material.title}, fitted": f"{name}_fit.jpg"}


def setup(app):
    app.add_directive("gallery", Gallery)
