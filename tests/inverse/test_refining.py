"""`refine`: numbers found through the path tracer, by derivatives that differences confirm."""

import pickle

import numpy as np
import pytest
from refined_scenes import (
    RADIANCE,
    SIZE,
    TRUTH,
    TRUTH_BSDF,
    alone,
    bsdf_of,
    corner,
    noisy,
    require_back,
    views,
)
from scipy.ndimage import gaussian_filter

import brdfkit as bk
from brdfkit.core.jit.threads import use_two_threads
from brdfkit.inverse.scenes.problem.leverage import (
    SMALLEST_REMAINDER,
    correct_for_leverage,
    sum_by_block,
)
from brdfkit.inverse.scenes.problem.parameters import choose_unknowns
from brdfkit.inverse.scenes.problem.scene import load_scene, make_integrator
from brdfkit.inverse.scenes.problem.targets import read_targets
from brdfkit.inverse.scenes.problem.views import Views
from brdfkit.inverse.scenes.result.residual_noise import ResidualNoise
from brdfkit.inverse.scenes.search import gauss_newton
from brdfkit.inverse.scenes.search.forward_derivatives import compute_derivatives
from brdfkit.inverse.scenes.search.gauss_newton import solve_step
from brdfkit.inverse.scenes.search.normal_equations import Equations, Residuals
from brdfkit.rendering.scenes.ball import ball


@pytest.fixture(scope="module")
def picture(mi):
    """The scene at the truth, with noise of 1 %."""
    clean = np.array(mi.render(mi.load_dict(corner(mi, TRUTH)), spp=2048, seed=5))
    return clean * (1 + 0.01 * np.random.default_rng(1).standard_normal(clean.shape))


def test_derivatives_are_those_of_finite_differences(mi, picture):
    found = views(
        mi, picture, corner(mi, TRUTH), ["ball.bsdf.alpha_u", "ball.bsdf.specular_reflectance"]
    )
    x, spp = found.start, 2048
    by_number = compute_derivatives(found, x, spp, 3)
    for number, step in ((0, 0.01), (2, 0.05)):
        there, here = (x + sign * step * np.eye(len(x))[number] for sign in (1, -1))
        change = found.render_residuals(there, spp, 3) - found.render_residuals(here, spp, 3)
        expected = change / (2 * step)
        # along the pictures of differences, so that what noise there is averages out
        along = (by_number[number] * expected).sum() / (expected**2).sum()
        assert along == pytest.approx(1, abs=0.02)


def test_differences_of_noisy_pictures_are_unbiased(mi, picture):
    """E² of 4 samples is, in the mean, that of 4096: noise adds nothing."""
    found = views(mi, picture, corner(mi, TRUTH))
    exact = Residuals.render(found, found.start, 4096, 900).error
    some = [Residuals.render(found, found.start, 4, seed) for seed in range(40)]
    errors = np.array([one.error for one in some])
    assert abs(errors.mean() - exact) < 4 * errors.std() / np.sqrt(len(errors))
    assert np.mean([one.compute_noise(found) for one in some]) > 20 * exact


@pytest.fixture(scope="module")
def found(mi, picture):
    start = TRUTH | {"alpha_u": 0.05, "f0": 0.6, "diffuse_reflectance": (0.5, 0.5, 0.5)}
    scene = mi.load_dict(corner(mi, start), optimize=False)
    searched = ["alpha_u", "diffuse_reflectance", "specular_reflectance"]
    names = [f"ball.bsdf.{name}" for name in searched]
    done = []
    result = bk.refine(
        scene, picture, parameters=names, spp=512, progress=lambda *at: done.append(at)
    )
    assert done
    assert all(a <= b for a, b in done)
    return result, scene


def test_known_numbers_come_back_within_their_errors(found):
    result, _ = found
    for name, value in result.values.items():
        error = np.asarray(result.standard_errors[name])
        truth = np.asarray(TRUTH[name.removeprefix("ball.bsdf.")])
        assert (np.abs(np.asarray(value) - truth) < 3.5 * error).all(), name
        assert (error < 0.1 * truth).all(), name
    assert result.steps <= 8
    assert result.loss < 0.03


def test_the_fit_is_the_material(mi, found):
    result, scene = found
    fit = result.fit
    assert fit.values["f0"] == pytest.approx(0.6)
    assert fit.standard_errors["alpha_u"] == result.standard_errors["ball.bsdf.alpha_u"]
    assert np.isnan(fit.standard_errors["f0"])
    assert np.isnan(fit.aic)
    with pytest.raises(bk.BrdfkitError, match="found by refine"):
        bk.uncertainty.bootstrap(fit, "plaster")
    assert pickle.loads(pickle.dumps(result)) == result
    others = mi.load_dict(corner(mi, TRUTH), optimize=False), corner(mi, TRUTH)
    for one in (scene, *map(result.put_into, others)):
        alpha = mi.traverse(one)["ball.bsdf.alpha_u.value"][0]
        assert alpha == pytest.approx(fit.values["alpha_u"], rel=1e-5)


def test_a_light_is_a_parameter(mi, picture):
    dim = corner(mi, TRUTH)
    dim["lamp"]["emitter"]["radiance"]["value"] = [3.0, 3.0, 3.0]
    result = bk.refine(dim, picture, parameters={"lamp.emitter.radiance": (0, 100)}, spp=256)
    error = np.array(result.standard_errors["lamp.emitter.radiance"])
    assert (np.abs(np.array(result.values["lamp.emitter.radiance"]) - RADIANCE) < 3.5 * error).all()
    assert result.fits == {}
    with pytest.raises(bk.BrdfkitError, match="not one fit"):
        _ = result.fit


def test_ctrl_c_keeps_the_best(mi, picture, monkeypatch):
    calls = []
    original = gauss_newton.Equations.render

    def stop(*args):
        calls.append(args)
        if len(calls) > 1:
            raise KeyboardInterrupt
        return original(*args)

    monkeypatch.setattr(gauss_newton.Equations, "render", stop)
    start = corner(mi, TRUTH | {"diffuse_reflectance": (0.9, 0.9, 0.9)})
    with pytest.raises(bk.Interrupted) as stopped:
        bk.refine(start, picture, parameters=["ball.bsdf.diffuse_reflectance"], starts=1)
    best = stopped.value.best
    assert "interrupted" in best.message
    assert max(best.values["ball.bsdf.diffuse_reflectance"]) < 0.9


def test_the_place_of_a_lamp_is_found_by_differences(mi, picture):
    """Of which Mitsuba's path tracer has no derivatives, alone or beside others."""
    scene = corner(mi, TRUTH)
    scene["lamp"] = {"type": "point", "position": [0.8, -1.2, 2.5], "intensity": 10.0}
    reached = np.array(mi.render(mi.load_dict(scene), spp=256, seed=5))
    reached *= 1 + 0.01 * np.random.default_rng(1).standard_normal(reached.shape)
    scene["lamp"] |= {"position": [0.5, -1.5, 2.2], "intensity": 8.0}
    before = repr(scene)
    result = bk.refine(scene, reached, parameters=["lamp.position", "lamp.intensity"], spp=128)
    error = np.array(result.standard_errors["lamp.position"])
    assert (np.abs(np.array(result.values["lamp.position"]) - [0.8, -1.2, 2.5]) < 4 * error).all()
    assert error.max() < 0.05
    assert repr(scene) == before


def test_a_far_start_does_not_fall_into_a_mirror(mi, picture):
    """A first step across all roughnesses ended at the smallest, under a lamp too dim."""
    values = TRUTH | {"alpha_u": 0.7, "specular_reflectance": (0.1,) * 3}
    dim = corner(mi, values)
    dim["lamp"]["emitter"]["radiance"]["value"] = [4.0] * 3
    names = [f"ball.bsdf.{name}" for name in ("alpha_u", "specular_reflectance")]
    names.append("lamp.emitter.radiance")
    result = bk.refine(dim, picture, parameters=names, spp=64, starts=1)
    assert result.values["ball.bsdf.alpha_u"] == pytest.approx(TRUTH["alpha_u"], abs=0.03)


def test_a_camera_that_is_off_is_said(mi, picture):
    off = corner(mi, TRUTH)
    off["sensor"]["fov"] = 33
    how = {"starts": 1, "spp": 16}
    (note,) = bk.refine(off, picture, parameters=["ball.bsdf.diffuse_reflectance"], **how).notes
    assert "the camera, a light or a shape is off" in note
    noisy = picture * (1 + 0.3 * np.random.default_rng(2).standard_normal(picture.shape))
    result = bk.refine(
        corner(mi, TRUTH), noisy, parameters=["ball.bsdf.diffuse_reflectance"], **how
    )
    assert result.loss > 0.02
    assert result.notes == ()


def test_a_crop_of_few_pixels_has_no_standard_errors(mi, picture):
    scene = corner(mi, TRUTH)
    at = {"crop_width": 2, "crop_height": 1, "crop_offset_x": 8, "crop_offset_y": 9}
    scene["sensor"]["film"] |= at
    part = picture[9:10, 8:10]
    result = bk.refine(scene, part, parameters=["ball.bsdf.diffuse_reflectance"], spp=16)
    assert "too few pixels for standard errors" in " ".join(result.notes)
    assert np.isnan(result.standard_errors["ball.bsdf.diffuse_reflectance"]).all()
    scene["sensor"]["film"] |= {"crop_width": 1, "crop_height": 1}
    with pytest.raises(bk.BrdfkitError, match="8 numbers are more than the 3 values"):
        bk.refine(scene, picture[9:10, 8:9])


BAD = {
    "another size": (lambda p: p[:-1], {}, "20 × 19 pixels"),
    "two for one camera": (lambda p: [p, p], {}, "one picture for each sensor: 2 for 1"),
    "8 bits": (lambda p: np.uint8(np.clip(p, 0, 1) * 255), {}, "8 bits"),
    "a JPEG": (lambda p: "photo.jpg", {}, "8 bits"),
    "no file": (lambda p: "missing.exr", {}, "no such file"),
    "one channel": (lambda p: p[..., 0], {}, "1 channel, and a camera's film 3"),
    "not finite": (lambda p: np.where(p > p.mean(), np.nan, p), {}, "not finite"),
    "black": (lambda p: 0 * p, {}, "black"),
    "no picture": (lambda p: [], {}, "no picture"),
    "an unknown name": (lambda p: p, {"parameters": ["ball.bsdf.alpha"]}, "did you mean"),
    "no names": (lambda p: p, {"parameters": []}, "empty"),
    "a transform": (lambda p: p, {"parameters": ["ball.to_world"]}, "cannot be searched"),
    "wrong bounds": (lambda p: p, {"parameters": {"ball.bsdf.f0": (1, 0)}}, "bounds"),
    "no samples": (lambda p: p, {"spp": 0}, "spp = 0"),
    "a mask of another size": (
        lambda p: p,
        {"mask": np.ones((3, 4))},
        r"mask has the shape \(3, 4",
    ),
    "a coloured mask": (
        lambda p: p,
        {"mask": np.ones((SIZE, SIZE, 3))},
        r"should be \(height, wid",
    ),
    "a mask below 0": (lambda p: p, {"mask": -np.ones((SIZE, SIZE))}, "finite numbers ≥ 0"),
    "a mask of 0": (lambda p: p, {"mask": np.zeros((SIZE, SIZE), bool)}, "no pixel would count"),
    "two masks": (lambda p: p, {"mask": [None, None]}, "one mask for each picture: 2 for 1"),
    "no such mask": (lambda p: p, {"mask": "mask.png"}, "no such file"),
    "a mask of clipped pixels": (
        lambda p: np.where(np.arange(SIZE) < 5, 9.0, p.T).T,
        {"mask": np.repeat(np.arange(SIZE)[:, None] < 5, SIZE, axis=1)},
        "more than the 0 values",
    ),
    "no steps": (lambda p: p, {"steps": 0}, "steps = 0"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_sentence(mi, picture, case):
    change, how, says = BAD[case]
    with pytest.raises(bk.BrdfkitError, match=says) as error:
        bk.refine(corner(mi, TRUTH), change(picture), **how)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("integrator", ["depth", "ptracer"])
def test_integrators_without_derivatives_are_refused(mi, picture, integrator):
    scene = corner(mi, TRUTH)
    scene["integrator"] = {"type": integrator}
    with pytest.raises(bk.BrdfkitError, match="no derivatives"):
        bk.refine(scene, picture)


def test_clipped_pixels_do_not_count(mi, picture):
    bright = np.minimum(picture, np.quantile(picture, 0.9))
    (target,) = read_targets(bright)
    assert target.clipped == pytest.approx(0.1, abs=0.01)
    assert (target.weights[bright == bright.max()] == 0).all()


WHITE_OUT = {"diffuse_reflectance": (0.0,) * 3, "specular_reflectance": (1e30,) * 3}


def test_pictures_that_are_not_finite_are_no_steps(mi, picture):
    """A weight that nothing shows went to 1e13, and its light to infinity and NaN."""
    found = views(mi, picture, corner(mi, TRUTH | {"specular_reflectance": (0.0,) * 3}))
    x = found.start
    here, there = (
        Residuals.render(found, found.start, 4, 0),
        Residuals.render(found, np.where(found.is_linear, 1e30, x), 4, 0),
    )
    assert there.error == np.inf
    assert here.compute_gain(there)[0] == -np.inf
    numbers = len(x)
    power = np.full(numbers, 1e-25)
    hidden = Equations(
        np.full(numbers, -1e-9), 1e-25 * np.eye(numbers), np.zeros((numbers, 1)), power
    )
    step = solve_step(found, here, hidden, 1e-2)
    assert abs(step[found.is_linear]).max() == pytest.approx(10)
    with pytest.raises(bk.BrdfkitError, match="not finite where the search begins"):
        bk.refine(corner(mi, TRUTH | WHITE_OUT), picture, starts=1, spp=4)


def test_what_weights_of_0_hide_is_said(mi, picture):
    black = TRUTH | {"specular_reflectance": (0.0,) * 3, "f0": 0.0}
    with pytest.raises(bk.BrdfkitError, match=r"ball.bsdf.specular_reflectance = 0 hides it"):
        bk.refine(corner(mi, black), picture, parameters=["ball.bsdf.alpha_u"], starts=1, spp=16)
    names = ["ball.bsdf.alpha_u", "ball.bsdf.diffuse_reflectance"]
    result = bk.refine(corner(mi, black), picture, parameters=names, starts=1, spp=16)
    assert result.values["ball.bsdf.alpha_u"] == pytest.approx(TRUTH["alpha_u"])  # where it began
    assert any("specular_reflectance = 0 hides what" in note for note in result.notes)


def test_all_numbers_may_end_on_bounds(mi, picture):
    name = "ball.bsdf.diffuse_reflectance"
    result = bk.refine(corner(mi, TRUTH), picture, parameters={name: (0.6, 0.9)}, spp=16, starts=1)
    assert result.values[name] == pytest.approx((0.6,) * 3)
    assert result.at_bounds == (name,)
    assert np.isnan(result.standard_errors[name]).all()


def test_two_lobes_that_trade_off_come_apart(mi):
    """After 8 steps they were up to 84 % and 5 standard errors off."""
    truth = {
        "models": "ggx+ggx",
        "diffuse_reflectance": (0.3, 0.15, 0.08),
        "ggx_1_specular_reflectance": (0.3, 0.3, 0.25),
        "ggx_1_alpha_u": 0.45,
        "ggx_1_f0": 0.6,
        "ggx_2_specular_reflectance": (0.1, 0.1, 0.1),
        "ggx_2_alpha_u": 0.1,
        "ggx_2_f0": 0.6,
    }

    def scene(values):
        entries = corner(mi, TRUTH, size=32)
        entries["ball"]["bsdf"] = bsdf_of("mixture", values)
        return entries

    (picture,) = noisy(mi, scene(truth), 1024)
    begin = truth | {"ggx_1_alpha_u": 0.3, "ggx_2_specular_reflectance": (0.2,) * 3}
    searched = [name for name in truth if name.endswith(("alpha_u", "reflectance"))]
    names = [f"ball.bsdf.{name}" for name in searched]
    result = bk.refine(scene(begin), picture, parameters=names, spp=256, starts=1, seed=4)
    assert "no step gains more" in result.message
    for name in searched:
        error = np.asarray(result.standard_errors[f"ball.bsdf.{name}"])
        away = np.asarray(result.values[f"ball.bsdf.{name}"]) - truth[name]
        assert (np.abs(away) < 3.5 * error).all(), name
        assert (np.abs(away) < 0.25 * np.asarray(truth[name])).all(), name


def test_a_search_that_is_stuck_tries_other_samples_and_says_so(mi, picture, monkeypatch):
    seeds = []

    def stuck(views, found, damping, seed, last):
        seeds.append(seed)
        return None, damping

    monkeypatch.setattr(gauss_newton, "_find_step", stuck)
    start = corner(mi, TRUTH | {"diffuse_reflectance": (0.9, 0.9, 0.9)})
    result = bk.refine(
        start, picture, parameters=["ball.bsdf.diffuse_reflectance"], starts=1, spp=16
    )
    assert "no step, however short" in result.message
    # of half of the samples, and then of all
    assert len(set(seeds)) == 2 * (gauss_newton.FRESH_SAMPLES + 1)


def test_what_is_masked_counts_nowhere(mi, picture):
    """Around the ball, the photograph is black, or bright, or no numbers at all."""
    rows, columns = np.mgrid[:SIZE, :SIZE] + 0.5
    ball_alone = np.hypot(columns - SIZE / 2, rows - SIZE / 2) < 0.3 * SIZE
    start = TRUTH | {"diffuse_reflectance": (0.5, 0.5, 0.5)}
    name = "ball.bsdf.diffuse_reflectance"
    masked = ball_alone[..., None]
    bad = [np.where(masked, picture, rest) for rest in (0, 99 * picture, np.nan)]
    how = {"mask": ball_alone, "starts": 1, "spp": 64}
    one, *others = (bk.refine(corner(mi, start), p, parameters=[name], **how) for p in bad)
    assert all(other == one for other in others)
    error = np.array(one.standard_errors[name])
    assert (np.abs(np.array(one.values[name]) - TRUTH["diffuse_reflectance"]) < 3.5 * error).all()
    assert one.fit.samples == ball_alone.sum()
    assert "off" not in " ".join(one.notes)
    without = bk.refine(corner(mi, start), bad[0], parameters=[name], starts=1, spp=16)
    assert "off" in " ".join(without.notes)


def test_masks_are_weights_of_any_unit(mi, picture, tmp_path):
    half = np.arange(SIZE * SIZE).reshape(SIZE, SIZE) % SIZE < SIZE // 2
    file = tmp_path / "mask.png"
    with use_two_threads():
        mi.Bitmap(np.repeat(half[..., None] * np.uint8(255), 3, axis=2)).write(str(file))
    scene = load_scene(corner(mi, TRUTH), (SIZE, SIZE))
    names = mi.traverse(scene)

    def seen_by(mask):
        targets = read_targets(picture, mask=mask)
        return Views(scene, make_integrator(scene), targets, names, choose_unknowns(names, None))

    by_half, everywhere = seen_by(half), seen_by(None)
    for same in (3.0 * half, [half], file):
        np.testing.assert_allclose(seen_by(same).weights, by_half.weights)
    np.testing.assert_array_equal(seen_by(half | True).weights, everywhere.weights)
    assert by_half.blocks[1] == everywhere.blocks[1] / 2
    assert len(Residuals.render(by_half, by_half.start, 4, 0).terms) == half.sum()


def test_numbers_that_nothing_shows_are_said(mi, picture):
    scene = corner(mi, TRUTH)
    scene["ball"]["center"] = [0, -50, 0]  # behind the camera
    with pytest.raises(bk.BrdfkitError, match="no picture changes"):
        bk.refine(scene, picture, parameters=["ball.bsdf.alpha_u"], starts=1, spp=16)


def test_signed_numbers_come_back(mi):
    """Weights of Koenderink's basis, one of them below 0, from where it is 0."""
    truth = {"ball.bsdf.a_0_0_0": 0.5, "ball.bsdf.a_1_1_1": -0.1}
    bsdf = {"type": "koenderink", "order": 1, "a_0_0_0": 0.5, "a_1_1_1": -0.1}
    (picture,) = noisy(mi, alone(mi, bsdf))
    begin = alone(mi, bsdf | {"a_0_0_0": 0.8, "a_1_1_1": 0.0})
    require_back(bk.refine(begin, picture, spp=256), truth)


def test_media_are_searched_by_differences(mi):
    """prbvolpath has no derivatives forwards."""
    box = {"type": "cube", "bsdf": {"type": "null"}, "to_world": mi.ScalarTransform4f().scale(0.5)}
    medium = {"type": "homogeneous", "sigma_t": 2.0, "albedo": 0.8}

    def smoke(**changed):
        scene = alone(mi, TRUTH_BSDF, "volpath")
        return {**scene, "ball": {**box, "interior": {**medium, **changed}}}

    (picture,) = noisy(mi, smoke(), 256)
    name = "ball.interior_medium.sigma_t"
    begin = mi.load_dict(smoke(sigma_t=1.0), optimize=False)
    result = bk.refine(begin, picture, parameters={f"{name}.value": (0.1, 10)}, starts=1, spp=64)
    require_back(result, {name: 2.0})


def test_two_cameras_and_what_none_of_them_sees(mi):
    scene = alone(mi, TRUTH_BSDF)
    to_side = mi.ScalarTransform4f().look_at([4, 0, 1], [0, 0, 0.7], [0, 0, 1])
    scene["other"] = {**scene["sensor"], "to_world": to_side}
    scene["hidden"] = {**scene["ball"], "center": [0, -50, 0], "bsdf": {"type": "ward"}}
    pictures = noisy(mi, scene)
    alpha, hidden = "ball.bsdf.alpha_u", "hidden.bsdf.alpha_u"
    begin = {**scene, "ball": {**scene["ball"], "bsdf": {**TRUTH_BSDF, "alpha_u": 0.2}}}
    result = bk.refine(begin, pictures, parameters=[alpha, f"{hidden}.value"], starts=1, spp=64)
    require_back(result, {alpha: TRUTH["alpha_u"]})
    assert result.values[hidden] == pytest.approx(0.2)  # where it began
    assert np.isnan(result.standard_errors[hidden])
    assert any(hidden in note for note in result.notes)
    assert len(result.pictures) == 2


def test_a_material_begins_on_the_ball_of_render(mi, tmp_path):
    truth = {"diffuse_reflectance": (0.4, 0.2, 0.1)}
    named = bsdf_of("lambert", truth)
    clean = np.array(mi.render(mi.load_dict(ball(named, (16, 16))), spp=512, seed=8))
    with use_two_threads():
        mi.Bitmap(clean.astype(np.float32)).write(str(tmp_path / "ball.exr"))
    model = bk.models()["lambert"](diffuse_reflectance=0.7)
    result = bk.refine(model, tmp_path / "ball.exr", spp=256)
    error = np.array(result.fit.standard_errors["diffuse_reflectance"])
    away = np.array(result.fit.values["diffuse_reflectance"]) - truth["diffuse_reflectance"]
    assert (np.abs(away) < 3.5 * error).all()
    assert result.fit.loss_name == "rendered"


def test_steps_cost_less_than_four_pictures(mi, picture):
    """By samples, of which a derivative's take as long as two or three of a picture's."""
    found = views(mi, picture, corner(mi, TRUTH))
    here = Residuals.render(found, found.start, 128, 0)
    assert found.cost == pytest.approx(128)
    Equations.render(found, here, 0)
    Residuals.render(found, found.start, 128, 0)
    assert found.cost < 4 * 128 + 128


def test_scores_are_without_leverage():
    """Beside the formula of linear regression, Jᵀ (1 - J (JᵀJ)⁻¹ Jᵀ)^(-1/2) r, block by block."""
    rng = np.random.default_rng(4)
    index = np.repeat(np.arange(6), 3)
    jacobian, residuals = rng.standard_normal((2, 18, 3)), rng.standard_normal((18, 3))
    jacobian[:, index == 2] *= 10  # a highlight
    scores = sum_by_block((jacobian * residuals).sum(axis=2), (index, 6))
    found = correct_for_leverage(scores, jacobian, (index, 6))
    flat = jacobian.reshape(2, -1)
    inverse = np.linalg.inv(flat @ flat.T)
    for block in range(6):
        own = jacobian[:, index == block].reshape(2, -1)
        values, vectors = np.linalg.eigh(np.eye(9) - own.T @ inverse @ own)
        root = vectors / np.sqrt(np.maximum(values, SMALLEST_REMAINDER)) @ vectors.T
        expected = own @ root @ residuals[index == block].ravel()
        np.testing.assert_allclose(found[:, block], expected, rtol=1e-2)
    assert (np.abs(found[:, 2]) > 2 * np.abs(scores[:, 2])).any()


def test_names_are_told_and_values_below_0_need_bounds(mi, picture):
    scene = mi.load_dict(corner(mi, TRUTH), optimize=False)
    for name in ("ball.bsdf.f0", "ball.bsdf.f0.value"):
        (one,) = choose_unknowns(mi.traverse(scene), [name])
        assert one.name == "ball.bsdf.f0"
    low = corner(mi, TRUTH)
    low["sensor"]["principal_point_offset_x"] = -0.1
    with pytest.raises(bk.BrdfkitError, match="give its bounds"):
        bk.refine(low, picture, parameters=["sensor.principal_point_offset_x"])


@pytest.mark.parametrize("kind", ["box", "gaussian"])
def test_what_is_left_is_noise_or_not(mi, kind):
    """Neighbours of noise have nothing in common, whatever the filter, beside a firefly that would
    decide alone; those of a highlight that is too wide have."""
    rng = np.random.default_rng(6)
    scene = corner(mi, TRUTH, size=40)
    scene["sensor"]["film"]["rfilter"] = {"type": kind}
    found = views(mi, rng.random((40, 40, 3)), scene, ["ball.bsdf.alpha_u"])

    def judged(left):
        left[3, 5] *= 50
        halves = [(left + 0.3 * rng.standard_normal(left.shape)).reshape(-1, 3) for _ in range(2)]
        return ResidualNoise.measure(found, Residuals(found.start, *halves, 4, np.ones(1), 0.0))

    def noise():
        plain = rng.standard_normal((40, 40, 3))
        return plain if kind == "box" else 3.5 * gaussian_filter(plain, (0.5, 0.5, 0))

    many = [judged(noise()) for _ in range(30)]
    assert all(one.is_noise for one in many)
    assert 0.6 < np.std([one.significance for one in many]) < 1.5
    rows, columns = np.mgrid[:40, :40]
    wide = np.exp(-((rows - 20) ** 2 + (columns - 20) ** 2) / 200)[..., None]
    other = judged(noise() + 5 * wide)
    assert not other.is_noise
    assert other.area > 3
    assert judged(np.zeros((40, 40, 3))).is_noise


def test_standard_errors_grow_where_the_scene_is_wrong(mi):
    """The roughness alone was 16 standard errors off where colours were wrong, without a word."""

    def scene(values):
        return corner(mi, values, size=32)

    (picture,) = noisy(mi, scene(TRUTH))
    wrong = TRUTH | {"specular_reflectance": (0.2, 0.2, 0.2), "alpha_u": 0.5}
    name = "ball.bsdf.alpha_u"
    result = bk.refine(scene(wrong), picture, parameters=[name], starts=1, spp=128)
    (note,) = [note for note in result.notes if "are not noise" in note]
    assert "χ² per degree of freedom" in note
    assert "multiplied by" in note
    off = abs(result.values[name] - TRUTH["alpha_u"])
    assert off > 0.05
    assert off < 4 * result.standard_errors[name]
    right = bk.refine(
        scene(TRUTH | {"alpha_u": 0.5}), picture, parameters=[name], starts=1, spp=128
    )
    assert "are not noise" not in " ".join(right.notes)
    assert right.standard_errors[name] < 0.2 * result.standard_errors[name]


def test_a_search_that_is_not_at_its_end_says_so_first(mi, picture):
    start = corner(mi, TRUTH | {"alpha_u": 0.7, "specular_reflectance": (0.1,) * 3})
    names = [f"ball.bsdf.{name}" for name in ("alpha_u", "specular_reflectance")]
    how = {"starts": 1, "spp": 128}
    early, late = (bk.refine(start, picture, parameters=names, steps=n, **how) for n in (1, 30))
    assert not early.converged
    assert late.converged
    assert "Not converged" in str(early).splitlines()[1]
    assert "Not converged" not in str(late)
    for name in names:
        away = np.abs(np.subtract(early.values[name], TRUTH[name.removeprefix("ball.bsdf.")]))
        assert (away < 4 * np.array(early.standard_errors[name])).all()


def test_a_look_shows_what_was_given_beside_what_was_found(mi, picture):
    mask = np.arange(SIZE)[:, None] < np.full(SIZE, 12)
    unknown = np.where(mask[..., None], picture, np.nan)
    name = "ball.bsdf.diffuse_reflectance"
    how = {"mask": mask, "starts": 1, "spp": 16}
    result = bk.refine(
        corner(mi, TRUTH), 20 * unknown, parameters={"lamp.emitter.radiance": (0, 900)}, **how
    )
    look = result.look()
    given, found = look.pictures.values()
    assert np.quantile(given[mask], 0.99) == pytest.approx(1)
    assert not given[~mask].any()
    assert not found[~mask].any()
    assert look.psnr()["found"] > 20
    assert result._repr_html_().count("<img") == 1
    with pytest.raises(bk.BrdfkitError, match="picture = 1 should be 0 to 0"):
        result.look(1)
    grey = bk.refine(corner(mi, TRUTH), picture, parameters=[name], starts=1, spp=4, steps=1)
    assert pickle.loads(pickle.dumps(grey)).look().pictures.keys() == {"given", "found"}
