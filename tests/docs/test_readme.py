"""What the README and the goniometer's page say to type works as it stands there, in its order."""

import re
import shlex
from pathlib import Path

import nibabel
import numpy as np
import pytest
import small_files
from click.testing import CliRunner
from user_model import USER_MODEL

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.cli import main
from brdfkit.core import catalogue
from brdfkit.core.discovery import plugin_files
from brdfkit.materials.measured import Measured

ROOT = Path(__file__).resolve().parents[2]
SMALL_PICTURE = ("--spp", "1", "--size", "16")
SMALL = {  # command: what makes it answer at once
    "--render": SMALL_PICTURE,
    "render": SMALL_PICTURE,
    "report": SMALL_PICTURE,
    "gallery": ("--size", "32"),
    "measure": ("--spp", "128", "--shape", "3,2,4"),
}


def text(page):
    return (ROOT / page).read_text(encoding="utf-8")


def block(page, before):
    """The lines of the first indented block behind `before`."""
    behind = text(page)[text(page).index(before) :]
    found = re.search(r"\n\n((?: {4}\S.*\n)+)", behind)
    return [line.strip() for line in found[1].splitlines()]


@pytest.fixture
def here(tmp_path, monkeypatch, llvm_variant):
    """A current folder with small files of the names that the pages use."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(plugin_files, "_users", {})
    wi, wo = draw_direction_pairs(300, seed=0, max_degrees=75)
    copper = bk.models()["ggx"](alpha_u=0.3, specular_reflectance=(0.9, 0.6, 0.4))
    bk.save(Measured.from_samples(wi, wo, copper.eval(wi, wo)), "copper.astm")
    Path("cayman.brdf").write_bytes(small_files.cornell())
    Path("gold-metallic-paint.binary").write_bytes(small_files.merl())
    bk.environments.convert(np.ones((4, 8, 3)), "sky.exr")
    brain = np.random.default_rng(0).integers(0, 255, (6, 6, 6), np.uint8)
    nibabel.save(nibabel.Nifti1Image(brain, np.eye(4)), "brain.nii.gz")
    Path("my_model.py").write_text(USER_MODEL, encoding="utf-8")
    return tmp_path


def run(line):
    """A command as a page has it, with small pictures."""
    program, command, *words = shlex.split(line, comments=True)
    small = [word for known in SMALL if known in [command, *words] for word in SMALL[known]]
    if "brushed" in words or "woven" in words:  # anisotropic tables have a fourth axis
        small[-1] = "2,3,2,4"
    result = CliRunner().invoke(main, [command, *words, *small])
    assert (program, result.exit_code) == ("brdfkit", 0), f"{line}\n{result.output}"


def wishes():
    """(command, Python) of each row of the README's map."""
    rows = re.findall(r"^\| (?!I want|---).*? \| `(.*?)` \| `(.*)` \|$", text("README.md"), re.M)
    assert len(rows) == 10
    return rows


def code_blocks():
    return re.findall(r"```python\n(.*?)```", text("README.md"), flags=re.DOTALL)


def shortened(code):
    """Python of the README with a material of few samples and small pictures."""
    small = "spp=1, size=16"
    code = code.replace("car_paint", "copper.astm").replace("plaster", "copper.astm")
    code = code.replace("spp=256", small).replace('scene="vase"', f'scene="vase", {small}')
    return code.replace('"paint.html"', f'"paint.html", {small}').replace(
        'volume("smoke")', f'volume("smoke", {small})'
    )


def test_the_readme_is_short():
    assert len(text("README.md").splitlines()) <= 150


def test_the_wishes_run_on_the_command_line(here):
    """The materials that the README names come along; a small file stands for them here."""
    named = {word for command, _ in wishes() for word in command.split()}
    assert {"car_paint", "plaster", "red_plastic"} == named & set(catalogue.list_materials())
    for command, _ in wishes():
        run(re.sub(r"\b(car_paint|plaster|red_plastic)\b(?!\.)", "copper.astm", command))
    written = {"car_paint.png", "fits/render.png", "paint.binary", "smoke.png"}
    written |= {"ggx+ggx.png", "copper.py"}
    assert written <= {str(file.relative_to(here)) for file in here.rglob("*")}


def test_the_wishes_run_in_python(here):
    names = {}
    exec(shortened(code_blocks()[0]), names)
    for _, code in wishes():
        exec(shortened(code), names)
    written = {"paint.bsdf", "paint.exr", "paint.html", "paint.py", "smoke.png"}
    assert written <= {file.name for file in here.iterdir()}


def test_the_other_python_runs(here):
    for code in code_blocks()[1:]:
        exec(code, {})


def test_the_page_of_the_goniometer(here):
    for line in block("docs/goniometer.md", "# The virtual goniometer"):
        run(line)
    assert {"rough_gold.npz", "brushed.npz", "woven.npz"} <= {f.name for f in here.iterdir()}
