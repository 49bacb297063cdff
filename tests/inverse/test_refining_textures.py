"""`refine` of textures and environment maps: thousands of numbers, by derivatives backwards."""

import pickle

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.inverse.scenes.problem.parameters import choose_unknowns
from brdfkit.inverse.scenes.problem.scene import load_scene, make_integrator
from brdfkit.inverse.scenes.problem.targets import read_targets
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.search import descent
from brdfkit.inverse.scenes.search.backward_derivatives import compute_error_and_gradient
from brdfkit.inverse.scenes.search.descent import (
    _choose_held_out_pixels,
    compute_smoothness_penalty,
)

SIZE = 16
TEXTURE = "floor.bsdf.diffuse_reflectance.data"
TRUTH = 0.3 + 0.4 * np.linspace(0, 1, 6)[None, :, None] * np.array([1, 0.5, 0.2])[None, None]
TRUTH = np.repeat(TRUTH, 4, axis=0)
LIGHT = 0.5 + np.random.default_rng(2).random((4, 8, 3))


def scene(mi, texture, light=LIGHT, kind=np.float32):
    """A floor with a texture, seen from above."""
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 3},
        "sensor": {
            "type": "perspective",
            "fov": 40,
            "to_world": mi.ScalarTransform4f().look_at([0, -0.3, 3], [0, 0, 0], [0, 1, 0]),
            "film": {
                "type": "hdrfilm",
                "width": SIZE,
                "height": SIZE,
                "pixel_format": "rgb",
                "rfilter": {"type": "box"},
            },
        },
        "floor": {
            "type": "rectangle",
            "bsdf": {
                "type": "oren_nayar",
                "diffuse_reflectance": {
                    "type": "bitmap",
                    "bitmap": mi.Bitmap(np.asarray(texture).astype(kind)),
                    "raw": True,
                },
            },
        },
        "sky": {"type": "envmap", "bitmap": mi.Bitmap(np.float32(light))},
    }


@pytest.fixture(scope="module")
def picture(mi):
    clean = np.array(mi.render(mi.load_dict(scene(mi, TRUTH)), spp=512, seed=5))
    return clean * (1 + 0.01 * np.random.default_rng(1).standard_normal(clean.shape))


@pytest.mark.parametrize(("name", "number"), [(TEXTURE, 30), ("sky.data", 21), ("sky.data", 0)])
def test_derivatives_are_those_of_finite_differences(mi, picture, name, number):
    """Of single texels, with the same samples; one of the sky's is in its first column."""
    loaded = load_scene(scene(mi, 0.8 * TRUTH, 1.2 * LIGHT), (SIZE, SIZE))
    names = mi.traverse(loaded)
    targets, chosen = read_targets(picture), choose_unknowns(names, [name])
    views = Views(loaded, make_integrator(loaded), targets, names, chosen)
    x, spp, step = views.start, 128, 0.02
    by_number = compute_error_and_gradient(views, x, spp, 3, views.weights)[1][number]
    there, here = (x + sign * step * np.eye(len(x))[number] for sign in (1, -1))
    a, b = (compute_error_and_gradient(views, at, spp, 3, views.weights)[0] for at in (there, here))
    assert by_number == pytest.approx((a - b) / (2 * step), rel=0.03)


def test_roughness_has_its_derivatives(mi):
    names = mi.traverse(mi.load_dict(scene(mi, TRUTH), optimize=False))
    unknowns = choose_unknowns(names, [TEXTURE, "sky.data"])
    parts = [unknown.to_coordinates(unknown.start) for unknown in unknowns]
    slopes, step = compute_smoothness_penalty(unknowns, parts)[1], 1e-5
    for which, number in ((0, 7), (1, 0)):
        ends = []
        for sign in (1, -1):
            moved = [part.copy() for part in parts]
            moved[which][number] += sign * step
            ends.append(compute_smoothness_penalty(unknowns, moved)[0])
        row = number + which * len(parts[0])
        assert slopes[row] == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-4)


def test_a_texture_comes_back(mi, picture):
    grey, done = np.full(TRUTH.shape, 0.5), []
    found = bk.refine(
        scene(mi, grey),
        picture,
        parameters=[TEXTURE],
        steps=8,
        spp=32,
        smoothness=0.003,
        progress=lambda *at: done.append(at),
    )
    texture = found.values[TEXTURE]
    assert texture.shape == TRUTH.shape
    assert np.sqrt(np.mean((texture - TRUTH) ** 2)) < 0.04
    assert done
    assert found.fits == {}
    assert np.isnan(found.standard_errors[TEXTURE]).all()
    assert "4 × 6 × 3" in repr(found)
    assert pickle.loads(pickle.dumps(found)) == found
    other = mi.load_dict(scene(mi, grey), optimize=False)
    found.put_into(other)
    np.testing.assert_allclose(np.array(mi.traverse(other)[TEXTURE]), texture, rtol=1e-6)


def test_of_ten_pixels_alike_one_is_held_out(mi, picture):
    """All pixels of a highlight were on one side: then the strongest smoothing was chosen."""
    mask = np.arange(SIZE)[:, None] < np.full(SIZE, 12)
    loaded = load_scene(scene(mi, TRUTH), (SIZE, SIZE))
    names = mi.traverse(loaded)
    targets, chosen = read_targets(picture, mask=mask), choose_unknowns(names, [TEXTURE])
    views = Views(loaded, make_integrator(loaded), targets, names, chosen)
    held = _choose_held_out_pixels(views, 3)
    bright = (views.weights * views.target_pixels**2).sum(axis=1)
    order = np.argsort(-np.where(views.counted, bright, -1), kind="stable")
    in_tens = held[order[: mask.sum() // 10 * 10]].reshape(-1, 10)
    assert (in_tens.sum(axis=1) == 1).all()
    assert not held[~views.counted].any()
    assert (held != _choose_held_out_pixels(views, 4)).any()


def test_masked_texels_follow_their_neighbours(mi, picture, monkeypatch):
    """Whatever the masked pixels hold, smoothing by held-out pixels included."""
    monkeypatch.setattr(descent, "TRIAL_STEPS", 1)
    mask = np.arange(SIZE)[:, None] < np.full(SIZE, 12)
    grey = np.full(TRUTH.shape, 0.5)
    one, other = (
        bk.refine(scene(mi, grey), p, parameters=[TEXTURE], steps=1, spp=4, mask=mask)
        for p in (picture, np.where(mask[..., None], picture, np.nan))
    )
    # derivatives backwards are added up in any order
    np.testing.assert_allclose(one.values[TEXTURE], other.values[TEXTURE], atol=1e-3)
    assert one.notes == other.notes
    assert one.loss == pytest.approx(other.loss, rel=1e-2)


def test_an_environment_comes_back_from_a_mirror_ball(mi):
    """Its small, bright lights, too, which the first choice of smoothing blurred away."""
    light = np.full((8, 16, 3), 0.3)
    light[2, 4], light[3, 10] = (8, 7, 5), (3, 4, 6)

    def ball(light):
        entries = scene(mi, TRUTH, light)
        del entries["floor"]
        entries["ball"] = {"type": "sphere", "bsdf": {"type": "conductor"}}
        return entries

    picture = np.array(mi.render(mi.load_dict(ball(light)), spp=256, seed=5))
    found = bk.refine(ball(np.full(light.shape, 0.5)), picture, parameters=["sky.data"], spp=32)
    sky = found.values["sky.data"]
    assert found.loss < 0.04
    assert sky[2, 4] == pytest.approx(light[2, 4], rel=0.4)
    assert sky[3, 10] == pytest.approx(light[3, 10], rel=0.4)
    assert np.median(np.abs(sky - light) / light) < 0.15


@pytest.mark.parametrize("smoothness", [-1, np.nan, np.inf])
def test_smoothness_is_a_number(mi, picture, smoothness):
    with pytest.raises(bk.BrdfkitError, match=r"smoothness = .* should be a number"):
        bk.refine(scene(mi, TRUTH), picture, parameters=[TEXTURE], smoothness=smoothness)


def test_textures_of_integers_are_refused(mi, picture):
    with pytest.raises(bk.BrdfkitError, match=r"TensorXu8.*floats"):
        bk.refine(scene(mi, 255 * TRUTH, kind=np.uint8), picture, parameters=[TEXTURE])


def test_values_fit_the_scene(mi, picture):
    found = bk.refine(scene(mi, TRUTH), picture, parameters=[TEXTURE], steps=1, spp=4, smoothness=0)
    with pytest.raises(bk.BrdfkitError, match="shape"):
        found.put_into(mi.load_dict(scene(mi, TRUTH[:2]), optimize=False))
