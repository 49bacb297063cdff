"""Shows formulas as MathML, which browsers draw themselves: no script, no font from elsewhere."""

import html

from docutils.nodes import SkipNode
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.util import logging

logger = logging.getLogger(__name__)


def setup(app):
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    app.config.html_math_renderer = "mathml"


def inline(translator, node):
    translator.body.append(mathml(node, as_block=False))
    raise SkipNode


def block(translator, node):
    number = f'<span class="eqno">({node["number"]})</span>' if node.get("number") else ""
    translator.body.append(f'<div class="math">{mathml(node, as_block=True)}{number}</div>\n')
    raise SkipNode


def mathml(node, as_block):
    """The formula of a node; as it is written, with a warning, where docutils cannot read it."""
    text = node.astext().replace("°", r"^{\circ}")
    try:
        return tex2mathml(text, as_block)
    except MathError as error:
        logger.warning("%s", error, location=node)
        return f"<code>{html.escape(text)}</code>"
