"""The conformance set of volumes: its exact pictures are exact, and brdfkit's are near them."""

import importlib

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, trapezoid
from volume_programs import by_brdfkit
from volume_programs.case import BEHIND, FOLDER, INDEX, NAMES, PIXELS, Case

from brdfkit.volumes import Volume

ROW = 21  # through everything
SOME = np.s_[ROW : ROW + 1, ::4]  # of the pixels
SHARP = "step", "layer", "labels"  # whose functions or values jump, or nearly so


@pytest.fixture(scope="module")
def make():
    """The program that makes the set, as a module."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(FOLDER)
        return importlib.import_module("make")


# The exact pictures


@pytest.mark.parametrize("name", NAMES)
def test_the_files_are_what_the_program_makes(make, name):
    """Of some pixels of a row; and twice the nodes change nothing."""
    voxels, told = make.CASES[name]()
    np.testing.assert_array_equal(Case(name).voxels, voxels)
    assert INDEX[name] == {"what": make.CASES[name].__doc__} | told
    some = make.picture(voxels, told, SOME)
    np.testing.assert_allclose(Case(name).exact[SOME], some, atol=1e-6)
    twice = make.picture(voxels, told, SOME, nodes=2 * make.exact.NODES)
    np.testing.assert_allclose(twice, some, atol=1e-9)


@pytest.mark.quick
def test_a_ramp_has_the_opacity_of_its_mean():
    """The clamped halves of the outermost voxels add and take away the same."""
    x = Case("ramp").rays[0].reshape(PIXELS, PIXELS, 3)[ROW, :, 0]
    last = 15 / 16  # the outermost centre
    steepness = 0.65 + 0.35 * np.clip(x, -last, last)
    opacity = np.where(np.abs(x) < 1, -np.expm1(-2 * steepness), 0)
    np.testing.assert_allclose(Case("ramp").exact[ROW, :, 3], opacity, atol=1e-6)


@pytest.mark.parametrize("name", ["ball", "anisotropic", "opacity"])
def test_a_ray_in_small_steps(name):
    """L = ∫ T RGB σ_t ds by 40,000 trapezoids, on brdfkit's own volume: another way altogether."""
    case = Case(name)
    pixel = 22, 27
    o, d = (x.reshape(PIXELS, PIXELS, 3)[pixel] for x in case.rays)
    to_world = np.diag([*case.spacing, 1])
    to_world[:3, 3] = case.spacing / 2 - 1
    s = np.linspace(3.5, 6.5, 40_001)  # in the box, or where nothing is
    values = Volume(case.voxels, to_world)(o + s[:, None] * d)
    r, g, b, a = (np.interp(values, case.values, column) for column in case.rgba.T)
    if "opacity_unit_distance" in case.transfer:
        sigma = -np.log1p(-a) / case.transfer["opacity_unit_distance"]
    else:
        sigma = a * case.transfer["extinction"]
    t = np.exp(-cumulative_trapezoid(sigma, s, initial=0))
    rgb = [trapezoid(t * sigma * c, s) + t[-1] * BEHIND for c in (r, g, b)]
    np.testing.assert_allclose(case.exact[pixel], [*rgb, 1 - t[-1]], atol=1e-6)


@pytest.mark.quick
def test_a_maximum_by_many_samples(make):
    case = Case("maximum")
    grid, (o, d) = (
        make.grid_of(case.voxels, case.entry),
        (x[ROW * PIXELS :][:PIXELS] for x in case.rays),
    )
    lines = make.exact.Rays(o, d[0])
    t = np.linspace(3, 7, 4001)
    points = lines(np.broadcast_to(t, (PIXELS, len(t))))
    inside = (np.abs(points) < 1).all(axis=-1)
    sampled = np.where(inside, grid(points), 0).max(axis=1)
    largest = np.nan_to_num(make.exact.largest(grid, lines))
    assert (largest >= sampled - 1e-12).all()
    np.testing.assert_allclose(largest, sampled, atol=1e-3)


@pytest.mark.quick
def test_a_saddle_by_its_roots(make):
    """z + xy / 2 = 0 along rays: a parabola, met once from above; no ray is near the faces."""
    case = Case("saddle")
    origins, d = case.rays[0][::97], case.view_axes[0]
    found = make.exact.first_above(
        make.grid_of(case.voxels, case.entry), make.exact.Rays(origins, d), 0
    )
    for o, t in zip(origins, found, strict=True):
        roots = np.roots(
            [d[0] * d[1] / 2, d[2] + (o[0] * d[1] + o[1] * d[0]) / 2, o[2] + o[0] * o[1] / 2]
        )
        assert np.abs(roots - t).min() < 1e-9
        assert np.abs(o + t * d).max() < 15 / 16 - 1 / 8  # nor are the differences of its gradient


# brdfkit's


@pytest.mark.parametrize("name", NAMES)
def test_brdfkit_draws_the_exact_picture(llvm_variant, name):
    """In 2048 steps: to 2e-4 in the root mean square and 1e-4 in all pixels, or 2e-3 at jumps."""
    case = Case(name)
    difference = (by_brdfkit.draw_case(case, "careful") - case.exact)[..., :3]
    assert np.sqrt(np.mean(difference**2)) < 2e-4
    assert np.abs(difference).max() < (2e-3 if name in SHARP else 1e-4)


@pytest.mark.parametrize("name", ["ball", *SHARP])
def test_the_default_steps_are_enough(llvm_variant, name):
    """To 2e-3 in the root mean square, and 2e-2 in all pixels: for a thin layer, too."""
    case = Case(name)
    difference = (by_brdfkit.draw_case(case, "defaults") - case.exact)[..., :3]
    assert np.sqrt(np.mean(difference**2)) < 2e-3
    assert np.abs(difference).max() < 2e-2


def test_too_few_steps_are_seen(llvm_variant):
    """Tissues, labels, of which a step crosses two: the set tells."""
    case = Case("labels")
    difference = (by_brdfkit.draw_case(case, "defaults") - case.exact)[..., :3]
    assert np.abs(difference).max() > 0.01
