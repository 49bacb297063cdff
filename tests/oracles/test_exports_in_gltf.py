"""Khronos' validator finds nothing in exported .glb files, and three.js draws what was told."""

import gltf_oracle
import numpy as np
import pytest
from six_fits import SIX_FITS, make_fit

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles

pytestmark = pytest.mark.oracles

# A metal, a plastic, a coat, and brushes both ways
MATERIALS = {
    "metal": {"base_color": [0.9, 0.6, 0.3], "metallic": 1.0, "roughness": 0.4},
    "plastic": {"base_color": [0.4, 0.1, 0.05], "roughness": 0.4, "ior": 1.7, "specular": 0.8},
    "along": {"base_color": [0.9, 0.6, 0.3], "metallic": 1.0, "roughness": 0.4, "anisotropy": 0.7},
    "coat": {"base_color": [0.4, 0.1, 0.05], "clearcoat": 0.9, "clearcoat_roughness": 0.3},
    "across": {
        "base_color": [0.5, 0.4, 0.3],
        "metallic": 0.6,
        "roughness": 0.4,
        "anisotropy": -0.7,
    },
}


@pytest.fixture
def pairs():
    """Angles of 60 pairs of directions, half of them near the mirror direction."""
    random = np.random.default_rng(1)
    theta = np.arccos(random.uniform(0.1, 1, (2, 60)))
    phi = random.uniform(0, 2 * np.pi, (2, 60))
    theta[1, 30:] = theta[0, 30:] + random.normal(0, 0.1, 30)
    phi[1, 30:] = phi[0, 30:] + np.pi + random.normal(0, 0.2, 30)
    return np.clip(np.abs(theta), 0, 1.47), phi


@pytest.mark.parametrize("name", SIX_FITS)
def test_the_validator_finds_nothing(name, tmp_path):
    done = bk.export(make_fit(name), "gltf", tmp_path / "größe 1.glb", accept_loss=True)
    assert gltf_oracle.validate(done.paths[0]) == ([0, 0, 0, 0], [])


@pytest.mark.parametrize("turn", [0.0, 0.7], ids=["straight", "turned"])
@pytest.mark.parametrize("name", MATERIALS)
def test_three_draws_what_was_told(name, turn, browser, pairs, tmp_path):
    model = bk.models()["gltf"](**MATERIALS[name])
    done = bk.export(model, "gltf", tmp_path / "a.glb")
    theta, phi = pairs
    wi, wo = from_angles(theta, phi)
    measured = gltf_oracle.measure(browser, done.paths[0], *from_angles(theta, phi + turn), turn)
    np.testing.assert_allclose(measured, done.drawn.eval(wi, wo), rtol=2e-3)
