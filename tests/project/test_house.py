"""The house stands on its ground: no file imports another in a circle, lazily or not."""

from pathlib import Path

import grimp
import pytest

ROOT = Path(__file__).resolve().parents[2]

pytestmark = pytest.mark.quick


def circles(imports):
    """The sets of files that import each other, of file → what it imports; R. Tarjan, 1972."""
    number, low, open_, found = {}, {}, [], []

    def visit(file):
        number[file] = low[file] = len(number)
        open_.append(file)
        for other in imports.get(file, ()):
            if other not in number:
                visit(other)
            if other in open_:
                low[file] = min(low[file], low[other])
        if low[file] == number[file]:
            at = open_.index(file)
            circle, open_[at:] = open_[at:], []
            if len(circle) > 1:
                found.append(sorted(circle))

    for file in imports:
        if file not in number:
            visit(file)
    return found


@pytest.fixture(scope="module")
def imports():
    """Every file of the library with what it imports, at its top or within a function."""
    graph = grimp.build_graph("brdfkit", cache_dir=None)
    return {file: graph.find_modules_directly_imported_by(file) for file in graph.modules}


def test_there_is_no_circle(imports):
    files = len(list(ROOT.glob("src/brdfkit/**/*.py")))
    assert len(imports) == files
    assert circles(imports) == []


def test_a_lazy_import_counts(imports):
    within = imports["brdfkit.materials.auditing"]
    assert "brdfkit.materials.auditing.picture" in within  # within a function
    lower = imports["brdfkit.model.samples.table"] | {"brdfkit.cli.commands.fit"}
    (circle,) = circles(imports | {"brdfkit.model.samples.table": lower})
    expected = "model.samples.table", "cli.commands.fit", "materials.measured"
    assert {f"brdfkit.{name}" for name in expected} <= set(circle)
