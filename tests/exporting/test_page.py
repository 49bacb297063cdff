"""docs/exports.md has the figures of its JSON, and these are the code's."""

import json

import make_exports
import pytest

from brdfkit.exporting import loss
from brdfkit.exporting.hold import hold
from brdfkit.exporting.targets import find_target, list_targets
from brdfkit.model import labels

FIGURES = json.loads(make_exports.FIGURES.read_text())


def test_the_page_has_the_figures():
    page = make_exports.PAGE.read_text()
    assert list(FIGURES["targets"]) == list(list_targets())
    for lines in (make_exports.write_holdings(), make_exports.write_losses(FIGURES)):
        assert "\n".join(lines) in page


@pytest.mark.parametrize("target", ["blender", "osl"])
@pytest.mark.parametrize("name", ["metal", "paint", "anisotropic"])
def test_the_figures_are_the_codes(name, target, monkeypatch):
    monkeypatch.setattr(loss, "SIDE", 64)
    made = FIGURES["fits"][name]
    told = FIGURES["targets"][target][name]
    measured = hold(labels.model(made["model"])(**made["values"]), find_target(target))[1]
    assert measured.log_error == pytest.approx(told["log_error"], rel=1e-6, abs=1e-12)
    assert measured.delta_e == pytest.approx(told["delta_e"], rel=1e-6, abs=1e-12)
