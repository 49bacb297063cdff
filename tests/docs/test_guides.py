"""The tutorial and the how-tos: their Python runs as it stands, in an empty folder."""

import re
from pathlib import Path

import numpy as np
import pytest
from made_objects import Made

import brdfkit as bk
from brdfkit.core.jit.threads import use_two_threads
from brdfkit.materials.measured.tabulation import tabulate

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGES = [DOCS / "five_minutes.md", *sorted(DOCS.glob("how_to/*.md"))]
BLOCKS = re.compile(r"```python\n(.*?)```", re.DOTALL)
PROGRAMS = {page: "".join(BLOCKS.findall(page.read_text(encoding="utf-8"))) for page in PAGES}
SMALLER = {  # what shows as well that a line runs, and at once
    r"spp=\d+, size=\d+": "spp=1, size=16",
    r"size=\(\d+, \d+\)": "size=(16, 16)",
    r"resolution=\d+": "resolution=64",
    r"spp=\d+\)": "spp=1)",
    r"samples=128": "samples=8",
    r"spp=128,\n\)": "spp=16, steps=2)",
    r'"width": 48, "height": 48': '"width": 16, "height": 16',
    r'"(?:car_paint|satin_plastic)"': '"small.npz"',
    r'"brushed_aluminium"': '"brushed.npz"',
    r'"captures/cat"': '"ball"',
}


@pytest.fixture
def here(tmp_path, monkeypatch, llvm_variant, no_user_plugins):
    """A folder with two small materials and photographs that stand for those of the pages."""
    monkeypatch.chdir(tmp_path)
    ggx, rng = bk.models()["ggx"], np.random.default_rng(0)
    for name, model, shape in (
        ("small", ggx(alpha_u=0.3), (12, 6, 12)),
        ("brushed", ggx(alpha_u=0.1, alpha_v=0.4), (6, 8, 4, 8)),
    ):
        truth = tabulate(model.eval, 1, shape).values * np.ones(3)
        values = truth * (1 + 0.02 * rng.normal(size=truth.shape))
        bk.save(bk.Measured.from_table(values, standard_error=0.02 * truth), f"{name}.npz")
    Made().diligent(tmp_path / "ball")


@pytest.mark.parametrize(
    "page", [page for page in PAGES if PROGRAMS[page]], ids=lambda page: page.stem
)
def test_its_python_runs(page, here):
    program = PROGRAMS[page]
    for large, small in SMALLER.items():
        program = re.sub(large, small, program)
    # not the main module: what is below `if __name__ == "__main__"` starts processes
    with use_two_threads():  # pages load scenes by Mitsuba itself, which waits in one thread
        exec(compile(program, page.name, "exec"), {"__name__": page.stem})
