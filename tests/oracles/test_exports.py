"""Independent programs draw what `export` said they would: six fits × every target."""

import numpy as np
import pytest
from oracles import ORACLES
from six_fits import SIX_FITS, make_fit

import brdfkit as bk
from brdfkit.exporting.loss import compute_log_error
from brdfkit.exporting.targets import find_target
from brdfkit.materials.converting import draw_direction_pairs

pytestmark = pytest.mark.oracles

TOLERANCES = {
    "glsl": 1e-5,
    # three.js darkens the diffuse term by an F₉₀ between those of metal and plastic
    "gltf": 1e-2,
    "blender": 1e-3,
    "materialx": 1e-4,
    "mitsuba": 1e-4,
    "openmaterial": 1e-4,
    "osl": 1e-3,
    "pbrt": 1e-4,
    "python": 1e-7,
    "radiance": 1e-3,
    "usd": 1e-4,
}
PAIRS = draw_direction_pairs(50, seed=1)


@pytest.mark.parametrize("name", SIX_FITS)
@pytest.mark.parametrize("target", ORACLES)
def test_a_program_draws_what_was_told(target, name, tmp_path):
    fit, path = make_fit(name), tmp_path / f"größe 1{find_target(target).suffix}"
    done = bk.export(fit, target, path, accept_loss=True)
    measured = ORACLES[target](done.paths, *PAIRS)
    truth, drawn = fit.eval(*PAIRS), done.drawn.eval(*PAIRS)
    np.testing.assert_allclose(measured, drawn, rtol=TOLERANCES[target])
    told = compute_log_error(truth, drawn, *PAIRS)
    assert compute_log_error(truth, measured, *PAIRS) == pytest.approx(told, rel=0.2, abs=1e-4)
