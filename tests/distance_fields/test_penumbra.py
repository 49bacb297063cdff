"""Single-ray soft shadows: their error bounds, the digest's figures, derivatives, and the truth."""

import drjit as dr
import numpy as np
import pytest
from brdfkit.theses.balint2019.dense import compute_dense_shadow
from brdfkit.theses.balint2019.rivals import aaltonen, base, discrete, invert_tau, quilez
from scipy.integrate import quad

import brdfkit as bk
from brdfkit import distance_fields as df
from brdfkit.core.jit import llvm
from brdfkit.distance_fields.shadows import LightCone, find_edge, make_light_cone, soft_shadow
from brdfkit.distance_fields.shadows.field import split_into_pieces
from brdfkit.distance_fields.shadows.marches import compute_convex_shadow, compute_linear_shadow
from brdfkit.distance_fields.shadows.monte_carlo import (
    compute_monte_carlo_shadow,
    halton_points_in_disc,
    trace_ray,
)
from brdfkit.distance_fields.shadows.split import cell_centres, compute_split_shadow
from brdfkit.distance_fields.shadows.tau import lit_disc_share, lit_disc_slope

if llvm.find_loaded_version() < llvm.OLDEST:
    pytest.skip("needs LLVM", allow_module_level=True)

from drjit.llvm.ad import Array3f64 as P
from drjit.llvm.ad import Float64 as Float

# Fields of the tests: exact signed distances of convex objects, whose parameters may be arrays


class Field:
    is_convex = True

    def __or__(self, other):
        return Union(self, other)


class Sphere(Field):
    def __init__(self, centre, radius):
        self.centre, self.radius = centre, radius

    def distance(self, p):
        return dr.norm(p - self.centre) - self.radius


class HalfSpace(Field):
    def __init__(self, normal, height):
        self.normal, self.height = normal, height

    def distance(self, p):
        return dr.dot(p, self.normal) - self.height


class Box(Field):
    def __init__(self, centre, half):
        self.centre, self.half = centre, half

    def distance(self, p):
        q = dr.abs(p - self.centre) - self.half
        return dr.safe_sqrt(dr.squared_norm(dr.maximum(q, 0))) + dr.minimum(dr.max(q), 0)


class Union(Field):
    kind, is_sharp, is_convex = "union", True, False

    def __init__(self, *children):
        self.children = children

    def distance(self, p):
        first, *others = (child.distance(p) for child in self.children)
        for other in others:
            first = dr.minimum(first, other)
        return first


CONE = LightCone(P(0, 0, 0), P(0, 0, 1), Float(6), Float(0.02), Float(1))
SPHERE = Sphere(P(0.35, 0, 2.5), 0.3)


def random_cones(rng, n):
    """n cones towards random lights, from near the origin."""
    start = vectors(rng.normal(0, 0.1, (n, 3)))
    light = vectors(rng.normal((0, 0, 6), 0.3, (n, 3)))
    radius, ball = rng.choice([0.0, 0.2, 1.0, 2.0, 4.0], n), rng.uniform(0.005, 0.05, n)
    return make_light_cone(start, light, Float(radius), Float(ball))


def random_spheres(rng, n):
    centre = np.column_stack([rng.normal(0, 0.7, (n, 2)), rng.uniform(0.5, 6, n)])
    return Sphere(vectors(centre), Float(rng.uniform(0.02, 1, n)))


def random_boxes(rng, n):
    centre = np.column_stack([rng.normal(0, 0.7, (n, 2)), rng.uniform(0.5, 6, n)])
    return Box(vectors(centre), vectors(rng.uniform(0.02, 1, (n, 3))))


def vectors(values):
    return P(*(Float(np.ascontiguousarray(column)) for column in values.T))


# τ


@pytest.mark.quick
def test_tau_has_its_check_values():
    found = [float(f"{lit_disc_share(r):.9f}") for r in (0.0, 0.25, 0.5, 0.75, 0.9)]
    assert found == [0.5, 0.657481179, 0.804498891, 0.927853194, 0.981306963]
    found = [float(f"{invert_tau(m):.9f}") for m in (0.75, 0.9, 0.95, 1 - 1 / 30, 1 - 1 / 256)]
    assert found == [0.403972753, 0.687048826, 0.805383637, 0.852215275, 0.965019008]


@pytest.mark.quick
def test_tau_is_the_area_of_a_disc_beside_a_line():
    for r in (-0.9, -0.2, 0.6):
        area, _ = quad(lambda x: 2 * np.sqrt(1 - x * x), -1, r)
        assert lit_disc_share(r) == pytest.approx(area / np.pi, abs=1e-8)
        assert lit_disc_share(-r) == pytest.approx(1 - lit_disc_share(r), abs=1e-8)
        assert invert_tau(lit_disc_share(r)) == pytest.approx(r, abs=1e-8)
    assert [lit_disc_share(r) for r in (-3.0, 3.0)] == [0, 1]
    assert [invert_tau(m) for m in (-0.1, 1.1)] == pytest.approx([-1, 1])


@pytest.mark.quick
def test_tau_has_finite_derivatives_everywhere():
    r = Float(-2, -1, -0.5, 0, 0.7, 1, 2)
    dr.enable_grad(r)
    dr.backward(lit_disc_share(r))
    assert np.allclose(dr.grad(r), 2 / np.pi * np.sqrt([0, 0, 0.75, 1, 0.51, 0, 0]))
    assert float(f"{lit_disc_slope(0.0):.9f}") == round(2 / np.pi, 9)


# The cone


@pytest.mark.quick
def test_a_cone_touches_both_balls():
    cone = make_light_cone(P(0, 0, 0), P(3, 0, 4), 1.2, 0.1)
    # From a centre to the line through the two rims, which lies at R cos α
    cos = 1 / np.sqrt(1 + cone.tan[0] ** 2)
    assert cone.R_0[0] * cos == pytest.approx(0.1)
    assert cone.R_1[0] * cos == pytest.approx(1.2)
    assert cone.tan[0] * cos == pytest.approx(1.1 / 5)
    back = cone.make_reversed()
    assert np.allclose(back.point(back.d), 0)
    assert np.allclose(back.radius(2.0), cone.radius(3.0))
    x, y = cone.project_to_disc(cone.disc_point(Float(2), Float(0.3), Float(-0.4)))
    assert (x[0], y[0]) == pytest.approx((0.3, -0.4))


def test_a_light_about_the_point_is_a_wide_cone():
    inside = make_light_cone(P(0, 0, 0), P(0, 0, 0.5), 2.0, 0.1)
    assert np.isfinite(inside.R_1).all()
    assert compute_linear_shadow(Sphere(P(0, 0, 50), 1.0), inside).visible[0] == 1


# Check values; those of steps are in test_reproduce_balint2019.py


def random_rays_to_light():
    """Rays (n, 3) from the origin, uniform over the solid angle of `CONE`'s light; their lengths.

    Drawn in a cube and kept where they meet the light: a sphere about (0, 0, 6).
    """
    tangent = (1 - 0.02) / 6
    radius = 1 / np.hypot(1, tangent)
    d = np.random.default_rng(0).uniform((-0.2, -0.2, 0.9), (0.2, 0.2, 1), (2_000_000, 3))
    length = np.linalg.norm(d, axis=1)
    d = d[(length > 0.95) & (length < 1)] / length[(length > 0.95) & (length < 1), None]
    under = 36 * d[:, 2] ** 2 - 36 + radius**2
    return d[under > 0], 6 * d[under > 0, 2] - np.sqrt(under[under > 0])


def test_the_reference_is_the_share_of_rays_from_the_point_itself():
    """By the closed forms of a ball and of a plane that goes through the cone's apex."""
    d, length = random_rays_to_light()
    along = d @ (0.35, 0, 2.5)
    behind_ball = (along < length) & (along**2 > 0.35**2 + 2.5**2 - 0.3**2)
    sin = 0.3 * float(CONE.tan[0])
    normal, height = np.array([np.sqrt(1 - sin**2), 0, sin]), -sin * 0.02 / float(CONE.tan[0])
    behind_plane = d @ normal * length < height
    for field, behind in (
        (SPHERE, behind_ball),
        (HalfSpace(P(*normal.tolist()), height), behind_plane),
    ):
        found = compute_monte_carlo_shadow(field, CONE, 20_000, hit=1e-5).visible[0]
        assert found == pytest.approx(1 - behind.mean(), abs=2e-3)


def test_a_sphere_has_its_printed_minimum():
    found = compute_dense_shadow(SPHERE, CONE)
    assert f"{found.r[0]:.6f} {found.visible[0]:.6f}" == "0.116583 0.574051"
    assert found.t[0] == pytest.approx(2.50667, abs=6 / 2000)


def test_a_half_space_through_the_apex_has_the_share_tau():
    r = 0.3
    tan = float(CONE.tan[0])
    sin = r * tan
    plane = HalfSpace(P(float(np.sqrt(1 - sin**2)), 0, sin), -sin * 0.02 / tan)
    for direction in "AB":
        for method in (base, compute_linear_shadow, compute_convex_shadow):
            share = method(plane, CONE, 1 / 30, direction).visible[0]
            assert f"{share:.6f}" == f"{lit_disc_share(r):.6f}" == "0.688081"
        assert f"{discrete(plane, CONE, 1 / 30, direction).visible[0]:.6f}" == "0.666667"
    truth = lit_disc_share(r / np.sqrt(1 - sin**2))
    assert f"{truth:.6f}" == "0.688300"
    found = find_edge(plane, CONE, compute_linear_shadow(plane, CONE))
    assert lit_disc_share(found.offset[0]) == pytest.approx(truth, abs=1e-9)


# The error bound: 0 ≤ m - τ(r_min) ≤ ε over thousands of scenes


@pytest.mark.parametrize("direction", "AB")
@pytest.mark.parametrize("n", [10, 30, 256])
@pytest.mark.parametrize("method", [base, compute_linear_shadow, compute_convex_shadow, discrete])
def test_the_error_is_within_epsilon(method, n, direction):
    rng = np.random.default_rng(n)
    many = 2000 if n < 256 else 500
    field = random_spheres(rng, many) | random_boxes(rng, many) | HalfSpace(P(0, 0, 1), -0.2)
    cone = random_cones(rng, many)
    found = method(field, cone, 1 / n, direction)
    error = n * (
        np.array(found.visible) - np.array(compute_dense_shadow(field, cone, 1000).visible)
    )
    low, rounding = (-1 if method is discrete else 0), 2e-5 * n  # of the dense search
    assert (error >= low - rounding).all()
    assert (error <= 1 + rounding).all()
    most = np.array((cone if direction == "A" else cone.make_reversed()).bound_step_count(1 / n))
    assert (np.array(found.evaluations) < most).all()


def test_a_field_that_is_steeper_than_a_distance_keeps_the_bound():
    rng = np.random.default_rng(0)

    class Steep(Field):
        is_convex, lipschitz, inner = False, 3.0, random_spheres(rng, 1000)

        def distance(self, p):
            return 3 * self.inner.distance(p)

    cone = random_cones(rng, 1000)
    error = np.array(compute_linear_shadow(Steep(), cone, 1 / 10).visible) - np.array(
        compute_dense_shadow(Steep(), cone).visible
    )
    assert ((error >= -1e-4) & (error <= 0.1)).all()


# How the methods stand to each other, and to the truth


def test_variants_need_evaluations_in_the_order_of_the_thesis():
    rng = np.random.default_rng(1)
    cone, field = random_cones(rng, 500), random_spheres(rng, 500)
    needed = {
        m: np.mean(m(field, cone, 1 / 30).evaluations)
        for m in (compute_linear_shadow, base, discrete, compute_convex_shadow)
    }
    assert needed[compute_convex_shadow] < 0.7 * needed[compute_linear_shadow]
    assert needed[discrete] < needed[base] < needed[compute_linear_shadow] < 1.4 * needed[base]


def test_rivals_darken_the_inner_half_of_the_penumbra():
    s = np.linspace(-0.95, 0.95, 39)
    plane = HalfSpace(P(1, 0, 0), Float(-s * np.array(CONE.radius(3.0))))
    slab = Slab(plane, 3.0)
    truth = np.array(compute_monte_carlo_shadow(slab, CONE, 500).visible)
    for rival in (quilez, aaltonen):
        share = np.array(rival(slab, CONE).visible)
        assert share[s < -0.1].max() == 0
        assert np.abs(share - truth).max() > 0.4
    assert np.abs(np.array(compute_linear_shadow(slab, CONE).visible) - truth).max() < 0.1


class Slab(Field):
    """What of a convex object lies within half a unit of the plane z = height."""

    def __init__(self, inner, height):
        self.inner, self.height = inner, height

    def distance(self, p):
        return dr.maximum(self.inner.distance(p), dr.abs(p.z - self.height) - 0.5)


def two_walls():
    """Two walls that leave no gap, one behind the other: Fig. 6.19, a leak of light."""
    return Box(P(-3, 0, 2), P(3.05, 9, 0.5)) | Box(P(3, 0, 4), P(3.05, 9, 0.5))


OCCLUDERS = {  # with the share of the model's error that `split` may keep
    "two": (two_walls(), 0.3),
    "corner": (Box(P(1, 1, 3), P(1.1, 1.1, 0.3)), 0.4),
    "sphere": (SPHERE, 0.3),
    "rod": (Box(P(0.1, 0, 3), P(0.1, 9, 0.1)), 0.5),
}


@pytest.mark.parametrize("name", OCCLUDERS)
def test_split_sees_several_small_and_pointed_occluders(name):
    field, kept = OCCLUDERS[name]
    truth = compute_monte_carlo_shadow(field, CONE, 5000).visible[0]
    model = compute_linear_shadow(field, CONE, 1 / 30).visible[0] - truth
    assert abs(model) > 0.1
    for direction in "AB":
        assert abs(
            compute_split_shadow(field, CONE, 1 / 10, direction).visible[0] - truth
        ) < kept * abs(model)


@pytest.mark.quick
def test_cells_are_of_equal_area_about_the_centre():
    for rings in (1, 2, 3):
        places = np.array(cell_centres(rings))
        assert len(places) == 1 + 3 * rings * (rings + 1)
        assert np.allclose(places.mean(axis=0), 0)
        # Second moments: those of the disc, less those of discs as large as the cells
        assert (places**2).sum(axis=1).mean() == pytest.approx(0.5 - 0.5 / len(places), rel=0.02)


def test_the_hard_shadow_is_as_wide_as_the_ball():
    x = np.linspace(-0.1, 0.1, 81)
    wall = Box(P(-5, 0, 0.5), P(5, 5, 0.2))
    share = soft_shadow(
        wall, P(Float(x), 0, 0), P(Float(x), 0, 9), 0.0, 0.02, shadow="hard"
    ).visible
    share = np.array(share)
    assert (share[x < -0.02] < 0.05).all()
    assert (share[x > 0.02] == 1).all()
    assert np.ptp(x[(share > 0.1) & (share < 0.9)]) > 0.01


# P8 and P9: samples of a light decided by arithmetic


def test_samples_of_a_rectangle_are_seen_as_rays_see_them():
    rng = np.random.default_rng(0)
    u, v = rng.uniform(-1, 1, (2, 5000))
    wall = Box(P(-3.1, 0, 3), P(3, 9, 0.2))
    cone = make_light_cone(P(0, 0, 0), P(0, 0, 6), np.hypot(0.8, 0.4), 0.02)
    found = find_edge(wall, cone, compute_linear_shadow(wall, cone, 1 / 100))
    on_light = P(Float(0.8 * u), Float(0.4 * v), 6)
    seen = np.array(found.is_point_visible(cone, on_light))
    room, _ = trace_ray(wall, cone, dr.normalize(on_light), dr.norm(on_light), 1e-4)
    assert np.mean(seen != (np.array(room) > 0)) < 0.02
    assert 0.5 < seen.mean() < 0.8


def test_the_lit_share_of_samples_is_tau():
    x, y = (Float(q) for q in halton_points_in_disc(20_000))
    shadow = compute_linear_shadow(SPHERE, CONE, 1 / 256)
    share = np.mean(find_edge(SPHERE, CONE, shadow).is_lit_at(x, y))
    assert share == pytest.approx(shadow.visible[0], abs=2e-3)


# Derivatives, against finite differences of the same shadow


SCENES = {
    "light": (0.2, lambda x: (P(x, 0, 6), Float(1), SPHERE)),
    "radius": (1.0, lambda x: (P(0, 0, 6), x, SPHERE)),
    "sphere": (0.27, lambda x: (P(0, 0, 6), Float(1), Sphere(P(0.35, 0, 2.5), x))),
    "box": (3.1, lambda x: (P(0, 0.1, 6), Float(1), Box(P(-3, 0, 3), P(x, 4, 0.6)))),
    "height": (2.8, lambda x: (P(0, 0, 6), Float(2), Sphere(P(0.5, 0, 0) + P(0, 0, 1) * x, 0.4))),
}


def share_and_derivative(method, name, *settings):
    """The lit share as a function of the parameter, its value there, and Dr.Jit's derivative."""
    at, scene = SCENES[name]

    def share(x):
        light, radius, field = scene(x)
        return method(field, make_light_cone(P(0, 0, 0), light, radius, 0.02), *settings).visible

    x = Float(at)
    dr.enable_grad(x)
    dr.backward(share(x))
    return lambda x: np.array(share(Float(x))), at, dr.grad(x)[0]


@pytest.mark.parametrize(
    ("method", "n", "step"),
    [(compute_linear_shadow, 256, 0.01), (compute_split_shadow, 2000, 0.005)],
)
@pytest.mark.parametrize("name", SCENES)
def test_derivatives_are_those_of_finite_differences(name, method, n, step):
    share, at, derivative = share_and_derivative(method, name, 1 / n)
    difference = (share(at + step) - share(at - step)).item() / (2 * step)
    assert abs(difference) > 0.01
    assert derivative == pytest.approx(difference, rel=0.05)


@pytest.mark.parametrize("method", [compute_linear_shadow, base, compute_convex_shadow])
@pytest.mark.parametrize("name", SCENES)
def test_derivatives_are_those_of_the_minimum(name, method):
    """Though ε is large: those of τ(r_min), which is smooth; the box has a crease there."""
    *_, derivative = share_and_derivative(method, name, 1 / 20)
    at, scene = SCENES[name]

    def exact(x):
        light, radius, field = scene(Float(x))
        return compute_dense_shadow(
            field, make_light_cone(P(0, 0, 0), light, radius, 0.02)
        ).visible[0]

    assert derivative == pytest.approx((exact(at + 1e-3) - exact(at - 1e-3)) / 2e-3, rel=0.01)


class Ring(Field):
    """A torus about its axis, not convex: many rays pass through it twice, or by its two sides."""

    is_convex = False

    def __init__(self, centre, axis, radius, tube):
        self.centre, self.axis, self.radius, self.tube = centre, axis, radius, tube

    def distance(self, p):
        q = p - self.centre
        z = dr.dot(q, self.axis)
        across = dr.safe_sqrt(dr.squared_norm(q) - z * z)
        return dr.sqrt(dr.square(across - self.radius) + z * z) - self.tube


@pytest.mark.parametrize("direction", "AB")
def test_derivatives_of_rings_are_those_of_the_minimum(direction):
    """Though ε is large; there differences of the march itself are wrong, often in some rays."""
    rng, many = np.random.default_rng(0), 2000
    centre = vectors(np.column_stack([rng.normal(0, 0.5, (many, 2)), rng.uniform(1.2, 5, many)]))
    axis = dr.normalize(vectors(rng.normal(size=(many, 3))))
    radius, tube = rng.uniform(0.2, 1, many), rng.uniform(0.1, 0.4, many)
    cone = make_light_cone(P(0, 0, 0) + 0 * centre, P(0, 0, 6), 1.0, 0.02)

    def share(method, x, *settings):
        ring = Ring(centre, axis, Float(radius) + x, Float(tube * radius))
        return method(ring, cone, *settings).visible

    def differences(method, step, *settings):
        ends = (np.array(share(method, x, *settings)) for x in (step, -step))
        return np.subtract(*ends) / (2 * step)

    x = dr.zeros(Float, many)
    dr.enable_grad(x)
    found = share(compute_linear_shadow, x, 1 / 20, direction)
    dr.forward(x)
    expected = differences(compute_dense_shadow, 1e-4)
    rough = differences(compute_linear_shadow, 1e-2, 1 / 20, direction)
    scale = np.abs(expected).sum()
    assert np.abs(np.array(dr.grad(found)) - expected).sum() < 0.005 * scale
    assert np.abs(rough - expected).sum() > 0.02 * scale


@pytest.mark.parametrize("direction", "AB")
@pytest.mark.parametrize(
    ("method", "rel"),
    [(compute_linear_shadow, 0.001), (base, 0.001), (compute_convex_shadow, 0.02)],
)
def test_derivatives_of_nearly_dark_and_nearly_lit_rays(method, rel, direction):
    """By the light's radius: no march ends early for them, and both ends of the axis count."""
    rng, many = np.random.default_rng(2), 2000
    field = random_spheres(rng, many) | random_boxes(rng, many) | HalfSpace(P(0, 0, 1), -0.1)
    start = vectors(rng.normal(0, (0.1, 0.1, 1e-9), (many, 3)))

    def share(method, radius, *settings):
        return method(field, make_light_cone(start, P(0, 0, 6), radius, 0.1), *settings).visible

    radius = dr.full(Float, 1, many)
    dr.enable_grad(radius)
    found = share(method, radius, 1 / 20, direction)
    dr.forward(radius)
    larger, smaller = (np.array(share(compute_dense_shadow, 1 + x)) for x in (1e-4, -1e-4))
    expected = (larger - smaller) / 2e-4
    off = np.abs(np.array(dr.grad(found)) - expected)
    assert off.sum() < rel * np.abs(expected).sum()
    assert np.mean(off > 0.02) <= (0.015 if method is compute_convex_shadow else 0)


# Backends, precisions, and what is refused


def test_single_precision_and_scalars_agree():
    shares = []
    for kind in (dr.llvm.Array3f, dr.llvm.ad.Array3f64, dr.scalar.Array3f64):
        field = Sphere(kind(0.35, 0, 2.5), 0.3)
        found = soft_shadow(field, kind(0, 0, 0), kind(0, 0, 6), 1.0, 0.02, epsilon=1 / 30)
        shares.append(np.array(found.visible).item())
    assert shares == pytest.approx([shares[1]] * 3, abs=2e-3)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"epsilon": 0}, "epsilon = 0 should be"),
        ({"epsilon": np.nan}, "epsilon = nan should be"),
        ({"epsilon": "1/20"}, "epsilon = '1/20' should be"),
        ({"radius": 0.0, "ball": 0.0}, "nor both 0"),
        ({"radius": Float(1, 0), "ball": 0.0}, "nor both 0"),
        ({"radius": -1.0}, "not be negative"),
        ({"shadow": "lineer"}, "did you mean linear"),
        ({"direction": "C"}, "no direction 'C'"),
        ({"shadow": "monte_carlo", "rays": 0}, "rays = 0"),
    ],
)
def test_a_wrong_argument_is_one_sentence(wrong, said):
    given = {"radius": 1.0, "ball": 0.1} | wrong
    with pytest.raises(bk.BrdfkitError, match=said):
        soft_shadow(SPHERE, P(0, 0, 0), P(0, 0, 6), **given)


def test_the_pieces_of_unions_that_are_moved_and_named():
    things = (df.sphere(1) | df.box(1).at(1, 0, 0)).rotate(0.3).scale(2).made_of("gold")
    field = things.at(0, 0, 1) | (df.plane() | df.torus(1, 0.2).k(0.1))
    pieces, points = split_into_pieces(field), np.random.default_rng(0).uniform(-3, 3, (200, 3))
    assert [piece.is_convex for piece in pieces] == [True, True, False]
    np.testing.assert_allclose(np.min([p(points) for p in pieces], axis=0), field(points))


@pytest.mark.parametrize(
    "shadow", ["linear", "base", "discrete", "convex", "split", "hard", "quilez"]
)
def test_a_field_that_is_not_a_number_is_told(shadow):
    class Holed(Sphere):
        def distance(self, p):
            return dr.select(p.z > 1, dr.nan, super().distance(p))

    points = P(Float(0, 0), 0, Float(-9, 0))  # the second one is in the hole's way
    lights = P(0, 0, Float(-3, 6))
    with pytest.raises(bk.BrdfkitError, match="between point 1 and the light"):
        soft_shadow(Holed(SPHERE.centre, 0.3), points, lights, 1.0, 0.02, shadow=shadow)
