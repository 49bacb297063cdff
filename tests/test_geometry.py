"""Maps of directions, against their inverses and against integrals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from brdfkit.geometry.dual_paraboloid import from_disc, solid_angle, to_disc

pytestmark = pytest.mark.quick


@given(st.floats(-1, 1), st.floats(0, 2 * np.pi))
def test_a_direction_comes_back_from_the_dual_paraboloid(z, phi):
    w = np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z
    back = from_disc(*to_disc(*w), 1 if z >= 0 else -1)
    np.testing.assert_allclose(back, w, atol=4e-16)


def test_a_disc_of_the_dual_paraboloid_holds_half_of_the_sphere():
    side = (np.arange(1000) + 0.5) / 500 - 1
    s, t = np.meshgrid(side, side)
    _, _, z = from_disc(s, t, 1)
    inside = s * s + t * t < 1
    assert solid_angle(z)[inside].sum() / 500**2 == pytest.approx(2 * np.pi, rel=1e-4)
