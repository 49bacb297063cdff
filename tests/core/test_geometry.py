"""Maps of directions, against their inverses and against integrals."""

import drjit as dr
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from brdfkit.core.geometry.dual_paraboloid import from_disc, solid_angle_per_area, to_disc
from brdfkit.core.geometry.latitude_rows import projected_solid_angles, solid_angles


@given(st.floats(-1, 1), st.floats(0, 2 * np.pi))
def test_a_direction_comes_back_from_the_dual_paraboloid(z, phi):
    w = np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z
    back = from_disc(*to_disc(*w), 1 if z >= 0 else -1)
    np.testing.assert_allclose(back, w, atol=4e-16)


@pytest.mark.quick
def test_a_disc_of_the_dual_paraboloid_holds_half_of_the_sphere():
    side = (np.arange(1000) + 0.5) / 500 - 1
    s, t = np.meshgrid(side, side)
    _, _, z = from_disc(s, t, 1)
    inside = s * s + t * t < 1
    assert solid_angle_per_area(z)[inside].sum() / 500**2 == pytest.approx(2 * np.pi, rel=1e-4)


@pytest.mark.quick
@pytest.mark.parametrize("height", [1, 2, 5, 8, 129])
def test_an_even_map_shines_from_everywhere_and_gives_the_irradiance_pi(height):
    for at_poles in (False, True):
        assert 3 * solid_angles(height, 3, at_poles).sum() == pytest.approx(4 * np.pi)
    assert 3 * projected_solid_angles(height, 3).sum() == pytest.approx(np.pi)


@pytest.mark.quick
@pytest.mark.parametrize("height", [4, 7])
def test_rows_weigh_what_mitsuba_s_envmap_makes_of_them(llvm_variant, height):
    """Maps with one lit row, as Mitsuba evaluates them, summed up over 4,096 polar angles."""
    mi = llvm_variant
    theta = (np.arange(4096) + 0.5) / 4096 * np.pi
    si = dr.zeros(mi.SurfaceInteraction3f, len(theta))
    si.wi = -mi.Vector3f(np.sin(theta), np.cos(theta), 0 * theta)
    ring = 2 * np.pi * np.sin(theta) * np.pi / len(theta)
    for row in range(height):
        pixels = np.zeros((height, 2 * height, 3), np.float32)
        pixels[row] = 1
        light = np.array(mi.load_dict({"type": "envmap", "bitmap": mi.Bitmap(pixels)}).eval(si))[0]
        found = light @ ring, light @ (ring * np.maximum(np.cos(theta), 0))
        ours = solid_angles(height, 1, True)[row], projected_solid_angles(height, 1)[row]
        assert ours == pytest.approx(found, abs=1e-6)
