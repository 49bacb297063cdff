"""The integrator of level sets: where they are and look to, light, shadows, derivatives."""

import drjit as dr
import numpy as np
import pytest
from scipy.optimize import brentq

from brdfkit.volumes import TransferFunction, Volume
from brdfkit.volumes.rays.box import intersect_box
from brdfkit.volumes.rays.search import find_first_crossing, find_first_positive_step

SUN = {"type": "directional", "direction": [0, 0, -1], "irradiance": 2.0}
SKY = {"type": "constant", "radiance": 0.5}
GREY = {"type": "diffuse", "reflectance": 0.5}


@pytest.fixture
def mi(llvm_variant):
    return llvm_variant


def gridvolume(mi, values, **settings):
    grid = mi.VolumeGrid(np.asarray(values, np.float32)[..., None])
    return {"type": "gridvolume", "grid": grid, **settings}


def ball(n=32, radius=0.35):
    """Radius minus distance from the middle of the unit cube, at the centres of n³ voxels."""
    x = (np.arange(n) + 0.5) / n - 0.5
    return radius - np.linalg.norm(np.stack(np.meshgrid(x, x, x, indexing="ij")), axis=0)


def scene(mi, light, **integrator):
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "isosurface", "level": 0.0, "bsdf": GREY, **integrator},
            "light": light,
        }
    )


def rays(mi, origins, directions):
    o, d = (np.ascontiguousarray(np.transpose(x), np.float32) for x in (origins, directions))
    return mi.RayDifferential3f(mi.Ray3f(mi.Point3f(o), mi.Vector3f(d)))


def seen(mi, loaded, origins, directions, samples=1):
    """The radiance (n, 3) along rays, the mean of some samples."""
    n = len(origins)
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(3, n * samples)
    ray = rays(mi, np.repeat(origins, samples, 0), np.repeat(directions, samples, 0))
    found = np.array(loaded.integrator().sample(loaded, sampler, ray)[0]).T
    return found.reshape(n, samples, 3).mean(axis=1)


def around(n, distance=1.5):
    """Rays from all sides to points near the middle of the unit cube."""
    rng = np.random.default_rng(5)
    o = rng.normal(size=(n, 3))
    o = 0.5 + distance * o / np.linalg.norm(o, axis=1, keepdims=True)
    d = rng.uniform(0.4, 0.6, (n, 3)) - o
    return o, d / np.linalg.norm(d, axis=1, keepdims=True)


# Where, and which way


def test_the_depth_has_no_bias(mi):
    """Of random points D / (N + 1) [Lesar 2018], of even ones half a part, then none."""
    rng = np.random.default_rng(0)
    n, depth, truth = 10, 7.0, rng.uniform(1, 4, 4000)
    points = rng.uniform(0, depth, (4000, n))
    deep = np.where(points > truth[:, None], points, np.inf).min(axis=1) - truth
    deep = deep[np.isfinite(deep)]  # of some rays all points lie before the surface
    assert deep.mean() == pytest.approx(depth / (n + 1), rel=0.1)

    edge = mi.Float(truth)
    f = lambda t: dr.exp(t - edge) - 1  # noqa: E731
    args = mi.Float(dr.zeros(mi.Float, 4000)), mi.Float(depth), 10, mi.Bool(True)
    found = np.array(find_first_positive_step(f, *args)[1]) - truth
    assert found.min() > 0
    assert found.mean() == pytest.approx(depth / n / 2, rel=0.05)
    refined, there = find_first_crossing(f, *args)
    assert np.array(there).all()
    assert np.abs(np.array(refined) - truth).max() < 1e-5 * depth


def test_the_surface_of_a_ball(mi):
    """Against roots of the interpolated values in NumPy; normals point outwards."""
    values, n = ball(), 32
    to_world = np.diag([1 / n, 1 / n, 1 / n, 1])
    to_world[:3, 3] = 0.5 / n
    known = Volume(values, to_world)
    o, d = around(40)
    truth = [
        brentq(lambda t, o=o, d=d: known(o + t * d)[0], 1.02, 1.5, xtol=1e-9)
        for o, d in zip(o, d, strict=True)
    ]
    integrator = scene(mi, SKY, volume=gridvolume(mi, values)).integrator()
    ray = rays(mi, o, d)
    f = lambda t: integrator.value_above_level(ray(t))  # noqa: E731
    t, found = find_first_crossing(f, mi.Float(0.7), mi.Float(2.3), 256, mi.Bool(True))
    assert np.array(found).all()
    assert np.abs(np.array(t) - truth).max() < 1e-5 * 1.6
    si = integrator.make_surface_interaction(ray, t, mi.Float(0), found)
    outwards = dr.dot(si.n, dr.normalize(mi.Vector3f(si.p) - 0.5))
    assert np.array(outwards).min() > 0.999


def check_box(ray, volume, matrix):
    """Compare where rays meet the box of a volume with the cube that `matrix` transforms."""
    near = np.array(intersect_box(ray, volume)[0])
    points = np.array(ray.o).T + near[:, None] * np.array(ray.d).T
    local = (points - matrix[:3, 3]) @ np.linalg.inv(matrix[:3, :3]).T - 0.5
    np.testing.assert_allclose(np.abs(local).max(axis=1), 0.5, atol=1e-4)


@pytest.mark.parametrize(
    ("surface_of", "level"), [("opacity", 0.5), ("values", 0.0), ("plain grid", 0.0)]
)
def test_of_a_transfer_function_and_an_oblique_box(mi, surface_of, level):
    """A ball of A > 0.5, where values are above 0, becomes an ellipsoid: its points and normals."""
    t = mi.ScalarTransform4f
    cube = t().translate([3, 1, 2]).rotate([0.6, 0, 0.8], 40).scale([2, 3, 4])
    function = TransferFunction([-0.5, 0.5], [[1, 1, 1, 0], [1, 1, 1, 1]])
    volume = {
        "type": "transfer_function",
        "values": gridvolume(mi, ball(), to_world=cube),
        "transfer": function.to_json(),
        "to_world": cube,
    }
    matrix = np.array(cube.matrix)
    o, d = around(50)
    o = o @ matrix[:3, :3].T + matrix[:3, 3]
    d = d @ matrix[:3, :3].T
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    settings = {"surface_of": surface_of}
    if surface_of == "plain grid":
        volume, settings = volume["values"], {}
    loaded = scene(mi, SKY, volume=volume, level=level, **settings)
    check_box(rays(mi, o, d), loaded.integrator().volume, matrix)
    ray, integrator = rays(mi, o, d), loaded.integrator()
    found, there = find_first_crossing(
        lambda t: integrator.value_above_level(ray(t)),
        mi.Float(0.1),
        mi.Float(8),
        512,
        mi.Bool(True),
    )
    assert np.array(there).all()
    si = integrator.make_surface_interaction(ray, found, mi.Float(0), there)
    local = (np.array(si.p).T - matrix[:3, 3]) @ np.linalg.inv(matrix[:3, :3]).T - 0.5
    np.testing.assert_allclose(np.linalg.norm(local, axis=1), 0.35, atol=2e-3)
    outwards = local @ np.linalg.inv(matrix[:3, :3])
    outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
    assert (np.array(si.n).T * outwards).sum(axis=1).min() > 0.998


def test_a_box_that_cuts_the_solid_shows_its_face(mi):
    loaded = scene(mi, SUN, volume=gridvolume(mi, np.ones((2, 2, 2))))
    o, d = np.array([[0.3, 0.4, 2], [0.3, 2, 0.5]]), -np.eye(3)[[2, 1]]
    found = seen(mi, loaded, o, d)
    np.testing.assert_allclose(found[:, 0], [0.5 / np.pi * 2, 0], atol=1e-6)


# Light


@pytest.mark.parametrize("bsdf", [{"type": "roughconductor", "alpha": 0.2}, {"type": "conductor"}])
def test_light_is_that_of_mitsuba_on_a_plane(mi, bsdf):
    """Under a lamp and a sky, beside `direct` on a rectangle; of three rays, by their means."""
    t = mi.ScalarTransform4f
    lamp = {
        "type": "rectangle",
        "to_world": t().look_at([-1.2, 0.5, 1.8], [0.5, 0.5, 0.5], [0, 1, 0]).scale(0.6),
        "emitter": {"type": "area", "radiance": 4.0},
    }
    ramp = gridvolume(mi, np.array([1, -1]).reshape(2, 1, 1))
    more = {"sky": SKY, "lamp": lamp}
    ours, plane = (
        mi.load_dict({"type": "scene", "integrator": integrator, **more, **shapes})
        for integrator, shapes in [
            ({"type": "isosurface", "volume": ramp, "level": 0.0, "bsdf": bsdf}, {}),
            (
                {"type": "direct"},
                {
                    "ground": {
                        "type": "rectangle",
                        "to_world": t().translate([0.5, 0.5, 0.5]),
                        "bsdf": bsdf,
                    }
                },
            ),
        ]
    )
    back = np.array([[1.7, 0, 1.3], [0, -1, 1], [0.3, 0.2, 2]])
    o, d = 0.5 + back, -back / np.linalg.norm(back, axis=1, keepdims=True)
    found, expected = (seen(mi, loaded, o, d, 20_000) for loaded in (ours, plane))
    np.testing.assert_allclose(found, expected, rtol=0.02)


@pytest.mark.parametrize("moved", [(0, 0, 0), (-0.2, -0.5, -0.25)])
def test_shadows_are_those_of_the_volume(mi, moved):
    """A plate above half of the ground, the sun right above: from between them, the ground.

    Moved, one of the points is the origin, to which the sky is near where there are no shapes.
    """
    values = np.full((16, 16, 16), -1.0)
    values[:4], values[12:14, :, :8] = 1, 1
    o = np.array([[0.2, 0.5, 0.6], [0.4, 0.5, 0.6], [0.6, 0.5, 0.6], [0.8, 0.5, 0.6]])
    d = np.tile([0, 0, -1.0], (4, 1))
    box = mi.ScalarTransform4f().translate(moved)
    for shadows in (False, True):
        volume = gridvolume(mi, values, to_world=box)
        loaded = scene(mi, SUN, volume=volume, shadows=shadows)
        light = 0.5 / np.pi * 2
        expected = [0 if shadows else light] * 2 + [light] * 2
        np.testing.assert_allclose(seen(mi, loaded, o + moved, d)[:, 0], expected, atol=1e-3)


# Derivatives


def test_derivatives_are_those_of_differences(mi):
    """Of each ray, by the level, the values and the albedo; no ray meets a silhouette.

    Some rays meet a corner of the interpolated values within a difference, where both differ.
    """
    lamp = {"type": "point", "position": [2, -1, 3], "intensity": 9.0}
    loaded = scene(mi, lamp, volume=gridvolume(mi, ball(12) * 10))
    parameters, rng = mi.traverse(loaded), np.random.default_rng(1)
    ray, sampler = rays(mi, *around(200)), mi.load_dict({"type": "independent"})

    def radiance():
        sampler.seed(0, 200)
        return loaded.integrator().sample(loaded, sampler, ray)[0].x

    for key in ("level", "bsdf.reflectance.value", "volume.data"):
        name = f"integrator.{key}"
        start = type(parameters[name])(parameters[name])
        change = type(start)(rng.random(np.shape(start)).astype(np.float32))
        x = mi.Float(0)
        dr.enable_grad(x)
        ends = []
        for step in (x, 0.005, -0.005):
            parameters[name] = start + step * change
            parameters.update()
            ends.append(radiance())
        parameters[name] = start
        dr.forward(x, flags=dr.ADFlag.ClearEdges)
        expected = np.array(ends[1] - ends[2]) / 0.01
        error = np.abs(np.array(dr.grad(ends[0])) - expected) / np.abs(expected).mean()
        assert np.median(error) < 1e-3, key
        assert np.quantile(error, 0.9) < 0.02, key

    # Backward, those of the last of them in one sum
    leaf = type(start)(start)
    dr.enable_grad(leaf)
    parameters[name] = leaf
    parameters.update()
    dr.backward(dr.sum(radiance()))
    backward = float((np.array(dr.grad(leaf)) * np.array(change)).sum())
    assert backward == pytest.approx(expected.sum(), rel=1e-3)


# Bad input


@pytest.mark.quick
@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"bsdf": SUN}, "isosurface: bsdf = .* should be a bsdf"),
        ({"more": GREY}, "more"),
        ({"volume": "head.nii"}, "volume = head.nii should be a volume, such as a gridvolume"),
    ],
)
def test_what_cannot_be_rendered_is_said(mi, given, said):
    with pytest.raises(RuntimeError, match=said):
        scene(mi, SKY, **given)
