"""Links that lead out of `docs/`, as they do on a forge, lead to pages of the files' sources.

Links are relative to where a page's file really lies, since some pages are symbolic links. One to
another page's file leads to the page, one to any other file or folder of the repository to a page
that shows it: `source/src/brdfkit/loading.py.html`.
"""

import html
import os
from functools import cache
from pathlib import Path

from docutils import nodes
from sphinx.addnodes import download_reference, pending_xref
from sphinx.transforms import SphinxTransform
from sphinx.util.osutil import relative_uri

ROOT = Path(__file__).resolve().parents[2]
SHOWN = (".md", ".py", ".pyi", ".toml", ".tsv")
PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width,initial-scale=1">
<link rel="stylesheet" href="{top}_static/source.css"></head>
<body><p><a href="{top}index.html">brdfkit</a></p><h1>{title}</h1>{body}</body></html>
"""


def setup(app):
    app.add_transform(RepositoryLinks)
    app.connect("env-before-read-docs", lambda *_: pages_by_file.cache_clear())
    app.connect("build-finished", write_sources)
    return {"env_version": 2}


class RepositoryLinks(SphinxTransform):
    """Replaces links to files; what is no file of the repository stays, and is warned of."""

    default_priority = 5

    def apply(self, **_):
        for link in [*self.document.findall(download_reference)]:
            self.replace(link)
        for link in [*self.document.findall(pending_xref)]:
            if link.get("reftype") == "myst" and link["reftarget"] not in self.env.found_docs:
                self.replace(link)

    def replace(self, link):
        here = Path(self.env.doc2path(self.env.docname)).resolve()
        file, _, anchor = link["reftarget"].partition("#")
        if link.get("refdomain") == "doc":  # MyST has cut off what it took for a page's suffix
            file, anchor = f"{file}.md", link["reftargetid"]
        path = Path(os.path.normpath(here.parent / file))
        pages = pages_by_file(self.env)
        if file and path in pages:
            new = pending_xref("", reftarget=pages[path], reftargetid=anchor or None)
            new.attributes |= {"refdomain": "doc", "reftype": "myst", "refdoc": self.env.docname}
            new["refexplicit"] = link["refexplicit"]
        elif file and path.exists() and path.is_relative_to(ROOT):
            uri = source_uri(self.env, self.env.docname, path)
            new = nodes.reference("", "", internal=True, refuri=uri)
        else:
            return
        new += link.children
        link.replace_self(new)


@cache
def pages_by_file(env):
    """The name of every page, by the file that it really is."""
    return {Path(env.doc2path(name)).resolve(): name for name in env.found_docs}


def source_uri(env, docname, path):
    """The address, seen from a page, of the source of a file or folder, which will be written."""
    if not hasattr(env, "linked_sources"):
        env.linked_sources = set()
    env.linked_sources.add(path)
    return relative_uri(f"{docname}.html", source_name(path))


def source_name(path):
    name = path.relative_to(ROOT).as_posix()
    return f"source/{name}/index.html" if path.is_dir() else f"source/{name}.html"


def write_sources(app, error):
    """Write the page of every file and folder that was linked to, and of the files in a folder."""
    paths = set(getattr(app.env, "linked_sources", ())) if app.env and not error else set()
    paths |= {file for folder in paths if folder.is_dir() for file in files_in(folder)}
    for path in paths:
        page = app.outdir / source_name(path)
        page.parent.mkdir(parents=True, exist_ok=True)
        words = {"title": html.escape(path.relative_to(ROOT).as_posix())}
        words["top"] = "../" * source_name(path).count("/")
        words["body"] = folder_body(path) if path.is_dir() else file_body(path)
        page.write_text(PAGE.format(**words), encoding="utf-8")


def files_in(folder):
    return sorted(file for file in folder.rglob("*") if file.suffix in SHOWN)


def folder_body(folder):
    names = (file.relative_to(folder).as_posix() for file in files_in(folder))
    return "<ul>{}</ul>".format("".join(f'<li><a href="{n}.html">{n}</a></li>' for n in names))


def file_body(path):
    """A file's text, whose lines can be linked to as `#line-12`."""
    lines = html.escape(path.read_text(encoding="utf-8")).splitlines()
    rows = (f'<span id="line-{n}">{line}</span>' for n, line in enumerate(lines, 1))
    return "<pre>{}</pre>".format("\n".join(rows))
