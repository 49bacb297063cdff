"""Filters of shadow maps: against their formulas, brute force, and each other where they agree."""

import drjit as dr
import mitsuba as mi
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shadow_scenes import half_plane, objects_on_a_ground, placement_of, seen_from

from brdfkit.core.errors import BrdfkitError
from brdfkit.shadows.comparison.quality import acne
from brdfkit.shadows.maps.filters import (
    bilinear_percentage_closer,
    exponential_variance,
    moment,
    percentage_closer,
    poisson_disk,
    variance,
)
from brdfkit.shadows.maps.light_shadow import LightShadow
from brdfkit.shadows.maps.map_point import AUTOMATIC, Bias, MapPoint
from brdfkit.shadows.maps.moments import bounds
from brdfkit.shadows.maps.moments.moving_depths import MovingDepths
from brdfkit.shadows.maps.techniques import FILES, find_settings

pytestmark = pytest.mark.usefixtures("llvm_variant")

FILTERS = sorted(FILES["filter"])


def at(u, v, depth, slope_u=0.0, slope_v=0.0):
    """The `MapPoint` of places of a map, without a scene."""
    numbers = (mi.Float(x) for x in (u, v, depth, slope_u, slope_v))
    return MapPoint(*numbers, active=mi.Bool(True), p=None, projection=None, half=None)


def random_depths(size=16, seed=1):
    return np.random.default_rng(seed).uniform(-0.5, 0.5, (size, size)).astype(np.float32)


def seen(depths, u, v):
    """The depths of texels by NumPy; beyond the map is nothing."""
    size = len(depths)
    column, row = np.floor(u).astype(int), np.floor(v).astype(int)
    within = (column >= 0) & (column < size) & (row >= 0) & (row < size)
    return np.where(within, depths[row.clip(0, size - 1), column.clip(0, size - 1)], np.inf)


# Comparisons


@pytest.mark.parametrize("width", [1, 3, 4])
def test_percentage_closer_is_the_mean_of_its_comparisons(width):
    depths, generator = random_depths(), np.random.default_rng(2)
    u, v = generator.uniform(-3, 19, (2, 500)).astype(np.float32)
    depth, (a, b) = generator.uniform(-0.5, 0.5, 500), generator.uniform(-0.1, 0.1, (2, 500))
    expected = np.zeros(500)
    for i, j in np.ndindex(width, width):
        s = np.floor(u - (width - 1) / 2) + i + 0.5
        t = np.floor(v - (width - 1) / 2) + j + 0.5
        expected += depth + a * (s - u) + b * (t - v) <= seen(depths, s, t)
    lookup = percentage_closer.Lookup(mi.TensorXf(depths), width)
    found = np.array(lookup.visibility(at(u, v, depth, a, b)))
    assert np.abs(found - expected / width**2).max() < 1e-5


def test_bilinear_percentage_closer_of_three_texels():
    """[Ergun 2008, 2.2.1.3]: four bilinear interpolations of 3 × 3 comparisons, and their mean."""
    generator = np.random.default_rng(3)
    B = generator.integers(0, 2, (200, 3, 3))
    fx, fy = generator.random((2, 200))
    C = (1 - fx)[:, None, None] * B[:, :, :2] + fx[:, None, None] * B[:, :, 1:]
    D = (1 - fy)[:, None, None] * C[:, :2] + fy[:, None, None] * C[:, 1:]
    rows = mi.TensorXf(B.transpose(1, 0, 2).reshape(3, 600).astype(np.float32))
    wide = dr.concat([rows, dr.zeros(mi.TensorXf, (597, 600))])  # a square map, three rows used
    lookup = bilinear_percentage_closer.Lookup(wide, 3)
    found = np.array(lookup.visibility(at(3 * np.arange(200) + 1 + fx, 1 + fy, 0.5)))
    assert np.abs(found - D.mean(axis=(1, 2))).max() < 1e-4  # places are rounded at 600 texels


@pytest.mark.quick
def test_bilinear_weights():
    lookup = bilinear_percentage_closer.Lookup(mi.TensorXf(random_depths()), 3)
    assert lookup.window_weights(0.0) == [0.5, 0.5, 0.0]
    assert np.allclose(lookup.window_weights(0.3), [0.35, 0.5, 0.15])


def test_poisson_disk():
    taps = poisson_disk.draw_taps()
    apart = np.linalg.norm(taps[:, None] - taps, axis=2) + 9 * np.eye(12)
    assert len(taps) == 12
    assert apart.min() >= 0.5
    assert np.linalg.norm(taps, axis=1).max() <= 1
    depths, generator = random_depths(), np.random.default_rng(4)
    u, v = generator.uniform(-3, 19, (2, 500)).astype(np.float32)
    radius = 2.5 * (1 - 0.7 * v / 16)
    expected = np.mean(
        [seen(depths, u + radius * x, v + radius * y) >= 0.1 for x, y in taps], axis=0
    )
    lookup = poisson_disk.Lookup(mi.TensorXf(depths), 2.5, 0.7)
    wrong = np.abs(np.array(lookup.visibility(at(u, v, 0.1))) - expected) > 1e-5
    assert wrong.sum() <= 1  # a tap may be rounded to the next texel


# Moments


@pytest.mark.quick
def test_two_planes_of_the_thesis():
    """[Ergun 2008, 2.2.1.4]: d₁ = 1, d₂ = 2, p = 0.25."""
    assert bounds.bound_by_two_moments(1.25, 1.75, 2.0) == pytest.approx(0.25, abs=1e-12)
    assert bounds.bound_by_two_moments(1.25, 1.75, 1.25) == 1


@pytest.mark.parametrize(
    ("lookup", "settings", "tolerance"),
    [
        (variance.Lookup, {"least_deviation": 0.0}, 1e-4),
        (exponential_variance.Lookup, {"exponent": 20.0, "negative_exponent": 5.0}, 1e-3),
        (exponential_variance.Lookup, {"exponent": 20.0, "negative_exponent": 0.0}, 1e-3),
        (moment.Lookup, {"rounding": 1e-6}, 1e-3),
    ],
)
def test_of_one_plane_above_another_moments_are_percentage_closer(lookup, settings, tolerance):
    near = np.random.default_rng(5).random((32, 32)) < 0.4
    depths = mi.TensorXf(np.where(near, -0.3, 0.4).astype(np.float32))
    u, v = (np.mgrid[3:29, 3:29] + 0.5).reshape(2, -1)
    point = at(u, v, 0.4)
    expected = np.array(percentage_closer.Lookup(depths, 5).visibility(point))
    found = np.array(
        lookup(MovingDepths(depths), blur=2, bleeding=0.0, **settings).visibility(point)
    )
    assert np.abs(found - expected).max() < tolerance


def moments(values, weights, powers):
    return [(weights * values**k).sum(axis=0) for k in powers]


@pytest.mark.parametrize(("depths", "anywhere"), [(2, True), (2, False), (3, False)])
def test_four_moments_know_two_depths_and_three_with_the_receiver(depths, anywhere):
    generator = np.random.default_rng(6)
    z = np.sort(generator.uniform(-1, 1, (depths, 2000)), axis=0)
    weights = generator.dirichlet(np.ones(depths), 2000).T
    t = generator.uniform(-1, 1, 2000) if anywhere else z[-1]
    b = [dr.llvm.Float64(x) for x in moments(z, weights, range(1, 5))]
    found = np.array(bounds.bound_by_four_moments(b, dr.llvm.Float64(t), 1e-13))
    close = np.abs(z - t).min(axis=0) < 1e-3  # where the bound may jump
    wrong = np.abs(found - (weights * (z >= t)).sum(axis=0)) > 1e-4
    assert wrong[~close | (not anywhere)].mean() < 0.005  # depths that nearly coincide


@given(
    st.lists(st.tuples(st.floats(-1, 1), st.floats(0.01, 1)), min_size=1, max_size=6),
    st.floats(-1, 1),
)
def test_no_bound_is_darker_than_what_it_bounds(distribution, t):
    z, weights = np.array(distribution).T
    weights = weights / weights.sum()
    lit = weights[z >= t].sum()
    T = dr.scalar.ArrayXf64
    b = [T(m) for m in moments(z, weights, range(1, 5))]
    assert bounds.bound_by_two_moments(b[0], b[1], T(t), 1e-14)[0] > lit - 1e-6
    assert bounds.bound_by_four_moments(b, T(t), 1e-7)[0] > lit - 1e-3
    for warped in (np.exp(5 * z), -np.exp(-5 * z)):
        m, s = (T(x) for x in moments(warped, weights, (1, 2)))
        own = np.exp(5 * t) if warped[0] > 0 else -np.exp(-5 * t)
        assert bounds.bound_by_two_moments(m, s, T(own), 1e-9 * own**2)[0] > lit - 1e-6


def test_bleeding_is_cut_off():
    """Two occluders behind each other: the farther one's shadow, dark by comparisons."""
    depths = MovingDepths(mi.TensorXf(np.tile(np.float32([-0.9, 0.3]), (8, 4))))
    how = {"blur": 1, "least_deviation": 0.0}
    leaks = variance.Lookup(depths, bleeding=0.0, **how).visibility(at(4.0, 4.5, 0.4))[0]
    assert 0.2 < leaks < 0.8
    assert (
        variance.Lookup(depths, bleeding=leaks + 0.01, **how).visibility(at(4.0, 4.5, 0.4))[0] == 0
    )
    assert variance.Lookup(depths, bleeding=0.9, **how).visibility(at(4.0, 4.5, -0.9))[0] == 1


# In scenes


@pytest.mark.parametrize("kind", ["directional", "point"])
def test_the_penumbra_of_a_half_plane(kind):
    """w = w_light (d_r - d_b) / d_b, and in it the share of a disk that a straight edge leaves."""
    scene, placement, x, n, light_size, w = half_plane(kind)
    shadow = LightShadow(
        scene, placement, filter="percentage_closer_soft", light_size=light_size, taps=64
    )
    found = np.array(shadow.visibility(mi.Point3f(mi.Float(x * w), 0, 0), mi.Normal3f(*n)))
    s = (2 * x).clip(-1, 1)
    disk = 0.5 + (np.arcsin(s) + s * np.sqrt(1 - s * s)) / np.pi
    assert np.abs(found - disk).max() < 0.04
    assert np.all(found[np.abs(x) > 0.52] == disk[np.abs(x) > 0.52])


def test_a_projective_texture_shadows_no_object_by_itself():
    scene = objects_on_a_ground("directional")
    si, facing, lit = seen_from(scene)
    shadow = LightShadow(scene, placement_of(scene), filter="projective_texture", resolution=256)
    found = np.array(shadow.visibility(si.p, si.n)) > 0.5
    ground = np.array(si.p.z) < 1e-3
    away = np.array(si.is_valid()) & ~ground
    assert found[away & ~facing].mean() > 0.97  # the dark sides of the objects themselves
    assert (found != lit)[facing & ground].mean() < 0.01


def peter_panning(found, lit, facing, gap, contact):
    """The share of light that pixels in a shadow have, next to what casts it.

    gap : (height, width), from each pixel to its occluder along the ray of light.
    contact : the largest gap that is looked at.
    """
    where = facing & ~lit & (gap <= contact)
    return float(found[where].mean()) if where.any() else 0.0


@pytest.mark.parametrize("name", FILTERS)
def test_the_automatic_bias_leaves_no_acne_in_grazing_light(name):
    scene = objects_on_a_ground([1, -0.5, -0.12])
    si, facing, lit, gap = seen_from(scene, with_gap=True)
    shadow = LightShadow(scene, placement_of(scene), filter=name, resolution=512)
    found = np.array(shadow.visibility(si.p, si.n))
    picture = [a.reshape(128, 128) for a in (found, lit, facing)]
    assert acne(*picture, margin=6) < 0.003
    assert peter_panning(*picture, gap.reshape(128, 128), contact=3.0) < 0.05


@pytest.mark.parametrize(
    ("bias", "worse"),
    [
        (Bias(), "acne"),
        (Bias(constant=0.05), "panning"),
        (Bias(slope=8.0), "panning"),
        (Bias(normal_offset=12.0), "acne"),  # points beside an object are moved into its shadow
    ],
)
def test_what_a_wrong_bias_does(bias, worse):
    scene = objects_on_a_ground([1, -0.5, -0.3])
    si, facing, lit, gap = seen_from(scene, with_gap=True)

    def errors(bias):
        shadow = LightShadow(scene, placement_of(scene), resolution=256, bias=bias)
        picture = [
            a.reshape(128, 128) for a in (np.array(shadow.visibility(si.p, si.n)), lit, facing)
        ]
        panning = peter_panning(*picture, gap.reshape(128, 128), contact=0.6)
        return {"acne": acne(*picture, margin=4), "panning": panning}

    wrong, right = errors(bias)[worse], errors(AUTOMATIC)[worse]
    assert wrong > right + 0.03


# Derivatives


def test_derivatives_know_of_edges_that_move():
    """By the place of a cube, of what a soft patch of ground receives; and finite differences."""
    scene = objects_on_a_ground("point")
    placement, parameters = placement_of(scene), mi.traverse(scene)
    corners = mi.Float(parameters["cube.vertex_positions"])
    x, y = np.meshgrid(np.linspace(0, 4, 128), np.linspace(-2, 2, 128))
    p = mi.Point3f(mi.Float(x.ravel()), mi.Float(y.ravel()), 0)
    weight = mi.Float(np.exp(-4 * ((x - 2.6) ** 2 + (y - 0.4) ** 2)).ravel() / x.size)

    def received(way):
        moved = dr.unravel(mi.Point3f, corners) + mi.Vector3f(way, 0.5 * way, 0.3 * way)
        parameters["cube.vertex_positions"] = dr.ravel(moved)
        parameters.update()
        shadow = LightShadow(scene, placement, filter="moment", resolution=512)
        return dr.sum(shadow.visibility(p, mi.Normal3f(0, 0, 1)) * weight)

    way = mi.Float(0)
    dr.enable_grad(way)
    found = received(way)
    dr.backward(found)
    step = 0.04
    forth, back = received(mi.Float(step)), received(mi.Float(-step))
    assert found[0] == pytest.approx(received(mi.Float(0))[0], rel=1e-5)
    assert dr.grad(way)[0] == pytest.approx((forth - back)[0] / (2 * step), rel=0.05)


def test_the_derivative_of_a_picture_by_a_sheet_that_moves():
    """Of a matte ground under the sun, of which the sheet covers more: -ρ E / π over the width."""
    scene, *_ = half_plane("directional")
    parameters = mi.traverse(scene)
    wide = 2 * np.tan(np.radians(25))
    way = mi.Float(0.013)
    dr.enable_grad(way)
    moved = mi.Transform4f().translate(mi.Vector3f(way, 0, 0)).rotate([0, 0, 1], 20)
    parameters["sheet.to_world"] = moved @ parameters["sheet.to_world"]
    parameters.update()
    integrator = mi.load_dict(
        {"type": "shadow_map", "filter": "exponential_variance", "resolution": 128}
    )
    dr.backward(dr.mean(mi.render(scene, parameters, integrator=integrator, spp=1024)))
    assert dr.grad(way)[0] == pytest.approx(-0.5 / np.pi / wide, rel=0.05)


# Settings


@pytest.mark.quick
def test_a_name_means_the_same_in_every_file():
    known = {}
    for kind, files in FILES.items():
        for file in files:
            for name, setting in find_settings(kind, file).items():
                assert known.setdefault(name, setting) is setting, name


@pytest.mark.quick
@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"filter": "varianze"}, "no filter 'varianze'; did you mean variance"),
        ({"filter": "variance", "widht": 3}, "no setting 'widht'; .* blur, bleeding"),
        ({"filter": "percentage_closer", "width": 0}, "width = 0 should be a number between 1"),
    ],
)
def test_wrong_settings_are_one_sentence(settings, said):
    with pytest.raises(BrdfkitError, match=said):
        LightShadow(None, None, **settings)
