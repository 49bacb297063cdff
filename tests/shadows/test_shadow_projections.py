"""Projections of shadow maps: what all of them must do, and the figures of each."""

from dataclasses import replace

import numpy as np
import pytest
from brdfkit.theses.ergun2008.depth_curves import measure_unevenness, sample_depth_curve
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from placements import LIGHTS, SUN, VIEWS, camera, placement

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.homogeneous import make_axes, project_points
from brdfkit.core.projective.light import Light
from brdfkit.shadows.maps.light_shadow import LightShadow
from brdfkit.shadows.maps.line_of_sight import LineOfSight
from brdfkit.shadows.maps.projection import LightDepth, Projection
from brdfkit.shadows.maps.resolution import texel_area_in_pixels
from brdfkit.shadows.maps.techniques import FILES, make_techniques

PROJECTIONS = FILES["projection"]


def project(name, placement, **settings):
    return make_techniques({"projection": name}, settings)["projection"](placement)


def points_in(body, count=40, seed=0):
    weights = np.random.default_rng(seed).dirichlet(np.full(len(body.corners), 0.3), count)
    return np.vstack([body.corners, weights @ body.corners])


# All of them


def check(projection, placement):
    """The body is in the cube; there and back is the same; rays of light are points of the map."""
    points = points_in(placement.relevant_body)
    assert projection.is_projectable(*points.T).all()
    there = np.transpose(projection.project(*points.T))
    assert np.abs(there).max() < 1 + 1e-9
    size = placement.reach
    assert np.abs(np.transpose(projection.unproject(*there.T)) - points).max() < 1e-6 * size
    origins, ways = (
        np.transpose(np.broadcast_arrays(*v)) for v in projection.light_ray(*there[:, :2].T)
    )
    assert np.linalg.norm(np.cross(points - origins, ways), axis=1).max() < 1e-6 * size
    way = np.transpose(np.broadcast_arrays(*placement.light.direction(*points.T)))
    for length in (1e-3 * size, 0.3 * size):
        farther = np.transpose(projection.project(*(points + length * way).T))
        assert np.abs(farther - there)[:, :2].max() < 1e-6
        assert (farther > there)[:, 2].all()


def check_slopes(projection, placement):
    """Require that `directional_derivative` is the difference quotient of `project`."""
    points, step = points_in(placement.visible_body), 1e-6 * placement.reach
    for axis in np.eye(3):
        slope = np.subtract(
            projection.project(*(points + step * axis).T),
            projection.project(*(points - step * axis).T),
        ) / (2 * step)
        found = np.array(
            np.broadcast_arrays(*projection.directional_derivative(tuple(points.T), axis))
        )
        assert np.abs(found - slope).max() < 1e-5 * np.abs(slope).max()


@pytest.mark.parametrize("kind", LIGHTS)
@pytest.mark.parametrize("view", VIEWS)
def test_all_hold_what_is_seen_and_its_shadows(kind, view):
    scene = placement(camera(*VIEWS[view]), LIGHTS[kind])
    for name in PROJECTIONS:
        projected = project(name, scene)
        linear = replace(projected, depth=LightDepth.from_placement(scene))
        for projection in (projected, linear):
            check(projection, scene)
            check_slopes(projection, scene)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.sampled_from(list(LIGHTS)))
def test_all_hold_whatever_the_camera_and_the_light(seed, kind):
    rng = np.random.default_rng(seed)
    eye, target = rng.uniform([-25, -25, 0.5], [25, 25, 12]), rng.uniform([-9, -9, 0], [9, 9, 4])
    to_light = rng.normal(size=3)
    to_light /= np.linalg.norm(to_light)
    light = {
        "directional": Light(np.append(to_light, 0)),
        "point": Light(np.append(rng.uniform(30, 90) * to_light, 1)),
        "spot": Light(np.append(rng.uniform(30, 90) * to_light, 1), -to_light, rng.uniform(0.1, 1)),
    }[kind]
    near = 10 ** rng.uniform(-2, 0)
    try:
        scene = placement(camera(eye, target, near=near), light)
        assert len(scene.relevant_body.corners)
    except BrdfkitError:
        assume(False)
    for name in PROJECTIONS:
        check(project(name, scene), scene)


@pytest.mark.parametrize("name", PROJECTIONS)
def test_a_point_light_far_away_is_a_directional_one(name):
    for view in VIEWS:
        far_away, sun = (
            placement(camera(*VIEWS[view]), Light(np.append(place, w)), nearest=2.5)
            for place, w in ((1e7 * SUN, 1), (SUN, 0))
        )
        points = points_in(sun.visible_body).T
        found = [project(name, scene).project(*points) for scene in (far_away, sun)]
        np.testing.assert_allclose(*found, atol=1e-3)


# Each of them


def test_the_camera_s_depths_are_those_of_its_planes():
    """Acceptance check 2 of [Ergun 2008]."""
    depths = camera([0, 0, 0], [0, 1, 0], near=1, far=100)
    y = np.array([1, 2, 10, 50, 99, 100.0])
    found = project_points(depths.matrix, np.outer(y, [0, 1, 0]))[:, 2]
    expected = [-1, 0.0101010, 0.8181818, 0.9797980, 0.9997959, 1]
    np.testing.assert_allclose(found, expected, atol=1e-7)


N_T = [[4, -4 / 15, 0, -0.04], [0, 8 / 3, 0, -0.6], [0, 0, 1, 0], [0, -4 / 3, 0, 1.8]]


@pytest.mark.quick
@pytest.mark.parametrize("angle", [0, 0.7, 2.5])
def test_a_trapezoid_becomes_the_map(angle):
    """Acceptance checks 3 and 4: the printed N_T, wherever the trapezoid lies."""
    sides = [(-0.8, -0.9), (0.7, -0.9), (0.3, 0.6), (-0.2, 0.6)]
    turn, shift = make_axes([0, 0, 1.0], [np.sin(angle), np.cos(angle), 0]), [3, -5, 0]
    # the line of sight begins at the narrow side, through the apex (0.1, 1.35) of the others
    to_sight = np.array([[-1, 0, 0, 0.1], [0, -1, 0, 0.6], [0, 0, 1, 0], [0, 0, 0, 1]])
    placed = np.eye(4)
    placed[:3, :3], placed[:3, 3] = turn.T, shift
    corners = project_points(placed, [(x, y, z) for x, y in sides for z in (-1, 1)])
    light = Light(np.array([0, 0, -1.0, 0]))
    sight = LineOfSight(to_sight @ np.linalg.inv(placed), light, corners, 0, 0)
    found = sight.make_warped_projection(1.35 - 0.6)
    points = [(0, 0, 0), (0, 0.4, 0), (0, -0.7, 0), (0, 0.4, 0.25), *((x, y, 0) for x, y in sides)]
    u, v, depth = found.project(*project_points(placed, points).T)
    printed = project_points(np.array(N_T), points)
    np.testing.assert_allclose(np.transpose([-u, -v, depth]), printed, atol=1e-9)
    np.testing.assert_allclose(-u[:3], [-0.0222222, -0.1157895, 0.0536585], atol=1e-7)
    np.testing.assert_allclose(-v[:3], [-0.3333333, 0.3684211, -0.9024390], atol=1e-7)
    np.testing.assert_allclose(depth[3], 0.1973684, atol=1e-7)
    np.testing.assert_allclose([-u[4:], -v[4:]], [[-1, 1, 1, -1], [-1, -1, 1, 1]], atol=1e-9)


def overhead():
    """A camera that looks along y from the origin, 1 to 10 far, under a sun at right angles."""
    eye = camera([0, 0, 0], [0, 1, 0], near=1, far=10, slope=0.5)
    sun = Light(np.array([0, 0, 1.0, 0]))
    return placement(eye, sun, low=[-20, -1, -20], high=[20, 10, 20])


def slopes(projection, *points):
    """Of the map at points: of u across and of v along y."""
    ways = (1, 0, 0), (0, 1, 0)
    found = [[projection.directional_derivative(p, ways[i])[i] for i in (0, 1)] for p in points]
    return np.abs(found)


NEAR, MIDDLE, FAR = (0.3, 1, 0.2), (-0.7, 4, 1), (2, 10, -1)


@pytest.mark.quick
def test_the_best_n_of_light_space_perspective():
    """Acceptance check 8: along the view texels are shared as z_f / z_n, across as its root."""
    near, far = slopes(project("light_space_perspective", overhead()), NEAR, FAR)
    np.testing.assert_allclose(near / far, [np.sqrt(10), 10], rtol=1e-9)
    near, far = slopes(project("light_space_perspective", overhead(), apex=1e6), NEAR, FAR)
    np.testing.assert_allclose(near / far, 1, rtol=1e-4)


@pytest.mark.quick
@pytest.mark.parametrize("name", ["light_space_perspective", "logarithmic_perspective"])
@pytest.mark.parametrize("view", ["perpendicular", "dueling frusta", "intermediate"])
def test_warps_weaken_as_view_and_light_become_parallel(name, view):
    """The distance of the apex, of w along the map, is the formula's over sin γ."""
    scene = seen_from(view)
    sun, eye, corners = scene.light.point[:3], scene.camera.position, scene.visible_body.corners
    sight = scene.visible_body.centroid - eye
    sight /= np.linalg.norm(sight)
    across = sight - sun * (sun @ sight)
    sine = np.linalg.norm(across)
    z_f = scene.camera.compute_depths(corners).max()
    n = (2.5 + np.sqrt(2.5 * z_f) if name == "light_space_perspective" else 2.5) / sine
    length = np.ptp(scene.relevant_body.corners @ across / sine)
    w = np.column_stack([scene.relevant_body.corners, np.ones(len(scene.relevant_body.corners))])
    w = w @ project(name, scene).matrix[3]
    assert w.max() / w.min() == pytest.approx(1 + length / n, rel=1e-9)


@pytest.mark.quick
def test_a_logarithm_makes_all_depths_equally_fine():
    """A texel is as large as a pixel's share everywhere: both grow as the distance."""
    found = slopes(project("logarithmic_perspective", overhead()), NEAR, MIDDLE, FAR)
    np.testing.assert_allclose(found * [[1], [4], [10]], found[[0, 0, 0]], rtol=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize("focus", [0.1, 0.4])
def test_a_focus_has_80_percent_of_the_map(focus):
    projection = project("trapezoidal", overhead(), focus=focus)
    v = [projection.project(0, y, 0)[1] for y in (1, 1 + 9 * focus, 10)]
    np.testing.assert_allclose(np.abs(np.subtract(v, v[0])), [0, 1.6, 2], atol=1e-9)


@pytest.mark.quick
def test_perspective_is_even_in_the_picture_s_cube():
    """A light at right angles to the view is far away in that cube too, so its map is affine."""
    scene = overhead()
    points = points_in(scene.relevant_body)
    cube = np.column_stack([project_points(scene.camera.matrix, points), np.ones(len(points))])
    found = np.transpose(project("perspective", scene).project(*points.T))
    affine, *_ = np.linalg.lstsq(cube, found, rcond=None)
    np.testing.assert_allclose(cube @ affine, found, atol=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize("light", [np.array([-1, -0.5, 3, 0]), np.array([-8, -2, 20, 1])])
def test_plane_optimal_is_the_projection_by_five_pairs_of_points(light):
    """Acceptance check 9, and the same map up to a stretch of each axis."""
    eye = camera([0, -6, 8], [0, 0, 0], slope=0.3)
    light = light / np.linalg.norm(light[:3]) if light[3] == 0 else light
    scene = placement(eye, Light(light), high=[20, 20, 0.5])
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    rays = project_points(np.linalg.inv(eye.matrix), np.column_stack([square, np.ones(4)]))
    rays -= eye.position
    ground = eye.position - rays * (eye.position[2] / rays[:, 2])[:, None]
    lifted = ground[3] + 0.1 * (light[:3] - light[3] * ground[3])
    equations = [np.kron(row, light) for row in np.eye(4)[[0, 1, 3]]]
    targets = np.column_stack([square, [1, 1, 1, -1]])
    for point, target in zip([*ground[:3], lifted], targets, strict=True):
        rows = np.eye(4)[:3] - target[:, None] * np.eye(4)[3]
        equations += [np.kron(row, np.append(point, 1)) for row in rows]
    _, singular, rows = np.linalg.svd(np.array(equations))
    assert singular[-1] > 1e-4
    by_pairs = rows[-1].reshape(4, 4)
    np.testing.assert_allclose(project_points(by_pairs, ground)[:, :2], square, atol=1e-9)
    at_infinity = by_pairs @ light / np.linalg.norm(by_pairs)
    np.testing.assert_allclose(at_infinity[[0, 1, 3]], 0, atol=1e-9)
    points = points_in(scene.relevant_body)
    found = project("plane_optimal", scene).project(*points.T)
    for ours, theirs in zip(found, project_points(by_pairs, points).T, strict=True):
        stretch, shift = np.polyfit(theirs, ours, 1)
        assert stretch > 0
        np.testing.assert_allclose(stretch * theirs + shift, ours, atol=1e-8)


@pytest.mark.quick
def test_the_ground_is_the_plane_unless_said():
    """Depth on the plane is 1, the greatest; a table half way up is another plane."""
    eye, sun = camera(*VIEWS["perpendicular"]), LIGHTS["directional"]
    scene = placement(eye, sun, nearest=2.5)
    flat = placement(eye, sun, low=[-20, -20, 0], high=[20, 20, 0], nearest=2.5)
    ground = np.array([[0, -9, 0], [2, 5, 0], [-4, 8, 0]])
    for where, plane, height in ((scene, "", 0), (flat, "", 0), (scene, [0, 0, 2, -3], 1.5)):
        found = project("plane_optimal", where, plane=plane)
        assert np.ptp(found.project(*(ground + np.array([0, 0, height])).T)[2]) < 1e-9
    assert project("plane_optimal", scene).project(*ground[0])[2] == pytest.approx(1)


@pytest.mark.quick
def test_the_footprint_of_a_texel():
    """Acceptance check 10: a texel over a pixel, both of the same angle, by area and by length."""
    light, eye = np.array([0.0, 3, 2]), np.array([0.0, -1, 4])
    by_light, by_eye = (
        Projection.from_matrix(camera(place, [0, 0, 0], slope=1).matrix, Light(np.append(place, 1)))
        for place in (light, eye)
    )
    found = texel_area_in_pixels((by_light, 64), (by_eye, (64, 64)), (0, 0, 0), (0, 0, 1))
    assert found == pytest.approx(1.3374318, abs=1e-7)
    lengths = [1 / p.directional_derivative((0, 0, 0), (0, 1, 0))[1] for p in (by_light, by_eye)]
    assert abs(lengths[0] / lengths[1]) == pytest.approx(1.5294118, abs=1e-7)


def seen_from(view):
    """Under the sun, from an eye that sees nothing nearer than 2.5."""
    return placement(camera(*VIEWS[view]), LIGHTS["directional"], nearest=2.5)


@pytest.mark.quick
def test_warps_are_finer_near_the_eye():
    """At right angles to the light the largest texels near the eye are a fraction of the focused
    map's, whose area is over 6 times the light space perspective's."""
    scene = seen_from("perpendicular")
    x, y = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-13, -10, 9))
    points, up = (x.ravel(), y.ravel(), np.zeros(81)), (0, 0, 1)
    picture = (Projection.from_matrix(scene.camera.matrix, scene.light), (512, 512))
    worst = {
        name: texel_area_in_pixels((project(name, scene), 512), picture, points, up).max()
        for name in PROJECTIONS
    }
    assert worst["focused"] < worst["uniform"]
    assert worst["light_space_perspective"] < worst["focused"] / 6
    for name in ("trapezoidal", "logarithmic_perspective", "perspective", "plane_optimal"):
        assert worst[name] < worst["light_space_perspective"]


@pytest.mark.quick
@pytest.mark.parametrize("view", ["perpendicular", "dueling frusta", "intermediate"])
def test_trapezoidal_and_plane_optimal_distort_depth_more(view):
    """[Ergun 2008, Figure 4.1]; there the perspective one is among the even, ours is not."""
    scene = seen_from(view)
    found = {
        name: measure_unevenness(
            *sample_depth_curve(project(name, scene), scene.relevant_body.corners)
        )
        for name in PROJECTIONS
    }
    assert found["uniform"] < 1e-9
    assert found["focused"] < 1e-9
    assert found["light_space_perspective"] < found["trapezoidal"] < found["plane_optimal"]
    linear = replace(project("plane_optimal", scene), depth=LightDepth.from_placement(scene))
    assert measure_unevenness(*sample_depth_curve(linear, scene.relevant_body.corners)) < 1e-9


@pytest.mark.quick
@pytest.mark.parametrize(
    ("name", "setting", "message"),
    [
        ("trapezoidal", {"fokus": 0.1}, "there is no setting 'fokus'; did you mean focus"),
        ("trapezoidal", {"focus": 2}, "focus = 2 should be a number between"),
        ("light_space_perspective", {"apex": 0}, "apex = 0 should be"),
        ("plane_optimal", {"plane": [0, 0, 1]}, "should be four numbers"),
        ("plane_optimal", {"plane": [0, 0, 1, -50]}, "the plane must cut"),
    ],
)
def test_a_bad_setting_is_one_sentence(name, setting, message):
    with pytest.raises(BrdfkitError, match=message):
        LightShadow(None, seen_from("perpendicular"), name, **setting)
