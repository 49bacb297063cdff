"""The documentation: the models' pages are what their files say, and no link leads nowhere."""

import doctest
import re
from importlib import import_module
from pathlib import Path
from urllib.parse import unquote

import pytest
from click.testing import CliRunner
from PIL import Image, ImageDraw, ImageFont

import brdfkit as bk
from brdfkit.cli import main
from brdfkit.core import catalogue
from brdfkit.core.references import find_citations, read_references
from brdfkit.materials.formats import list_formats

ROOT = Path(__file__).resolve().parents[2]
PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *sorted(ROOT.glob("docs/*.md")),
    *sorted(ROOT.glob("docs/*/*.md")),
]
OWN = "references.py"  # shows how one cites
LINK = re.compile(r'\]\(([^)\s]+)\)|(?:src|href)="([^"]+)"')

pytestmark = pytest.mark.quick


@pytest.fixture(scope="module")
def make():
    """The program that makes the models' pages."""
    module = import_module("make_models")
    new = [
        name for name in module.find_shipped_models() if not (module.FOLDER / f"{name}.md").exists()
    ]
    others = import_module("make_plugins")
    new += [page for page in others.make_pages() if not (others.FOLDER / page).exists()]
    if new:  # a plugin is one file: its page is made of it when it is to be published
        pytest.skip(f"no page yet of {', '.join(new)}: make docs")
    return module


@pytest.fixture
def copied(make, monkeypatch, tmp_path):
    """A copy of the pages that may be changed."""
    for file in make.FOLDER.iterdir():
        (tmp_path / file.name).write_bytes(file.read_bytes())
    monkeypatch.setattr(make, "FOLDER", tmp_path)
    return tmp_path


def test_the_pages_are_what_the_models_say(make):
    """Otherwise: make docs"""
    assert make.find_problems() == []


def test_the_pages_are_what_the_plugins_say(make):
    """Otherwise: make docs"""
    assert import_module("make_plugins").find_problems() == []


def test_the_pages_of_materials_are_what_the_index_says():
    """Otherwise: python docs/tools/make_materials.py"""
    make = import_module("make_materials")
    assert (make.FOLDER / "README.md").read_text(encoding="utf-8") == make.make_index()
    for name, material in catalogue.list_materials().items():
        text = (make.FOLDER / f"{name}.md").read_text(encoding="utf-8")
        assert text.startswith(make.make_page_head(material)), name


def test_the_gallery_of_distance_fields_shows_its_scenes_and_their_code():
    """Otherwise: python docs/tools/make_distance_fields.py"""
    make = import_module("make_distance_fields")
    page = make.PAGE.read_text(encoding="utf-8")
    for function in make.SCENES + make.lessons.LESSONS:
        assert "\n\n".join(make.make_section(function)) in page, function.__name__
        assert make.find_picture_file(function.__name__).stat().st_size < 300e3, function.__name__


def test_the_pages_of_formats_are_what_their_docstrings_say():
    """Otherwise: make docs"""
    make = import_module("make_formats")
    for module in list_formats():
        text = (make.FOLDER / make.make_page_name(module)).read_text(encoding="utf-8")
        assert all(part in text for part in make.split_docstring(module)), module.NAME


def test_every_cited_work_is_known_and_every_known_work_is_cited():
    """Otherwise: an entry of references.toml is missing, or too many; make docs"""
    files = [*ROOT.glob("src/**/*.py"), *ROOT.glob("plugins/**/*.py"), *PAGES]
    listed = ROOT / "docs" / "references.md"
    texts = [f.read_text(encoding="utf-8") for f in files if f != listed and f.name != OWN]
    assert {key for text in texts for key in find_citations(text)} == set(read_references())
    assert listed.read_text(encoding="utf-8") == import_module("make_references").make_page()


CITING = {
    "ward": ["Ward 1992", "Kurt 2007"],
    "kdtree_envmap": ["Ergun 2015", "Mallett & Yuksel 2019"],
}


@pytest.mark.parametrize("name", CITING)
def test_a_page_ends_with_the_works_that_it_cites(name):
    page = CliRunner().invoke(main, ["plugins", name]).output
    assert page.rstrip().endswith("\n".join(str(read_references()[key]) for key in CITING[name]))


def test_every_model_has_a_page_and_two_pictures(make):
    for plugin in make.find_shipped_models():
        for name in (f"{plugin}.md", f"{plugin}.png", f"{plugin}_lobes.png"):
            assert (make.FOLDER / name).stat().st_size > 0, name


def test_a_changed_a_missing_and_a_superfluous_file_are_found(make, copied):
    with (copied / "ward.md").open("a", encoding="utf-8") as page:
        page.write("More.\n")
    (copied / "ggx_lobes.png").unlink()
    (copied / "velvet.md").write_text("# Velvet\n", encoding="utf-8")
    assert make.find_problems() == [
        "ggx_lobes.png is missing",
        "velvet.md belongs to no model",
        "ward.md is not up to date",
    ]


def test_the_pictures_are_small(make):
    sizes = [file.stat().st_size for file in make.FOLDER.glob("*.png")]
    assert sum(sizes) / len(sizes) < 42e3  # 1.5 MB for the first 36


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_to_files(page):
    links = [a or b for a, b in LINK.findall(page.read_text(encoding="utf-8"))]
    files = [unquote(link.partition("#")[0]) for link in links if ":" not in link]
    missing = [file for file in files if not (page.resolve().parent / file).exists()]
    assert not missing


@pytest.mark.parametrize("page", ["CONTRIBUTING.md", "docs/architecture.md"])
def test_the_paths_that_a_page_names_exist(page):
    named = re.findall(
        r"`((?:src|plugins|theses|tests|docs|data|benchmarks)/[\w/.]*)`",
        (ROOT / page).read_text(encoding="utf-8"),
    )
    assert len(named) > 10 or page != "CONTRIBUTING.md"
    assert not [p for p in named if "NAME" not in p and "KIND" not in p and not (ROOT / p).exists()]


EXAMPLES = {"evaluate": bk.evaluate, "named": bk.losses.named, "models": bk.models}


@pytest.mark.parametrize("name", EXAMPLES)
def test_the_examples_are_true(name):
    """Those of the public names that need no file."""
    thing = EXAMPLES[name]
    documented = thing if callable(thing) else type(thing)
    examples, *_ = doctest.DocTestFinder(recurse=False).find(documented, name, globs=EXAMPLES)
    found = doctest.DocTestRunner().run(examples)
    assert (found.attempted, found.failed) == (1, 0)


def test_every_loss_is_described():
    assert all(f'"{loss}"' in type(bk.losses.named).__doc__ for loss in bk.losses.named)


@pytest.fixture(scope="module")
def measured():
    """The names in the table of `docs/measured.md`."""
    text = (ROOT / "docs" / "measured.md").read_text(encoding="utf-8")
    return re.findall(r"^\| (?!material |---)(.+?) \|", text, flags=re.MULTILINE)


def test_the_readme_counts_the_measured_materials(measured):
    neural = sum(name.startswith("neural ") for name in measured)
    counted = f"{len(measured) - neural} measurements and {neural} neural reconstructions"
    assert counted in (ROOT / "README.md").read_text(encoding="utf-8")


def test_every_measured_material_has_its_whole_name_above_its_ball(measured):
    make = import_module("make_measured")
    font = ImageFont.load_default(make.FONT)
    draw = ImageDraw.Draw(Image.new("RGB", (1, 1)))
    for name in measured:
        label = make.wrap_name(name)
        assert re.sub(r"\s", "", label) == re.sub(r"\s", "", name)
        _, _, right, bottom = draw.multiline_textbbox((3, 3), label, font)
        assert right <= make.SIZE, name
        assert bottom <= make.CAPTION, name
