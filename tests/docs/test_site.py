"""The documentation site: it builds without a warning, has a page of everything, and is whole."""

import os
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlparse

import pytest

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core import catalogue
from brdfkit.core.discovery import plugin_files
from brdfkit.materials.formats import list_formats

DOCS = Path(__file__).resolve().parents[2] / "docs"
# The list of all pages beside each page takes a third of the time, and is the same on all; the
# module is of no use, see tests/conftest.py
BUILD = """import sys, furo, sphinx.cmd.build
sys.modules["rfc3987_syntax"] = None
whole = furo._compute_navigation_tree
furo._compute_navigation_tree = lambda page: whole(page) if page["pagename"] == "index" else ""
sys.exit(sphinx.cmd.build.main(sys.argv[1:]))
"""
LOADED = {"audio", "embed", "iframe", "img", "link", "object", "script", "source", "video"}


class Page(HTMLParser):
    """What a page of HTML has: its links, what it loads, its anchors, pictures without a text."""

    def __init__(self, path):
        super().__init__()
        self.links, self.loaded, self.anchors, self.bare = set(), set(), {""}, []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attrs):
        found = dict(attrs)
        address = found.get("href") or found.get("src")
        if address:
            (self.loaded if tag in LOADED else self.links).add(address)
        self.anchors |= {found[name] for name in ("id", "name") if found.get(name)}
        if tag == "img" and not (found.get("alt") or "").strip():
            self.bare.append(address)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The folder of the site, built with warnings as errors, without running notebooks, and with
    the list of all pages beside the first alone."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-c", BUILD, "-q", "-W", "-n", "-d", folder / "trees"]
    built = subprocess.run(
        [*command, DOCS, folder / "html"],
        env=os.environ | {"BRDFKIT_NOTEBOOKS": "off"},
        capture_output=True,
        text=True,
    )
    assert built.returncode == 0, built.stderr
    return folder / "html"


@pytest.fixture(scope="module")
def pages(site):
    """Path → `Page` of every page."""
    return {path: Page(path) for path in site.rglob("*.html")}


def own_plugins():
    """The plugins of every kind that come with brdfkit and are no models."""
    return {page for page in os.listdir(DOCS / "plugins") if page != "README.md"}


def test_there_is_a_page_of_everything(site):
    wanted = {
        "models": {n for n, m in bk.models().items() if m.__module__.startswith(plugin_files.OWN)},
        "materials": set(catalogue.list_materials()),
        "formats": {module.__name__.rpartition(".")[2] for module in list_formats()},
        "plugins": {page.removesuffix(".md") for page in own_plugins()},
        "commands": set(main.commands),
        "api": {name for name in bk.__all__ if not name.startswith("_")},
    }
    for folder, names in wanted.items():
        found = {path.stem for path in (site / folder).glob("*.html")} - {"README", "index"}
        assert found == names, folder


def test_every_link_leads_to_a_page_and_an_anchor_of_the_site(site, pages):
    broken = []
    for path, page in pages.items():
        for link in page.links:
            address = urlparse(link)
            if address.scheme:
                continue
            target = (path.parent / unquote(address.path)).resolve() if address.path else path
            anchors = pages[target].anchors if target in pages else {""}
            if not target.exists() or unquote(address.fragment) not in anchors:
                broken.append(f"{path.relative_to(site)}: {link}")
    assert broken == []


def test_nothing_is_loaded_from_elsewhere(site, pages):
    for path, page in pages.items():
        for address in page.loaded:
            here = urlparse(address)
            if here.scheme == "data":  # within the page
                continue
            assert not here.scheme + here.netloc, (path, address)
            assert (path.parent / unquote(here.path)).exists(), (path, address)
    for style in site.glob("_static/**/*.css"):
        text = style.read_text(encoding="utf-8")
        assert "@import" not in text, style
        assert "url(http" not in text.replace('"', "").replace("'", ""), style


def test_every_picture_has_a_text_for_those_who_do_not_see_it(pages):
    assert {path: page.bare for path, page in pages.items() if page.bare} == {}
