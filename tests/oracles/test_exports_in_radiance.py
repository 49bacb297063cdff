"""Radiance draws a turned brush as `export` said it would, and the hues of bright surfaces."""

import numpy as np
import pytest
import radiance
from six_fits import make_fit

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.converting import draw_direction_pairs
from brdfkit.model import labels

pytestmark = [pytest.mark.oracles, pytest.mark.usefixtures("radiances_programs")]


@pytest.fixture(scope="module")
def radiances_programs():
    """Radiance's programs, or the tests are skipped."""
    return radiance.find_programs()


@pytest.mark.parametrize("name", ["metal", "brushed"])
def test_a_brush_is_turned_by_the_up_vector(name, tmp_path):
    fit = make_fit(name)
    done = bk.export(fit, "radiance", tmp_path / "größe 1.xml")
    random, turn = np.random.default_rng(1), 0.7
    theta, phi = random.uniform(0, 1.4, (2, 200)), random.uniform(0, 2 * np.pi, (2, 200))
    pairs, up = from_angles(theta, phi), (-np.sin(turn), np.cos(turn), 0)
    measured = radiance.measure(done.paths[0], *from_angles(theta, phi + turn), up)
    np.testing.assert_allclose(measured, done.drawn.eval(*pairs), rtol=1e-3)
    assert np.median(np.abs(measured / fit.eval(*pairs) - 1)) < 0.06  # cells have a size


@pytest.mark.parametrize("colour", [0.9, [0.9, 0.5, 0.4]], ids=["grey", "coloured"])
def test_a_bright_surface_keeps_its_hue(colour, tmp_path):
    fit = labels.model("lambert")(diffuse_reflectance=colour)
    done = bk.export(fit, "radiance", tmp_path / "a.xml")
    pairs = draw_direction_pairs(50, seed=1)
    measured = radiance.measure(done.paths[0], *pairs)
    np.testing.assert_allclose(measured, np.broadcast_to(fit.eval(*pairs), (50, 3)), rtol=2e-3)
