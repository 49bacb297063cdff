"""What `pip install brdfkit` brings: the wheel has plugins and data, and works without the
checkout."""

import os
import subprocess
import sys
import zipfile
from importlib.util import find_spec
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = "from brdfkit.cli import main; main()"


def run(*words, cwd, **environment):
    done = subprocess.run(
        [sys.executable, *map(str, words)],
        capture_output=True,
        text=True,
        cwd=cwd,
        env=os.environ | environment,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel, built with the backend of this environment: nothing is downloaded."""
    for needed in ("build", "hatchling"):
        if find_spec(needed) is None:
            pytest.skip(f"{needed} is not installed")
    folder = tmp_path_factory.mktemp("wheel")
    run("-m", "build", "--wheel", "--no-isolation", "--outdir", folder, ROOT, cwd=folder)
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel, tmp_path_factory):
    """A folder in which the wheel is installed, without what it depends on."""
    target = tmp_path_factory.mktemp("installed")
    options = "--quiet", "--no-deps", "--no-index", "--disable-pip-version-check"
    run("-m", "pip", "install", *options, "--target", target, wheel, cwd=target)
    return target


def test_contents(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    plugins = {f"brdfkit/{f.relative_to(ROOT)}" for f in ROOT.glob("plugins/*/*.py")}
    tables = {f"brdfkit/data/measured/{f.name}" for f in ROOT.glob("data/measured/*.xz")}
    maps = {f"brdfkit/data/environments/{f.name}" for f in ROOT.glob("data/environments/*.exr")}
    assert plugins
    assert tables
    assert maps
    indices = {f"brdfkit/data/{kind}/index.toml" for kind in ("measured", "environments")}
    expected = plugins | tables | maps | indices | {"brdfkit/__init__.pyi"}
    assert expected <= names
    assert {f"brdfkit/{f.relative_to(ROOT / 'src/brdfkit')}" for f in sources()} <= names
    pages = "report.html", "page.css", "copy.js"
    assert {f"brdfkit/core/pages/templates/{name}" for name in pages} <= names
    assert any(name.endswith("licenses/LICENSE") for name in names)
    tops = {name.partition("/")[0] for name in names}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"brdfkit"}
    assert not [name for name in names if "test" in name or "__pycache__" in name]


def sources():
    return ROOT.glob("src/brdfkit/**/*.py")


def test_works_without_the_checkout(installed, tmp_path):
    def python(*words):
        # -P: the current folder is no place to import from
        return run("-P", *words, cwd=tmp_path, PYTHONPATH=str(installed))

    where = """
import brdfkit
from brdfkit.core import catalogue
from brdfkit.core.discovery import plugin_files as discovery
folders = map(catalogue.find_data_folder, (catalogue.MEASURED, catalogue.ENVIRONMENTS))
for path in (brdfkit.__file__, *folders, *discovery.find_plugins('bsdfs').values()):
    print(path)
"""
    places = python("-c", where).split()
    assert len(places) > 2
    assert all(Path(place).is_relative_to(installed) for place in places), places
    assert "blinn_phong" in python("-c", PROGRAM, "models")
    assert "MERL" in python("-c", PROGRAM, "info", "car_paint")
    python("-c", PROGRAM, "render", "ward", "--size", "8", "--spp", "1", "--envmap", "studio")
    assert [p.name for p in tmp_path.iterdir()] == ["ward.png"]
