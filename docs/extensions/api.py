"""The reference of Python: a page of every name in `src/brdfkit/__init__.pyi`, by autodoc.

The pages are written to `docs/api/`, which git ignores. Names of them in signatures lead to them.
"""

import inspect
import sys
from pathlib import Path

from docutils import nodes
from numpy.typing import ArrayLike
from sphinx.util.nodes import make_refnode
from sphinx.util.typing import stringify_annotation

import brdfkit
from extensions._pages import refresh
from extensions.repository_links import source_uri

FOLDER = Path(__file__).parents[1] / "api"
PUBLIC = {name: getattr(brdfkit, name) for name in brdfkit.__all__ if not name.startswith("_")}
KINDS = {
    "What you call": inspect.isfunction,
    "What goes in and comes out": lambda thing: isinstance(thing, type) and not is_error(thing),
    "Subnamespaces": inspect.ismodule,
    "Errors": lambda thing: isinstance(thing, type) and is_error(thing),
}


def setup(app):
    app.connect("builder-inited", lambda _: refresh(FOLDER, pages()))
    app.connect("missing-reference", resolve)
    app.connect("autodoc-process-signature", shorten)


def is_error(thing):
    return issubclass(thing, BaseException)


def pages():
    """File name → text of all pages."""
    return {"index.rst": index()} | {f"{name}.rst": page(name) for name in PUBLIC}


def index():
    title = "Python"
    parts = [f"{title}\n{'=' * len(title)}", "``import brdfkit as bk``; every name is ``bk.NAME``."]
    for kind, belongs in KINDS.items():
        rows = [f"   * - :doc:`{n}`\n     - {sentence(t)}" for n, t in PUBLIC.items() if belongs(t)]
        head = ".. list-table::\n   :widths: 25 75\n\n"
        parts.append(f"{kind}\n{'-' * len(kind)}\n\n{head}" + "\n".join(rows))
    parts.append(".. toctree::\n   :hidden:\n   :glob:\n\n   *")
    return "\n\n".join(parts) + "\n"


def sentence(thing):
    """The first line of what a thing's docstring says."""
    return inspect.getdoc(thing).partition("\n")[0]


def page(name):
    """The page of a name; of a subnamespace with an entry for each of its names."""
    entries = [entry(name, PUBLIC[name])]
    if inspect.ismodule(PUBLIC[name]):
        entries = [f".. automodule:: {PUBLIC[name].__name__}\n   :no-index:\n"]
        entries += [entry(f"{name}.{one}", thing) for one, thing in names_of(PUBLIC[name]).items()]
    return "\n".join([f"{name}\n{'=' * len(name)}\n", *entries])


def entry(name, thing):
    """The directive that documents `brdfkit.NAME`."""
    if inspect.isfunction(thing):
        return f".. autofunction:: brdfkit.{name}\n"
    if isinstance(thing, type):
        return f".. autoclass:: brdfkit.{name}\n   :members:\n   :inherited-members: Exception\n"
    return f".. autodata:: brdfkit.{name}\n   :no-value:\n"


def names_of(space):
    """Name → thing of a subnamespace, without modules and the names that brdfkit has itself."""
    names = [name for name in dir(space) if not name.startswith("_")]
    things = {name: getattr(space, name) for name in names}
    own = {name: thing for name, thing in things.items() if thing is not PUBLIC.get(name)}
    return {name: thing for name, thing in own.items() if not inspect.ismodule(thing)}


def shorten(app, what, name, thing, options, signature, returned):
    """A signature with NumPy's name of what an array can be made of, not with its definition."""
    shown = stringify_annotation(ArrayLike, "smart")
    short = "~numpy.typing.ArrayLike"
    return signature and signature.replace(shown, short), returned


def resolve(app, env, node, content):
    """The page of a public name, wherever it is defined; no page of what other libraries define."""
    if node.get("refdomain") != "py":
        return None
    target = node["reftarget"]
    module, _, name = target.rpartition(".")
    if name in PUBLIC:
        words = f"api/{name}", f"brdfkit.{name}", content
        return make_refnode(app.builder, node["refdoc"], *words)
    for space in filter(lambda one: inspect.ismodule(PUBLIC[one]), PUBLIC):
        if name in names_of(PUBLIC[space]) and is_ours(module):
            words = f"api/{space}", f"brdfkit.{space}.{name}", content
            return make_refnode(app.builder, node["refdoc"], *words)
    return source(env, node["refdoc"], module, content) if is_ours(module) else content


def is_ours(module):
    return module.partition(".")[0] == "brdfkit"


def source(env, docname, module, content):
    """A link to the source of a type that is not public; None where there is none."""
    if module not in sys.modules:
        return None
    uri = source_uri(env, docname, Path(sys.modules[module].__file__))
    return nodes.reference("", "", content, internal=True, refuri=uri)
