"""docs/captures.md has the figures of its JSON, and these are the code's."""

import json
import os
from pathlib import Path

import make_captures
import pytest

FIGURES = json.loads(make_captures.FIGURES.read_text())
ROOT = Path(os.environ.get("BRDFKIT_CAPTURES", "unset"))


def test_the_page_has_the_figures():
    page = make_captures.PAGE.read_text()
    assert list(FIGURES) == list(make_captures.CAPTURES)
    for lines in (make_captures.write_table(FIGURES), make_captures.write_normals(FIGURES)):
        assert "\n".join(lines) in page


@pytest.mark.skipif(not ROOT.is_dir(), reason="BRDFKIT_CAPTURES names no folder")
@pytest.mark.parametrize("name", ["diligent-ball", "cat"])
def test_the_figures_are_the_codes_and_within_the_bars(name):
    measured = make_captures.measure(make_captures.fit_capture(ROOT, name))
    for part, values in FIGURES[name].items():
        if isinstance(values, dict):
            assert measured[part] == pytest.approx(values, rel=1e-3)
    bars = {"diligent-ball": (0.03, 0.10), "cat": (0.05, 0.15)}[name]
    errors = measured["held_out_errors"]
    assert (errors["median"] <= bars[0], errors["high"] <= bars[1]) == (True, True)
    assert name == "cat" or measured["normal_error"] <= 2.5
