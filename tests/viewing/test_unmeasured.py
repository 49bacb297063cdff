"""What was not measured is hatched in the picture."""

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles
from brdfkit.images.hatching import hatch
from brdfkit.materials.measured.measured_angles import MeasuredAngles
from brdfkit.viewing.materials.application import MaterialApplication
from brdfkit.viewing.materials.live_light import LAMP

HIGHEST = 50  # polar angle of the samples [degrees]; others within 5° count as measured


@pytest.fixture(scope="module")
def measured():
    """A material that was measured up to `HIGHEST`, at all azimuths."""
    angles = np.arange(0, HIGHEST + 1, 5.0)
    theta_i, theta_o, phi = np.meshgrid(angles, angles, np.arange(0, 360, 5.0), indexing="ij")
    return bk.Measured.from_angles(theta_i, 0, theta_o, phi, np.ones(phi.shape))


def test_angles_beyond_the_samples_are_not_known(measured):
    angles = MeasuredAngles(measured)
    theta = np.radians(np.arange(1, 90, 2.0))
    view, light = from_angles(theta, 1.0 + 0 * theta), from_angles(np.radians(30), 4.0)
    inside = np.degrees(theta)
    sure = np.abs(inside - HIGHEST - 3) > 4
    known = angles.knows(np.broadcast_to(light, view.shape), view)
    assert np.array_equal(known[sure], inside[sure] < HIGHEST)
    assert np.array_equal(angles.find_view_kinds(view[:, 2])[sure] == 0, inside[sure] < HIGHEST)
    grazing = np.broadcast_to(from_angles(1.4, 0.0), view.shape)
    assert not angles.knows(grazing, view).any()


def test_the_rim_of_the_ball_is_hatched_and_what_the_lamp_grazes(module_in_llvm, measured):
    view = MaterialApplication(measured, ["lambert"], {"show.unmeasured": True})
    state, size = view.first, (64, 64)
    view.render(state, 1, size, False, 0)
    cosine = view.masks.find_directions(state, size)[0][..., 2]
    rim, ball = view.find_unmeasured(state, size), np.isfinite(cosine)
    assert np.array_equal(ball, view.find_mask(state, size))
    assert (cosine[rim] < np.cos(np.radians(HIGHEST))).all()
    assert (cosine[ball & ~rim] > np.cos(np.radians(HIGHEST + 8))).all()

    lit = view.change(state, {"light.environment": LAMP})
    grazed = view.find_unmeasured(lit, size)
    assert (grazed & ball & ~rim).any()
    assert view.find_unmeasured(view.change(lit, {"show.unmeasured": False}), size) is None

    view.close()  # while a pass goes on
    assert view.find_unmeasured(lit, size) is None


@pytest.mark.quick
def test_a_model_alone_has_nothing_to_hatch():
    view = MaterialApplication("ggx")
    assert view.find_unmeasured(view.first, (64, 64)) is None


@pytest.mark.quick
def test_stripes_are_where_the_mask_is_and_seen_on_every_colour():
    mask = np.zeros((40, 80), bool)
    mask[:, 40:] = True
    for grey in (0, 128, 255):
        picture = np.full((40, 80, 3), grey, np.uint8)
        hatched = hatch(picture, mask)
        assert np.array_equal(hatched[:, :40], picture[:, :40])
        assert np.ptp(hatched[:, 40:]) > 80
