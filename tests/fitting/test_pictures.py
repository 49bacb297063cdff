"""Fits by pictures: what is summed is a picture, and what is fitted looks right."""

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.images.ball import LIGHTS, draw_pixels
from brdfkit.images.ball.half_vectors import HalfVectors
from brdfkit.images.ball.lights import get_light_sampling
from brdfkit.images.ball.normals import VIEW, draw_normals
from brdfkit.images.ball.pixels import BRIGHT_SHARE
from brdfkit.materials.measured.selection import select_samples
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.pixel_problem import PictureProblem

GLOSSY = {"diffuse_reflectance": (0.3, 0.1, 0.05), "specular_reflectance": 0.8, "f0": 0.3}


def measured(model, n=3000):
    """A model as a measured material that is exact between its samples, too."""
    wi, wo = draw_direction_pairs(n, seed=1, max_degrees=79)
    name = model.name
    return bk.Measured.from_samples(wi, wo, model.eval(wi, wo), lookup=model.eval, name=name)


def directions(n):
    """Directions over the sphere, in cells of equal solid angle."""
    z, phi = np.meshgrid((np.arange(n) + 0.5) / n * 2 - 1, (np.arange(2 * n) + 0.5) / n * np.pi)
    return from_angles(np.arccos(z.ravel()), phi.ravel())


@pytest.mark.quick
@pytest.mark.parametrize("light", LIGHTS)
def test_a_light_is_drawn_by_its_density(light):
    w, sampling = directions(600), get_light_sampling(light)
    drawn = sampling.sample(np.random.default_rng(0).random((20_000, 3)))
    assert_drawn_by(sampling.pdf(w), w, drawn)


@pytest.mark.quick
def test_half_vectors_are_drawn_by_their_density():
    """Above the surface; directions below it come of half vectors that face away from the eye."""
    w, sampling = directions(600), HalfVectors(bk.models()["ggx"](**GLOSSY, alpha_u=0.2).eval)
    wo = np.broadcast_to(from_angles(0.7, 1.0), w.shape)
    drawn = sampling.sample(wo[:20_000], np.random.default_rng(0).random((20_000, 3)))
    assert_drawn_by(np.where(w[:, 2] > 0, sampling.pdf(w, wo), 0), w, drawn[drawn[:, 2] > 0])


def assert_drawn_by(density, w, drawn, count=20_000):
    """The shares of directions in each octant, of `count` that were drawn, are those of a density
    at `w` over the sphere."""
    of_all, of_drawn = ((x > 0) @ (4, 2, 1) for x in (w, drawn))
    expected = np.bincount(of_all, density, 8) * 4 * np.pi / len(w)
    assert expected.sum() > 0.5
    np.testing.assert_allclose(np.bincount(of_drawn, minlength=8) / count, expected, atol=0.01)


@pytest.mark.quick
def test_normals_show_the_disc_evenly():
    """Weighted, their means are those of the disc: of x, y, x² and y², and of a small spot."""
    of_material = HalfVectors(bk.models()["ggx"](**GLOSSY, alpha_u=0.1).eval)
    rng = np.random.default_rng(3)
    normals, weights = draw_normals(4000, get_light_sampling("hall"), of_material, rng)
    right = np.cross((0, 0, 1), VIEW) / np.hypot(*VIEW[:2])
    x, y = normals @ right, normals @ np.cross(VIEW, right)
    spot = (np.hypot(x + 0.2, y - 0.4) < 0.2) / 0.04
    means = np.array([x, y, x * x, y * y, spot]) @ weights / len(normals)
    assert weights.mean() == pytest.approx(1, abs=0.02)
    np.testing.assert_allclose(means, [0, 0, 0.25, 0.25, 1], atol=0.03)


@pytest.mark.parametrize("light", ["court", "sky"])
def test_pixels_are_those_of_a_rendered_ball(light, llvm_variant):
    """Direct light by Mitsuba, of a brushed material, at the same points of the ball: to 2 % of
    the brightest pixel in the mean, of which 0.6 % is noise."""
    mi = llvm_variant
    model = bk.models()["ggx"](**GLOSSY, alpha_u=0.5, alpha_v=0.2)
    pixels = draw_pixels([light], model.eval, pixels=400, directions=500)
    size = 64
    up = mi.ScalarTransform4f().look_at((4 * VIEW).tolist(), [0, 0, 0], [0, 0, 1])
    towards = directions_of_map(256)
    radiance = LIGHTS[light](towards.reshape(-1, 3)).reshape(*towards.shape[:2], 1)
    scene = {
        "type": "scene",
        "integrator": {"type": "direct"},
        "sensor": {
            "type": "orthographic",
            "to_world": up,
            "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}},
            "sampler": {"type": "multijitter", "sample_count": 100},
        },
        "light": {
            "type": "envmap",
            "bitmap": mi.Bitmap(np.repeat(radiance, 3, axis=-1).astype(np.float32)),
            "to_world": mi.ScalarTransform4f().rotate([1, 0, 0], 90),
        },
        "ball": {"type": "sphere", "bsdf": model.scene_dict()},
    }
    picture = np.array(mi.render(mi.load_dict(scene)))[..., :3]
    of_light, of_material = get_light_sampling(light), HalfVectors(model.eval)
    normals, _ = draw_normals(400, of_light, of_material, np.random.default_rng(0))
    right = np.cross((0, 0, 1), VIEW) / np.hypot(*VIEW[:2])
    x, y = normals @ right, normals @ np.cross(VIEW, right)
    inner = np.hypot(x, y) < 0.93
    rows = ((1 - y[inner]) / 2 * size).astype(int)
    columns = ((1 + x[inner]) / 2 * size).astype(int)
    found, expected = pixels.values[inner], picture[rows, columns]
    scale = (found * expected).sum() / (expected**2).sum()
    assert np.abs(found - scale * expected).mean() < 0.02
    assert found.std() > 0.1


def directions_of_map(height):
    """The directions of an environment map's pixels, in a world with z up."""
    theta = np.linspace(0, np.pi, height + 1)[:, None]
    phi = (np.arange(2 * height) + 0.5) / (2 * height) * 2 * np.pi
    side = np.sin(theta)
    parts = (side * np.sin(phi), side * np.cos(phi), np.cos(theta))
    return np.stack(np.broadcast_arrays(*parts), axis=-1)


@pytest.mark.quick
def test_pixels_are_exposed_and_linear():
    dark, bright = (bk.models()["lambert"](diffuse_reflectance=r) for r in (0.1, 0.8))
    pixels = draw_pixels(("court", "hall"), dark.eval, pixels=200)
    np.testing.assert_allclose(pixels.evaluate(bright.eval), 8 * pixels.values, rtol=1e-12)
    assert pixels.take_first_pixels(7).evaluate(dark.eval) == pytest.approx(pixels.values[:7])
    for picture in (0, 1):
        values, weights = pixels.values[picture::2, 0], pixels.weights[picture::2]
        assert weights[values > 1].sum() / weights.sum() == pytest.approx(BRIGHT_SHARE, abs=0.01)
    limited = draw_pixels(("court", "hall"), dark.eval, max_angle=60, pixels=200)
    cosines = np.stack([limited.wi[:, 2], limited.wo[:, 2]])
    assert (cosines > 0.5).all()


@pytest.mark.parametrize("name", ["ggx", "ward", "ggx+lafortune"])
def test_gradient_of_pictures(name):
    """Against central differences, of all coordinates and weights."""
    truth = bk.models()["ggx"](**GLOSSY, alpha_u=0.2)
    model, data = bk.model.labels.model(name), measured(truth, 300)
    samples, space = select_samples(data, 80.0), Space.for_model(model, {}, {}, False)
    pixels = draw_pixels(("sky",), truth.eval, pixels=60)
    problem = PictureProblem(model, samples, bk.losses.Picture(share=0.1), space, pixels)
    rng = np.random.default_rng(2)
    u = rng.uniform(0.3, 0.7, (1, len(space.names)))
    weights = rng.uniform(0.1, 0.4, (1, 3, len(model.weights())))
    found = problem.expand_at_weights(u, weights)
    residuals = np.concatenate(problem.compute_residuals(u, weights))
    assert found.error[0] == pytest.approx(residuals @ residuals, rel=1e-12)

    def error(point):
        shapes, flat = point[: u.size], point[u.size :]
        return problem.compute_sums(
            shapes[None], flat.reshape(weights.shape), curvature=False
        ).error[0]

    at, h = np.concatenate([u[0], weights.ravel()]), 1e-6
    steps = h * np.eye(len(at))
    differences = [(error(at + step) - error(at - step)) / (2 * h) for step in steps]
    np.testing.assert_allclose(2 * found.gradient[0], differences, rtol=1e-5, atol=1e-8)


@pytest.mark.parametrize(
    ("name", "shapes"),
    [("ggx", {"alpha_u": 0.05, "f0": 0.3}), ("ward", {"alpha_u": 0.4, "alpha_v": 0.15})],
)
def test_known_parameters_come_back(name, shapes):
    """Where a model can meet every pixel, and the same from equal seeds."""
    truth = bk.models()[name](**shapes, diffuse_reflectance=(0.3, 0.1, 0.05))
    how = {"loss": "picture", "starts": 4, "anisotropic": "alpha_v" in shapes}
    found = bk.fit(measured(truth, 500), name, **how)
    for parameter, value in truth.values.items():
        np.testing.assert_allclose(found.values[parameter], value, rtol=1e-6, err_msg=parameter)
    assert found.loss < 1e-7
    assert bk.fit(measured(truth, 500), name, **how) == found


def window(w):
    """A light of the test: a room with one large window, which no fit has seen."""
    towards = from_angles(1.1, -2.2)
    return 0.1 + 0.1 * (w[:, 2] > 0) + 20 * (w @ towards > np.cos(0.25))


def test_a_fit_by_pictures_looks_better(monkeypatch):
    """By 1 dB under a light that it did not see; its table error is less than half as large again
    as by the loss that minimises it."""
    monkeypatch.setitem(LIGHTS, "window", window)
    data = bk.Measured.from_table(bk.load("dusty_gold").resampled((60, 30, 60)).values)
    pixels = draw_pixels(["window"], data.eval, seed=9, pixels=600)
    decibels, errors = {}, {}
    for loss in ("log", "cbrt", "picture"):
        found = bk.fit(data, "ggx", loss=loss)
        squares = np.square(pixels.evaluate(found.eval) - pixels.values).mean(axis=1)
        decibels[loss] = -10 * np.log10(pixels.weights @ squares)
        errors[loss] = bk.compare(data, found).errors["ggx"]["log"]
    assert decibels["picture"] > max(decibels["log"], decibels["cbrt"]) + 1
    assert errors["picture"] < 1.5 * errors["log"]


@pytest.mark.quick
def test_a_fit_says_what_it_saw(tmp_path):
    data = measured(bk.models()["ggx"](**GLOSSY, alpha_u=0.3), 500)
    found = bk.fit(data, "lambert", loss=bk.losses.Picture(lights=("hall", "sky")))
    assert found.notes[0].startswith("seen: pictures of a ball under hall and sky")
    assert np.isnan(found.aic)
    assert np.isnan(found.standard_errors["diffuse_reflectance"]).all()
    bk.save(found, tmp_path / "fit.json")
    assert bk.load(tmp_path / "fit.json") == found
    assert "picture" not in bk.compare(data, found).errors["lambert"]
    with pytest.raises(BrdfkitError, match="lambert was fitted by the loss picture"):
        bk.uncertainty.bootstrap(found, data)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("model", "how", "words"),
    [
        ("lambert", {"robust": "huber"}, "robust looks at samples one by one.*leave robust out"),
        ("lambert", {"weights": np.ones(500)}, "weights looks at samples one by one"),
        ("koenderink", {}, "koenderink: its values may be negative and are then clamped"),
    ],
)
def test_what_pictures_cannot_do_is_refused(model, how, words):
    with pytest.raises(BrdfkitError, match=words):
        bk.fit(
            measured(bk.models()["lambert"](diffuse_reflectance=(0.1, 0.2, 0.3)), 500),
            model,
            loss="picture",
            **how,
        )


@pytest.mark.quick
@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"lights": ("hal",)}, "no light of pictures 'hal'; did you mean hall"),
        ({"lights": ()}, "lights is empty; name some of court, hall, sky, studio"),
        ({"share": -1}, "share = -1 should be a number of at least 0"),
        ({"share": "much"}, "share = 'much' should be"),
    ],
)
def test_a_bad_picture_is_refused(given, words):
    with pytest.raises(BrdfkitError, match=words):
        bk.losses.Picture(**given)
