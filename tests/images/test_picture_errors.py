"""Errors of pictures: metrics as published, within a mask; their noise floor, unbiased."""

import sys
from itertools import pairwise

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from brdfkit.core.colours import import_colour_package, to_srgb
from brdfkit.images.errors import compare_pictures
from brdfkit.images.errors.colour_difference import WHITE, ciede2000, delta_e_itp
from brdfkit.images.errors.flip import find_exposures, flip
from brdfkit.images.errors.metrics import METRICS, ssim
from brdfkit.images.errors.noise import Halves, estimate_samples
from brdfkit.images.errors.psnr import psnr
from brdfkit.rendering import render


@pytest.fixture
def rng():
    return np.random.default_rng(12)


@pytest.fixture
def scene(rng):
    """A picture with a gradient, texture and a highlight, and a disc that is its mask."""
    y, x = np.mgrid[:48, :48] / 48
    disc = (x - 0.5) ** 2 + (y - 0.4) ** 2 < 0.12
    picture = np.stack([x, 0.5 * y, 0.3 + 0 * x], axis=-1) * (0.8 + 0.2 * rng.random((48, 48, 1)))
    picture[10:16, 20:26] += 3.0
    return picture.astype(np.float32), disc


# -- metrics ----------------------------------------------------------------------------------


@pytest.mark.quick
def test_psnr_is_that_of_the_definition(rng):
    """Of noise with a known deviation; the mean of n squares is off by √(2/n), here 0.02 dB."""
    reference = np.full((128, 128, 3), 0.5)
    noisy = reference + 0.01 * rng.standard_normal(reference.shape)
    everywhere = np.full((128, 128), True)
    assert psnr(reference, noisy, everywhere) == pytest.approx(20 * np.log10(0.5 / 0.01), abs=0.1)
    assert psnr(reference, reference, everywhere) == np.inf
    brighter = reference.copy()
    brighter[0, 0] = 1e6  # a firefly is no peak
    assert psnr(brighter, brighter + 0.05) == pytest.approx(20)
    assert np.isnan(psnr(reference, noisy, ~everywhere))  # nothing of it is seen


@pytest.mark.quick
def test_errors_are_unknown_where_nothing_shows_the_material(scene):
    picture, disc = scene
    errors = compare_pictures({"a": picture, "b": 2 * picture}, picture, disc & False)
    assert np.isnan([*errors.by_name["b"].values(), *errors.floor.values()]).all()
    assert errors.notes == (
        "No pixel shows the material, which leaves all errors unknown: render it larger.",
    )
    assert errors.remarks == list(errors.notes)


@pytest.mark.quick
def test_ciede2000_is_as_published():
    """G. Sharma, W. Wu and E. N. Dalal, "The CIEDE2000 color-difference formula", Color Research
    and Application 30(1), 2005, Table 1, 1 and 25."""
    colour = import_colour_package()
    assert not np.get_printoptions()["legacy"]  # which its import sets
    lab = [
        [(50, 2.6772, -79.7751), (60.2574, -34.0099, 36.2677), (100, 0, 0), (50, 0, 0)],
        [(50, 0, -82.7485), (60.4626, -34.1751, 39.4387), (0, 0, 0), (50, 0, 0)],
    ]
    to_rgb = np.linalg.inv(colour.RGB_COLOURSPACES["sRGB"].matrix_RGB_to_XYZ)
    first, other = (colour.Lab_to_XYZ([row]) @ to_rgb.T for row in lab)
    np.testing.assert_allclose(ciede2000(first, other), [[2.0425, 1.2644, 100, 0]], atol=1e-4)


@pytest.mark.quick
def test_differences_are_those_of_colour_science(rng):
    """The package's, over dark, saturated, grey and bright colours, and those out of the gamut."""
    colour = import_colour_package()
    first = rng.random((4000, 3)) ** 3 * rng.choice([0.1, 1, 20], (4000, 1))
    other = first * (1 + rng.choice([0.01, 0.3, 3], (4000, 1)) * rng.standard_normal((4000, 3)))
    other[:500] = other[:500, :1]
    first[250:1000] = first[250:1000, :1]
    to_xyz = colour.RGB_COLOURSPACES["sRGB"].matrix_RGB_to_XYZ
    lab = [colour.XYZ_to_Lab(rgb @ to_xyz.T) for rgb in (first, other)]
    expected = colour.delta_E(*lab, method="CIE 2000")
    np.testing.assert_allclose(ciede2000(first, other), expected, atol=1e-9)
    shown = [WHITE * np.maximum(rgb, 0) @ to_xyz.T for rgb in (first, other)]
    expected = colour.difference.delta_E_ITP(*map(colour.XYZ_to_ICtCp, shown))
    np.testing.assert_allclose(delta_e_itp(first, other), expected, rtol=1e-5, atol=1e-4)


@pytest.mark.quick
def test_delta_e_itp_is_that_of_the_recommendations(rng):
    """ITU-R BT.2087 (primaries), BT.2100 (PQ, ICtCp) and BT.2124 (ΔE), written out."""
    to_2020 = [[0.6274, 0.3293, 0.0433], [0.0691, 0.9195, 0.0114], [0.0164, 0.0880, 0.8956]]
    to_lms = np.array([[1688, 2146, 262], [683, 2951, 462], [99, 309, 3688]]) / 4096
    to_itp = np.array([[2048, 2048, 0], [6610, -13613, 7003], [17933, -17390, -543]]) / 4096

    def itp(rgb):
        y = (203 * rgb @ np.transpose(to_2020) @ to_lms.T / 10_000) ** (2610 / 16384)
        pq = ((3424 / 4096 + 2413 / 128 * y) / (1 + 2392 / 128 * y)) ** (2523 / 32)
        return pq @ to_itp.T * (1, 0.5, 1)

    first, other = rng.random((2, 100, 3)) * (0.1, 1.0, 20.0)  # shadows to highlights
    expected = 720 * np.linalg.norm(itp(first) - itp(other), axis=-1)
    found = delta_e_itp(first, other)
    # the matrix above has four digits
    np.testing.assert_allclose(found, expected, rtol=0.01, atol=0.1)
    np.testing.assert_allclose(delta_e_itp(other, first), found, rtol=1e-12)
    assert delta_e_itp(first, first).max() == 0
    assert WHITE == 203


@pytest.mark.quick
def test_flip_is_nothing_for_equal_pictures_and_grows(scene):
    reference, mask = scene
    errors = [flip(reference, reference * (1 + d), mask) for d in (0, 0.1, 0.4)]
    assert errors[0] == 0
    assert all(b > 1.2 * a for a, b in pairwise(errors))
    assert errors[-1] < 1
    assert np.isnan(flip(0 * reference, reference, mask))


@pytest.mark.quick
def test_flip_is_not_diluted_by_what_is_between_the_pixels_that_count():
    grey = np.full((64, 64, 3), 0.3, np.float32)

    def squares(apart):
        mask = np.zeros((64, 64), bool)
        mask[:8, :8] = mask[apart : apart + 8, apart : apart + 8] = True
        return mask

    near, far = (flip(grey, 2 * grey, squares(apart)) for apart in (24, 56))
    assert far == pytest.approx(near, rel=0.05)


@pytest.mark.quick
def test_flip_has_the_exposures_of_its_authors(scene):
    """The package's own, where all pixels count and the brightest ones are equal."""
    evaluate = pytest.importorskip("flip_evaluator").evaluate
    picture = np.clip(scene[0], 0, 2)
    _, _, settings = evaluate(picture, picture, "HDR", applyMagma=False)
    start, stop = find_exposures(picture, np.full((48, 48), True))
    theirs = settings["startExposure"], settings["stopExposure"]
    assert (start, stop) == pytest.approx(theirs, abs=1e-4)
    dark = np.where(np.arange(48)[:, None, None] < 30, 0, picture)  # the median is black
    assert np.ptp(find_exposures(dark, np.full((48, 48), True))) == 8


@pytest.mark.quick
def test_ssim_is_that_of_the_paper(scene, rng):
    """By its definition, with a Gaussian window of σ = 1.5 over what is shown, on black."""
    reference, mask = scene
    picture = reference + np.float32(0.1) * rng.random(reference.shape, dtype=np.float32)
    x, y = (
        np.pad(to_srgb(p) * mask[..., None], ((9, 9), (9, 9), (0, 0))) for p in (reference, picture)
    )

    def mean(values):
        return gaussian_filter(values.astype(float), 1.5, truncate=3.5, axes=(0, 1))

    mx, my = mean(x), mean(y)
    covariance = mean(x * y) - mx * my
    variances = mean(x * x) - mx**2 + mean(y * y) - my**2
    similarity = (2 * mx * my + 1e-4) * (2 * covariance + 9e-4)
    similarity /= (mx**2 + my**2 + 1e-4) * (variances + 9e-4)
    expected = similarity[9:-9, 9:-9][mask].mean()
    assert ssim(reference, picture, mask) == pytest.approx(expected, abs=1e-6)
    assert ssim(reference, reference, mask) == pytest.approx(1, abs=1e-12)


@pytest.mark.quick
@pytest.mark.parametrize("key", METRICS)
def test_what_is_outside_the_mask_does_not_count(key, scene):
    reference, mask = scene
    picture = reference * np.float32(1.1)
    expected = METRICS[key].function(reference, picture, mask)
    for first, other in ((1e9, 0), (-5, np.nan), (np.inf, 7)):
        dirty = [np.where(mask[..., None], p, v) for p, v in ((reference, first), (picture, other))]
        assert METRICS[key].function(*dirty, mask) == expected
    full = METRICS[key].function(reference, picture, np.full(mask.shape, True))
    assert full != expected


# -- the table --------------------------------------------------------------------------------


@pytest.mark.quick
def test_a_difference_within_the_noise_is_none(scene, rng):
    reference, mask = scene
    noise = rng.standard_normal((2, *reference.shape)).astype(np.float32)
    pictures = {
        "it": reference,
        "same": reference,
        "nearly": reference + 0.005 * noise[0],
        "other": reference * np.float32(1.5),
    }
    errors = compare_pictures(pictures, reference + 0.01 * noise[1], mask)
    rows = {name: texts for name, *texts in errors.table()}
    assert list(rows) == ["same", "nearly", "other", "noise floor"]
    assert all(text.startswith("(") for text in rows["same"] + rows["nearly"])
    assert not any("(" in text for text in rows["other"] + rows["noise floor"])
    assert not errors.exceeds("nearly", "psnr")
    without_noise = compare_pictures({"it": reference, "same": reference}, reference, mask)
    assert all(text.startswith("(") for text in without_noise.table()[0][1:])
    assert errors.exceeds("other", "ssim")
    assert errors.by_name["same"]["psnr"] == np.inf
    assert list(errors.floor) == list(errors.by_name["other"]) == list(METRICS)
    lines = [line.strip() for line in str(errors).splitlines()]
    assert lines[0] == "Pictures beside that of it"
    assert lines[5].startswith("noise floor  ")
    assert lines[6].startswith("(...) is no difference: not above the noise floor")


@pytest.mark.quick
def test_what_is_unknown_is_said(scene):
    reference, mask = scene
    broken = reference.copy()
    broken[20, 24] = np.nan
    broken[0, 0] = np.nan  # outside the mask
    errors = compare_pictures({"it": reference, "off": reference * 2, "broken": broken}, None, mask)
    assert np.isnan([*errors.by_name["broken"].values(), *errors.floor.values()]).all()
    assert np.isfinite([*errors.by_name["off"].values()]).all()
    said = str(errors)
    assert "The noise floor needs two samples per pixel." in said
    assert "broken is not finite in 1 pixel," in said
    assert "none" not in said


@pytest.mark.quick
@pytest.mark.parametrize("absent", [["flip_evaluator"], ["flip_evaluator", "skimage.metrics"]])
def test_metrics_without_their_packages_are_left_out_in_a_sentence(scene, monkeypatch, absent):
    for module in absent:
        monkeypatch.setitem(sys.modules, module, None)
    reference, mask = scene
    errors = compare_pictures({"it": reference, "off": reference * 2}, reference, mask)
    left = [key for key in METRICS if key not in ["flip", "ssim"][: len(absent)]]
    assert list(errors.floor) == list(errors.by_name["off"]) == left
    assert len(errors.columns) == len(left) + 1
    install = "flip-evaluator and scikit-image" if absent[1:] else "flip-evaluator"
    assert f"install {install}: pip install 'brdfkit[metrics]'." in str(errors)


# -- noise ------------------------------------------------------------------------------------


@pytest.mark.quick
@pytest.mark.parametrize("passes", [(30, 30), (30, 30, 4), (32, 16, 8, 1)])
def test_the_noise_of_the_halves_is_that_of_two_seeds(passes, rng):
    """Of independent samples with σ = 1, equal halves or not: on average 2σ²/N.

    The mean of n = 10⁵ squares is off by √(2/n); beyond 4 of these is one chance in 16,000.
    """
    halves = Halves()
    for spp in passes:
        halves = halves.add_pass(rng.standard_normal(100_000) / np.sqrt(spp), spp)
    found = np.square(halves.other_seed - halves.picture).mean() * sum(passes) / 2
    assert abs(found - 1) < 4 * np.sqrt(2 / 100_000)


def test_the_floor_is_that_of_another_seed(llvm_variant):
    """Mean squared errors: estimated in each of 16 pictures, and between 8 pairs of them.

    |t| > 4 comes by chance once in 1,600 (22 degrees of freedom).
    """
    white = {"type": "diffuse", "reflectance": 0.8}
    pictures = [render(white, spp=16, size=16, seed=seed) for seed in range(16)]
    inside = [(p.pictures["diffuse"][p.mask], p.other_seed[p.mask]) for p in pictures]
    floors = [np.square(other - own).mean() for own, other in inside]
    true = [np.square(inside[k][0] - inside[k + 1][0]).mean() for k in range(0, 16, 2)]
    error = np.sqrt(np.var(floors, ddof=1) / 16 + np.var(true, ddof=1) / 8)
    assert abs(np.mean(floors) - np.mean(true)) < 4 * error
    assert error < 0.15 * np.mean(true)


@pytest.mark.quick
def test_twice_the_samples_give_three_decibels():
    assert estimate_samples(43, 40, 100) == pytest.approx(200, rel=0.01)
    assert estimate_samples(45, -np.inf, 100) > 1e99
