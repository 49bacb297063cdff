"""What samples stand for, against integrals that are known; fits that keep the light of data."""

import numpy as np
import pytest

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.core.geometry.directions import from_angles, to_half_difference
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model.samples.measures import MEASURES, compute_measure, integrate_measure

INTEGRALS = [name for name, power in MEASURES.items() if power is not None]


def grid(theta_i, theta_o, phi):
    """A grey material at a goniometer's angles [degrees]."""
    angles = np.meshgrid(*map(np.radians, (theta_i, theta_o, phi)), indexing="ij")
    wi, wo = from_angles(angles[0].ravel(), 0.0), from_angles(angles[1].ravel(), angles[2].ravel())
    return bk.Measured.from_samples(wi, wo, np.full(len(wi), 0.1))


def shares(data, measure, max_angle=80.0):
    """How much of a measure each sample stands for, as a share of all below `max_angle`."""
    samples = select_samples(data, max_angle)
    return samples, compute_measure(samples.extents, measure) / integrate_measure(
        max_angle, measure
    )


def test_all_directions_have_the_solid_angle_of_two_caps():
    """Divided by 4 · 2π: dω_i dω_o = 4 s dθ_h dθ_d dφ_d dφ_h."""
    for angle in (40.0, 80.0):
        cap = 2 * np.pi * (1 - np.cos(np.radians(angle)))
        assert integrate_measure(angle, "solid_angle") == pytest.approx(
            cap**2 / (8 * np.pi), rel=3e-3
        )


@pytest.mark.parametrize("measure", INTEGRALS)
def test_cells_of_a_table_stand_for_all(measure):
    _, parts = shares(bk.load("car_paint"), measure)
    # The geometric mean of a cell's two sizes is a little more than the mean of √s in it
    assert parts.sum() == pytest.approx(1, abs=2e-3)


@pytest.mark.parametrize("measure", INTEGRALS)
def test_random_samples_integrate_as_a_table_does(measure):
    """A narrow and a wide function of theta_h, and one of theta_d, to 2 %."""
    wi, wo = draw_direction_pairs(8_000, seed=3, max_degrees=79.9)
    near = wi * [-1, -1, 1] + np.random.default_rng(1).normal(0, 0.1, wi.shape)
    near /= np.linalg.norm(near, axis=1, keepdims=True)
    wo = np.where((np.arange(len(wi)) % 2 == 0)[:, None] & (near[:, 2:] > 0.18), near, wo)
    scattered = bk.Measured.from_samples(wi, wo, np.full(len(wi), 0.1))
    for function in (
        lambda theta_h, theta_d: np.exp(-((theta_h / 0.15) ** 2)),
        lambda theta_h, theta_d: np.cos(theta_h),
        lambda theta_h, theta_d: np.sin(theta_d) ** 2,
    ):
        means = []
        for data in (bk.load("car_paint"), scattered):
            samples, parts = shares(data, measure)
            theta_h, theta_d, _ = to_half_difference(samples.wi, samples.wo)
            means.append(parts @ function(theta_h, theta_d) / parts.sum())
        assert means[1] == pytest.approx(means[0], rel=0.02)


def test_what_is_far_from_all_samples_is_unrepresented():
    full = grid(range(0, 80, 5), range(0, 80, 5), range(0, 181, 15))
    narrow = grid(range(0, 40, 5), range(0, 40, 5), range(0, 181, 15))
    assert bk.fit(full, "lambert").unrepresented < 0.01
    assert bk.fit(narrow, "lambert").unrepresented > 0.2


@pytest.mark.quick
@pytest.mark.parametrize("name", ["paper_white", "cc_ibiza_sunset"])
def test_the_grid_of_an_rgl_file_stands_for_nearly_all(name, measured_data):
    """Of its eight incidences one stands for 10°: to 10 %."""
    data = bk.load(measured_data / "rgl" / f"{name}_rgb.bsdf")
    for measure in INTEGRALS:
        _, parts = shares(data, measure)
        assert parts.sum() == pytest.approx(1, abs=0.1)


def test_a_fit_without_grazing_angles_keeps_its_light(measured_data):
    """By the loss alone a ggx of this white paint reflects 1.5 times the light at 75°."""
    data = bk.load(measured_data / "minidiff_paints" / "C1_White.astm.xz")
    found = bk.fit(data, "ggx")
    assert any("with a term for its albedo" in note for note in found.notes)
    assert max(map(max, found.albedo.fit)) <= 1.001
    assert found.message == "converged"
    fit, measured = (
        np.array(a[:3]).mean(axis=1) for a in (found.albedo.fit, found.albedo.measured)
    )
    np.testing.assert_allclose(fit, measured, rtol=0.2)


def test_a_model_that_cannot_have_the_light_says_so(measured_data):
    data = bk.load(measured_data / "alta_retro" / "retro-gray-tape.dat.xz")
    found = bk.fit(data, "ggx")
    assert found.message == "converged, but its light is wrong"
    assert any("where the measurement reflects" in note for note in found.notes)


@pytest.mark.quick
def test_an_unknown_measure_is_refused():
    with pytest.raises(bk.BrdfkitError, match="no measure of directions 'solid'"):
        bk.losses.Loss("mine", "mine", lambda m, r, ci, co: m - r, measure="solid")


@pytest.mark.parametrize("loss", [n for n, one in bk.losses.named.by_sample.items() if n != "kurt"])
def test_either_direction_may_be_first(loss):
    """A goniometer that turns the detector, and one that turns the lamp, give one fit."""
    wi, wo = draw_direction_pairs(2_000, seed=5, max_degrees=75.0)
    values = bk.models()["ggx"](alpha_u=0.3, alpha_v=0.3).eval(wi, wo)
    values = values * np.random.default_rng(2).lognormal(0, 0.2, values.shape)
    pairs = (wi, wo), (wo, wi)
    one, other = (bk.fit(bk.Measured.from_samples(*p, values), "ggx", loss=loss) for p in pairs)
    assert other.loss == pytest.approx(one.loss, rel=1e-9)
    assert other.values["alpha_u"] == pytest.approx(one.values["alpha_u"], rel=1e-6)


def test_samples_that_are_left_out_tell_no_light():
    """Of weight 0, or beyond the largest angle: values there change no fit and no albedo."""
    wi, wo = draw_direction_pairs(1_500, seed=4, max_degrees=79.0)
    values = bk.models()["ggx"](alpha_u=0.3, alpha_v=0.3).eval(wi, wo)
    out = np.arange(len(wi)) % 10 == 0
    steep = np.minimum(wi[:, 2], wo[:, 2]) < np.cos(np.radians(60))
    for rows, how in ((out, {"weights": 1.0 - out}), (steep, {"max_angle": 60.0})):
        changed = np.where(rows[:, None], 30 * values, values)
        fits = [
            bk.fit(bk.Measured.from_samples(wi, wo, v), "ward", **how) for v in (values, changed)
        ]
        assert fits[1].albedo == fits[0].albedo
        assert fits[1].values == fits[0].values


@pytest.mark.quick
@pytest.mark.parametrize(
    ("factor", "said"), [(100.0, "more than arrives"), (1e-4, "blackest paints")]
)
def test_a_file_in_another_unit_is_told_so(factor, said):
    """In one sentence, and no constraint is advised."""
    model = bk.models()["ggx"](alpha_u=0.3, alpha_v=0.3)
    wi, wo = draw_direction_pairs(1_500, seed=4, max_degrees=79.0)
    found = bk.fit(
        bk.Measured.from_samples(wi, wo, factor * model.eval(wi, wo)), "ggx", loss="plain"
    )
    (note,) = [note for note in found.notes if "another unit than 1/sr" in note]
    assert said in note
    assert not any("AlbedoAtMost" in note for note in found.notes)
    assert found.message == "converged"
    assert found.values["alpha_u"] == pytest.approx(0.3, rel=1e-3)


@pytest.mark.quick
def test_marks_of_what_was_not_measured_are_told():
    wi, wo = draw_direction_pairs(300, seed=4, max_degrees=70.0)
    values = bk.models()["ggx"]().eval(wi, wo)
    values[::20] = -9999
    notes = bk.audit(bk.Measured.from_samples(wi, wo, values)).findings()
    assert any(" values are exactly -9999: probably a mark" in note for note in notes)


@pytest.mark.quick
def test_light_is_not_told_by_noise():
    """Where values are negative, what is interpolated between their logarithms is too low."""
    wi, wo = draw_direction_pairs(2_000, seed=6, max_degrees=75.0)
    truth = bk.models()["ggx"](diffuse_reflectance=0.02, alpha_u=0.25).eval(wi, wo)
    noise = np.random.default_rng(1).normal(0, 1, truth.shape)
    found = bk.fit(
        bk.Measured.from_samples(wi, wo, truth * (1 + 0.3 * noise) + 0.01 * noise), "ggx"
    )
    assert not any("where the measurement reflects" in note for note in found.notes)


def test_the_light_that_is_mended_is_the_light_that_is_told():
    """Not that of another angle, where a model that is too dark is left so."""
    notes = bk.fit(bk.load("red_plastic"), "ward").notes
    (said,) = [note for note in notes if note.startswith("by the loss alone")]
    assert "of the light at 5°" in said


def test_the_bootstrap_of_a_fit_that_keeps_its_light_keeps_it(measured_data):
    """Its intervals hold the fit; the profile of the loss alone, which would not, is refused."""
    data = bk.load(measured_data / "minidiff_paints" / "C2_Black.astm.xz")
    found = bk.fit(data, "ggx")
    assert any(note.startswith("by the loss alone") for note in found.notes)
    for name, interval in bk.uncertainty.bootstrap(found, data, draws=20).intervals(0.99).items():
        low, high = np.reshape(interval, (-1, 2)).T
        assert (low <= found.values[name]).all(), name
        assert (found.values[name] <= high).all(), name
    with pytest.raises(bk.BrdfkitError, match="searched again to have the albedo of its data"):
        bk.uncertainty.profile(found, data, parameter="alpha_u")
