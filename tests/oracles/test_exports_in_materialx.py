"""MaterialX reads what `export` wrote, and its shaders have the values of six fits."""

import functools
from dataclasses import replace

import materialx_oracle as oracle
import materialx_webgl as webgl
import numpy as np
import pytest
from materialx_webgl import draw_pairs
from six_fits import SIX_FITS, make_fit

import brdfkit as bk
from brdfkit.exporting.ggx_sum import BLACK, GgxLobe, GgxSum, to_ggx_sum
from brdfkit.exporting.loss import compute_log_error
from brdfkit.model import labels

pytestmark = pytest.mark.oracles
WHITE = 1.0, 1.0, 1.0


@pytest.fixture(scope="module")
def write(tmp_path_factory):
    """A function that exports a fit by name, or a sum: what is drawn, as a sum, and the text."""
    folder = tmp_path_factory.mktemp("a")

    @functools.cache
    def export(what):
        fit = what.to_model() if isinstance(what, GgxSum) else make_fit(what)
        done = bk.export(fit, "materialx", folder / "größe 1.mtlx", accept_loss=True)
        return to_ggx_sum(done.drawn), done.paths[0].read_text(encoding="utf-8")

    return export


@pytest.fixture(scope="module")
def page(browser):
    """A page that keeps its programs."""
    opened = browser.new_page()
    yield opened
    opened.close()


def measure_white(page, write, content):
    """What is drawn of each highlight alone, if it reflects all light."""
    for lobe in content.lobes:
        _, text = write(GgxSum(BLACK, (replace(lobe, f0=WHITE, f90=WHITE),)))
        yield webgl.measure(page, oracle.read(text), *draw_pairs())


@pytest.mark.parametrize("name", SIX_FITS)
def test_webgl_draws_by_the_formula_of_glsl(name, write, page):
    content, text = write(name)
    document = oracle.read(text)
    formula = webgl.predict(content, measure_white(page, write, content), *draw_pairs())
    for turn in (0.0, 0.7) if content.is_anisotropic else (0.0,):
        measured = webgl.measure(page, document, *draw_pairs(turn), turn)
        np.testing.assert_allclose(measured, formula, rtol=1e-4)


@pytest.mark.parametrize("name", SIX_FITS)
def test_shaders_have_the_values_that_were_told(name, write):
    content, text = write(name)
    document = oracle.read(text)
    assert oracle.generate(document, "glsl").getSourceCode("pixel")
    told = oracle.read_osl_arguments(document)
    for number, lobe in enumerate(content.lobes, 1):
        values = {
            "color0": f"color({write_digits(lobe.f0)})",
            "color90": f"color({write_digits(lobe.f90)})",
            "roughness": f"{{{write_digits((lobe.alpha_u, lobe.alpha_v))}}}",
            "weight": "1.000000",
            "exponent": "5.000000",
        }
        for key, value in values.items():
            assert told[f"gr_e_1_highlight_{number}_{key}"] == value
    if any(content.diffuse):
        assert told["gr_e_1_diffuse_color"] == f"color({write_digits(content.diffuse)})"
        assert told["gr_e_1_diffuse_roughness"] == "0.000000"


def write_digits(values):
    """Numbers as OSL's generator writes them."""
    return ", ".join(f"{np.float32(value):.6f}" for value in values)


def test_a_document_that_is_written_again_is_the_same(write):
    document = oracle.read(write("coat")[1])
    again = oracle.read(oracle.mx.writeToXmlString(document))
    assert oracle.list_network(again) == oracle.list_network(document)


def test_glsl_brightens_a_metal_as_files_say(write, page):
    content, text = write("metal")
    measured = webgl.measure(page, oracle.read(text), *draw_pairs())
    ratio = measured / content.to_model().eval(*draw_pairs())
    assert np.median(ratio) == pytest.approx(1.06, abs=0.01)


PLASTIC = {"base_color": [0.5, 0.1, 0.05], "specular_roughness": 0.4}
OPENPBR = {
    "plastic": PLASTIC,
    "coat": {**PLASTIC, "coat_weight": 1.0, "coat_roughness": 0.2},
    "cloth": {**PLASTIC, "fuzz_weight": 1.0, "fuzz_color": [0.9, 0.5, 0.6]},
}


@pytest.mark.parametrize("case", OPENPBR)
def test_webgl_draws_openpbr_as_was_told(case, page, tmp_path):
    model, (wi, wo) = labels.model("openpbr:form=full")(**OPENPBR[case]), draw_pairs()
    done = bk.export(model, "materialx", tmp_path / "a.mtlx")
    document = oracle.read(done.paths[0].read_text(encoding="utf-8"))
    measured = webgl.measure(page, document, wi, wo)
    truth, told = model.eval(wi, wo), done.drawn.eval(wi, wo)
    assert np.median(np.abs(measured / told - 1)) < 0.02
    errors = [compute_log_error(truth, values, wi, wo) for values in (measured, told)]
    assert errors[0] == pytest.approx(errors[1], rel=0.2)


@pytest.mark.parametrize("anisotropy", [0.6, -0.6])
def test_webgl_draws_a_brush_of_openpbr_along_the_tangent(anisotropy, write, page, tmp_path):
    values = {"base_metalness": 1.0, "specular_roughness": 0.5, "base_color": [0.9, 0.6, 0.3]}
    model = bk.models()["openpbr"](**values, specular_roughness_anisotropy=anisotropy)
    done = bk.export(model, "materialx", tmp_path / "a.mtlx")
    assert not done.changes
    wide = 0.25 * np.sqrt(2 / (1 + 0.4**2))
    widths = (wide, 0.4 * wide) if anisotropy > 0 else (0.4 * wide, wide)
    content = GgxSum(BLACK, (GgxLobe(*widths, (0.9, 0.6, 0.3), WHITE),))
    np.testing.assert_allclose(
        model.eval(*draw_pairs()), content.to_model().eval(*draw_pairs()), rtol=1e-5
    )
    formula = webgl.predict(content, measure_white(page, write, content), *draw_pairs())
    document = oracle.read(done.paths[0].read_text(encoding="utf-8"))
    measured = webgl.measure(page, document, *draw_pairs(0.7), 0.7)
    np.testing.assert_allclose(measured, formula, rtol=1e-4)


DAMAGES = {
    "unknown input": ('name="color0"', 'name="colour0"'),
    "type": ('name="exponent" type="float"', 'name="exponent" type="integer"'),
    "connection": ('nodename="gr_e_1_highlight_2"', 'nodename="none"'),
    "category": ("generalized_schlick_bsdf", "schlick_bsdf"),
}


@pytest.mark.parametrize("damage", DAMAGES)
def test_damage_is_noticed(damage, write):
    text = write("coat")[1]
    assert DAMAGES[damage][0] in text
    with pytest.raises(AssertionError):
        oracle.read(text.replace(*DAMAGES[damage]))


def test_swapped_widths_are_noticed(write, page):
    text = write("brushed")[1]
    swapped = text.replace('"0.36, 0.14"', '"0.14, 0.36"')
    assert swapped != text
    measured = [
        webgl.measure(page, oracle.read(one), *draw_pairs())[:, 0] for one in (text, swapped)
    ]
    assert np.median(np.abs(np.log(measured[1] / measured[0]))) > 0.1
