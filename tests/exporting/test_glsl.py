"""The exported GLSL, run by WebGL in a browser, has the values of the fit."""

import numpy as np
import pytest
import webgl
from six_fits import make_fit

import brdfkit as bk
from brdfkit.materials.converting import draw_direction_pairs


@pytest.mark.parametrize("name", ["metal", "brushed", "coat"])
def test_a_shader_has_the_values_that_were_told(name, browser, tmp_path):
    done = bk.export(make_fit(name), "glsl", tmp_path / "a.glsl", accept_loss=True)
    wi, wo = draw_direction_pairs(50, seed=1)
    measured = webgl.evaluate(browser, done.paths[0].read_text(encoding="utf-8"), wi, wo)
    np.testing.assert_allclose(measured, done.drawn.eval(wi, wo), rtol=1e-5)
