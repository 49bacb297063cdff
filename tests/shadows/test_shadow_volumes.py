"""Shadow volumes: equal to shadow rays, wrong where the thesis says so, and closed everywhere."""

import drjit as dr
import mitsuba as mi
import numpy as np
import pytest
from scipy.spatial import ConvexHull
from shadow_scenes import LIGHTS, light

from brdfkit.core.errors import BrdfkitError
from brdfkit.core.projective.camera import Camera
from brdfkit.core.projective.light import Light
from brdfkit.shadows.comparison.exact_shadow import LitView
from brdfkit.shadows.hybrid import make_hybrid_shadow
from brdfkit.shadows.volumes.casters import CASTERS
from brdfkit.shadows.volumes.light_volumes import METHODS, LightVolumes
from brdfkit.shadows.volumes.mesh import Mesh
from brdfkit.shadows.volumes.projected_faces import picture_matrix, project_faces
from brdfkit.shadows.volumes.silhouettes import SILHOUETTES
from brdfkit.shadows.volumes.stencil import Stencil
from brdfkit.shadows.volumes.volume import BACK_CAPS, Faces, extrude_points, make_shadow_volume

pytestmark = pytest.mark.usefixtures("llvm_variant")
SIZE = 96
OUTSIDE = [4, -6, 5]


def triangles(points, faces):
    """A shape of Mitsuba's by its triangles."""
    shape = mi.Mesh("triangles", len(points), len(faces))
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = np.ravel(points).astype(np.float32)
    parameters["faces"] = np.ravel(faces).astype(np.uint32)
    parameters.update()
    return shape


def ball(steps=32):
    """A closed mesh like Mitsuba's sphere, of fewer triangles than shadow volumes make of one."""
    phi, theta = np.arange(steps) * 2 * np.pi / steps, np.arange(1, steps // 2) * 2 * np.pi / steps
    theta, phi = np.repeat(theta, steps), np.tile(phi, len(theta))
    rings = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)
    hull = ConvexHull(np.vstack([rings, [[0, 0, 1], [0, 0, -1]]]))
    inwards = np.einsum("ij,ij->i", hull.equations[:, :3], normals(hull)) < 0
    faces = np.where(inwards[:, None], hull.simplices[:, ::-1], hull.simplices)
    return triangles(0.8 * hull.points + [0, 0, 1], faces)


def normals(hull):
    a, b, c = hull.points[hull.simplices].transpose(1, 0, 2)
    return np.cross(b - a, c - a)


def objects():
    """A ball and a turned cube above a ground."""
    t = mi.ScalarTransform4f
    turned = t().translate([1.5, 1, 0.6]).rotate([0, 0, 1], 30).scale(0.5)
    return {
        "ground": {"type": "rectangle", "to_world": t().scale(4)},
        "ball": ball(),
        "cube": {"type": "cube", "to_world": turned},
    }


def street():
    """Houses that stand on a street and run into each other."""
    t = mi.ScalarTransform4f
    houses = {
        f"house {i}": {"type": "cube", "to_world": t().translate([x, y, h]).scale([0.5, 0.6, h])}
        for i, (x, y, h) in enumerate([(-2, 0, 1), (-1.2, 0.5, 0.4), (1, 1, 0.7), (0.3, -1.5, 0.2)])
    }
    return {"street": {"type": "rectangle", "to_world": t().scale(4)}, **houses}


def leaves(count=60):
    """Single triangles, turned anyhow, above a ground."""
    random = np.random.default_rng(1)
    middle = random.uniform([-2, -2, 0.3], [2, 2, 2], (count, 1, 3))
    corners = middle + random.normal(0, 0.4, (count, 3, 3))
    ground = {"type": "rectangle", "to_world": mi.ScalarTransform4f().scale(4)}
    return {"ground": ground, "leaves": triangles(corners, np.arange(3 * count))}


def scene_of(shapes, kind="point", eye=OUTSIDE, **camera):
    to_world = mi.ScalarTransform4f().look_at(eye, [0, 0, 0.5], [0, 0, 1])
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}}
    camera = {"type": "perspective", "fov": 40, "to_world": to_world, "film": film, **camera}
    return mi.load_dict({"type": "scene", "light": light(kind), "camera": camera, **shapes})


def shaded(scene, places=((0.5, 0.5),)):
    """(The surfaces at `places` of all pixels, whether they are lit, by rays, and whether the light
    is on the side of them that the camera sees)."""
    sensor, emitter = scene.sensors()[0], scene.emitters()[0]
    row, column = np.divmod(np.arange(SIZE**2), SIZE)
    pixel = np.stack([column, row]) + np.array(places)[..., None]
    pixel = mi.Point2f((pixel / SIZE).transpose(1, 0, 2).reshape(2, -1))
    ray = sensor.sample_ray(0.0, 0.5, pixel, mi.Point2f(0.5))[0]
    si = scene.ray_intersect(ray)
    ds, _ = emitter.sample_direction(si, mi.Point2f(0.5))
    to_light = si.spawn_ray(ds.d)
    to_light.maxt = ds.dist
    lit = si.is_valid() & ~scene.ray_test(to_light)
    sides = si.is_valid() & (dr.dot(si.n, ds.d) * dr.dot(si.n, ray.d) < 0)
    return si, np.array(lit), np.array(sides)


def border(scene, lit):
    """The pixels that a border of a shadow goes through, by 16 more rays in each."""
    places = np.stack(np.meshgrid([0.01, 0.3, 0.7, 0.99], [0.01, 0.3, 0.7, 0.99]), -1)
    return np.any(shaded(scene, places.reshape(-1, 2))[1].reshape(-1, SIZE**2) != lit, axis=0)


def meshes_of(scene):
    return [Mesh.from_shape(shape) for shape in scene.shapes()]


def volumes_of(scene, meshes=None, **how):
    camera = Camera.from_sensor(scene.sensors()[0])
    meshes = meshes_of(scene) if meshes is None else meshes
    return LightVolumes(meshes, Light.from_emitter(scene.emitters()[0]), camera, pixels=SIZE, **how)


def wrong(scene, **how):
    """The share of the pixels, without those of a border, whose shadow is not that of rays; where
    the light is on the side of the surface that is seen."""
    si, lit, sides = shaded(scene)
    counted = sides & ~border(scene, lit)
    found = np.array(volumes_of(scene, **how).visibility(si.p, si.n)) == 1
    return ((found != lit) & counted).sum() / counted.sum()


# Right


@pytest.mark.parametrize("shapes", [objects, street, leaves])
@pytest.mark.parametrize("kind", LIGHTS)
def test_no_pixel_differs_from_shadow_rays(shapes, kind):
    scene = scene_of(shapes(), kind)
    si, lit, sides = shaded(scene)
    within = ~border(scene, lit)
    assert 0.03 < lit[sides & within].mean() < 0.97
    for method in METHODS:
        found = np.array(volumes_of(scene, method=method).visibility(si.p, si.n)) == 1
        # depth_pass has no caps: not for what is seen from the side without light
        asked = sides & within if method == "depth_pass" else np.array(si.is_valid()) & within
        assert not np.any((found != lit)[asked]), method


def scaled(scene, factor):
    """A scene of meshes with the light `point`, made larger or smaller."""
    meshes = enumerate(meshes_of(scene))
    shapes = {f"mesh {i}": triangles(factor * mesh.points, mesh.triangles) for i, mesh in meshes}
    to_world = mi.ScalarTransform4f().look_at(
        *(np.array([OUTSIDE, [0, 0, 0.5]]) * factor), [0, 0, 1]
    )
    near = {"to_world": to_world, "near_clip": 0.01 * factor, "far_clip": 1e4 * factor}
    lamp = {"type": "point", "position": np.array(light("point")["position"]) * factor}
    return scene_of({**shapes, "light": lamp}, **near)


@pytest.mark.parametrize("factor", [1e-5, 1e5])
def test_the_scale_of_the_world_changes_nothing(factor):
    """Of rays only ours are right in small worlds: those that Mitsuba spawns begin beyond all."""
    scene = scene_of(objects())
    _, lit, sides = shaded(scene)
    asked = sides & ~border(scene, lit)
    scene = scaled(scene, factor)
    sensor, emitter = scene.sensors()[0], scene.emitters()[0]
    seen = LitView.from_sensor(scene, sensor, emitter, (SIZE, SIZE))
    assert not np.any((seen.exact != lit)[asked])
    for method in METHODS:
        found = np.array(volumes_of(scene, method=method).visibility(seen.si.p, seen.si.n)) == 1
        assert not np.any((found != lit)[asked]), method
    volumes = make_hybrid_shadow(scene, sensor, emitter, resolution=256, jump=8)
    found = np.array(volumes.visibility(seen.si.p, seen.si.n)) == 1
    assert (found != lit)[asked].mean() < 1e-3


def test_a_light_in_a_room():
    room = {"type": "cube", "to_world": mi.ScalarTransform4f().scale(10)}
    scene = scene_of({**objects(), "room": room})
    for method in METHODS:
        assert wrong(scene, method=method) == 0


def round_shapes():
    """Shapes of Mitsuba's without triangles; the cylinder is a tube, open at both ends."""
    t = mi.ScalarTransform4f
    return {
        "ground": {"type": "disk", "to_world": t().scale(4)},
        "ball": {"type": "sphere", "center": [-0.8, 0, 1], "radius": 0.7},
        "tube": {"type": "cylinder", "p0": [1, 1, 0.3], "p1": [1.3, 1, 1.5], "radius": 0.5},
        "plate": {"type": "disk", "to_world": t().translate([0.5, -1.2, 0.7]).scale(0.6)},
    }


@pytest.mark.parametrize("kind", LIGHTS)
def test_the_picture_is_that_of_direct_light(kind):
    """Mitsuba draws the same samples, of round shapes where ours are of triangles."""
    scene = scene_of(round_shapes(), kind)
    ours = np.array(picture(scene))
    rays = np.array(mi.load_dict({"type": "direct"}).render(scene, spp=1))
    different = np.any(np.abs(ours - rays) > 1e-4 * rays.max(), axis=2).ravel()
    assert not np.any(different & ~border(scene, shaded(scene)[1]))
    assert different.mean() < 1e-3


def crossings(points, mesh, place):
    """How many triangles lie between `points` (n, 3) and a `place`, each by its own equation."""
    a, b, c = mesh.points[mesh.triangles].transpose(1, 0, 2)
    met = np.zeros(len(points), int)
    for corner, x, y in zip(a, b - a, c - a, strict=True):
        system = np.broadcast_to(np.stack([x, y], axis=-1), (len(points), 3, 2))
        system = np.concatenate([system, (points - place)[..., None]], axis=2)
        u, v, t = np.linalg.solve(system, (points - corner)[..., None])[..., 0].T
        met += (u > 0) & (v > 0) & (u + v < 1) & (t > 0) & (t < 1)
    return met


def test_a_point_is_in_as_many_volumes_as_triangles_hide_it():
    scene = scene_of(leaves())
    mesh = next(mesh for mesh in meshes_of(scene) if len(mesh.triangles) > 2)
    volumes = volumes_of(scene, [mesh])
    si, _, _ = shaded(scene)
    p, seen = volumes.move_off_surface(si.p, si.n), np.array(si.is_valid())
    expected = crossings(np.array(p, float).T[seen], mesh, light("point")["position"])
    assert expected.max() >= 3
    different = np.array(volumes.count_volumes_around(p))[seen] != expected
    assert different.sum() <= 2  # a ray through an edge, where rounding decides


def test_all_kinds_of_caps_silhouettes_and_ends_agree():
    scene = scene_of(objects())
    si, lit, sides = shaded(scene)
    closed = [mesh for mesh in meshes_of(scene) if len(mesh.triangles) > 2]
    asked = sides & ~border(scene, lit)
    for casters in CASTERS:
        for silhouettes in SILHOUETTES:
            for back_cap in BACK_CAPS:
                how = {"casters": casters, "silhouettes": silhouettes, "back_cap": back_cap}
                for length in (0, 50):
                    volumes = volumes_of(scene, closed, length=length, **how)
                    dark = np.array(volumes.visibility(si.p, si.n)) == 0
                    assert not np.any((dark == lit)[asked]), how


@pytest.mark.parametrize("casters", CASTERS)
@pytest.mark.parametrize("kind", LIGHTS)
def test_volumes_are_closed(casters, kind):
    """A ray leaves every volume that it enters, also one through edges, seen in the axes."""
    cube = {"type": "cube", "to_world": mi.ScalarTransform4f().translate([0, 0, 0.5])}
    scene = scene_of({**objects(), "cube": cube}, kind, eye=[0, -9, 0.5])
    camera, lamp = Camera.from_sensor(scene.sensors()[0]), Light.from_emitter(scene.emitters()[0])
    closed = [mesh for mesh in meshes_of(scene) if len(mesh.triangles) > 2]
    volumes = [make_shadow_volume(mesh, lamp, casters) for mesh in closed]
    faces = Faces.join([f for v in volumes for f in (v.walls, v.front, v.back)])
    to_picture = picture_matrix(camera)
    stencil = Stencil(project_faces(faces, to_picture), halvings=4)
    random = np.random.default_rng(0).uniform(-1, 1, (20_000, 2))
    t, zero = np.linspace(-1, 1, 1001), np.zeros(1001)
    axes = np.concatenate([np.column_stack(way) for way in ((t, zero), (zero, t), (t, t), (t, -t))])
    places = mi.Point2f(np.concatenate([random, axes]).T)
    total = stencil.count_faces(*places, mi.Float(-dr.inf), mi.Float(dr.inf))
    assert np.all(np.array(total) == 0)
    walls = Faces.join([volume.walls for volume in volumes])
    walls = Stencil(project_faces(walls, to_picture), halvings=4)
    assert np.any(np.array(walls.count_faces(*places, mi.Float(-dr.inf), mi.Float(dr.inf))) != 0)


# Wrong, where the thesis says so


def test_depth_pass_is_wrong_with_the_eye_in_a_shadow():
    """Depth-pass is equal to depth-fail outside, and not inside [Ergun 2008, 2.1.2; check 13]."""
    for eye, fails in ((OUTSIDE, False), (WITHIN, True)):
        scene = scene_of(objects(), eye=eye)
        assert wrong(scene, method="depth_fail") == 0
        share = wrong(scene, method="depth_pass")
        assert share > 0.5 if fails else share == 0


def test_depth_pass_is_wrong_where_the_near_plane_cuts_a_volume():
    scene = scene_of(objects(), near_clip=8)
    assert wrong(scene, method="depth_fail") == 0
    assert wrong(scene, method="depth_pass") > 0.02


WITHIN = [1, -0.8, 0.3]  # a shadow of the `objects`
FROM_BEHIND = [-4, 6, -4.5]


@pytest.mark.parametrize("kind", [*LIGHTS, FROM_BEHIND], ids=str)
def test_caps_on_the_near_plane_mend_depth_pass(kind):
    """Also of an eye in a shadow, of a sun behind the camera, and of leaves that the plane cuts."""
    for shapes, eye, near in ((objects, OUTSIDE, 8), (objects, WITHIN, 0.01), (leaves, OUTSIDE, 7)):
        scene = scene_of(shapes(), kind, eye=eye, near_clip=near)
        assert wrong(scene, method="depth_pass", near_cap=True) == 0


def test_a_volume_that_ends_too_early_loses_the_shadow():
    scene = scene_of(objects())
    shares = [wrong(scene, length=length) for length in (0.1, 1.0, 50.0)]
    assert shares[0] > shares[1] > shares[2] == 0


def test_depth_fail_needs_the_far_plane_at_infinity():
    scene = scene_of(objects(), far_clip=12)  # behind all that is seen
    assert wrong(scene) == 0
    assert wrong(scene, far_plane="finite") > 0.02


def test_ghost_shadows_behind_walls_that_cast_none():
    """A shadow goes on through a thin wall that no volume was made of, unless it is bounded."""
    t = mi.ScalarTransform4f
    ceiling = {"type": "cube", "to_world": t().scale([3, 3, 0.01])}
    floor = {"type": "rectangle", "to_world": t().translate([0, 0, -2]).scale(4)}
    scene = scene_of({"ball": ball(), "ceiling": ceiling, "floor": floor}, eye=[1, -10, -1])
    si, lit, _ = shaded(scene)
    below = np.array(si.is_valid() & (si.p.z < -1.99)) & ~lit
    meshes = meshes_of(scene)

    def dark(**how):
        return 1 - np.array(volumes_of(scene, **how).visibility(si.p, si.n))[below].mean()

    only_ball = [mesh for mesh in meshes if len(mesh.triangles) > 12]
    assert dark() == 1
    assert 0.02 < dark(meshes=only_ball) < 0.5
    assert dark(meshes=only_ball, length=2.3) == 0  # beyond the ceiling, not to the floor


def test_caps_fight_with_the_surfaces_that_they_lie_on():
    """On the surface rounding decides whether its cap is behind it; beside it, nothing does."""
    scene = scene_of(objects(), eye=[-4, -3, 6])
    si, lit, sides = shaded(scene)
    its = [mesh for mesh in meshes_of(scene) if len(mesh.triangles) > 12]
    for casters, fights in (("light_facing", True), ("facing_away", False)):
        volumes = volumes_of(scene, its, casters=casters)
        moved = volumes.move_off_surface(si.p, si.n)
        specks, others = (
            (np.array(volumes.count_volumes_around(p)) != 0) & lit & sides for p in (si.p, moved)
        )
        print(casters, specks.sum(), others.sum())
        assert (specks.sum() > 20) == fights
        assert others.sum() <= 1


# What they are made of


def cube_towards(direction):
    cube = Mesh.from_shape(mi.load_dict({"type": "cube"}))
    return cube, Light(np.append(direction / np.linalg.norm(direction), 0))


@pytest.mark.parametrize(("direction", "edges"), [((0, 0, 1), 4), ((1, 1, 1), 6), ((1, 2, 0), 6)])
def test_silhouette_of_a_cube(direction, edges):
    """[Ergun 2008]: 4 edges along a face's normal, 6 along a diagonal of the body."""
    cube, lamp = cube_towards(np.array(direction, float))
    for silhouette in SILHOUETTES.values():
        found, times = silhouette(cube, CASTERS["light_facing"](cube, lamp))
        assert len(found) == edges
        assert set(times) == {1}


def test_both_ways_to_silhouettes_agree():
    ball = meshes_of(scene_of(objects()))[1]
    random = np.random.default_rng(2)
    for direction in random.normal(size=(20, 3)):
        lamp = Light(np.append(direction / np.linalg.norm(direction), 0))
        for casters in CASTERS.values():
            casts = casters(ball, lamp)
            one, other = (
                {(*edge, times) for edge, times in zip(found.tolist(), often.tolist(), strict=True)}
                for found, often in (way(ball, casts) for way in SILHOUETTES.values())
            )
            assert one == other
            assert one


def test_what_a_ball_takes():
    """E = 3 F / 2 edges, of which some √E are the silhouette, a closed way."""
    scene = scene_of(objects())
    mesh = next(mesh for mesh in meshes_of(scene) if len(mesh.triangles) > 12)
    volumes = volumes_of(scene, [mesh], casters="light_facing")
    edges, (volume,) = len(mesh.shared_edges[0]), volumes.volumes
    assert edges == 3 * len(mesh.triangles) / 2
    assert np.sqrt(edges) / 2 < len(volume.walls.times) < 3 * np.sqrt(edges)
    ends = volume.walls.corners[:, :2, :3]
    assert {tuple(p) for p in ends[:, 0]} == {tuple(p) for p in ends[:, 1]}


@pytest.mark.quick
def test_the_projection_with_no_far_plane_keeps_what_is_at_infinity():
    """P∞ (x, y, z, 0) has depth 1 [Ergun 2008, 2.1.8]."""
    camera = Camera(np.eye(4), 0.5, 0.4, 0.1, 10)
    points = np.random.default_rng(3).normal(size=(10, 3)) - [0, 0, 5]
    ends = extrude_points(points, Light(np.array([0, 0, 3, 1.0])), 0) @ camera.infinite_projection.T
    np.testing.assert_allclose(ends[:, 2] / ends[:, 3], 1, atol=1e-12)


# Out of a depth map


@pytest.mark.parametrize("kind", LIGHTS)
def test_volumes_of_a_finer_map_are_nearer_to_rays(kind):
    scene = scene_of(street(), kind)
    si, lit, sides = shaded(scene)

    def share(resolution):
        parts = scene.sensors()[0], scene.emitters()[0]
        dark = (
            np.array(make_hybrid_shadow(scene, *parts, resolution, jump=8).visibility(si.p, si.n))
            == 0
        )
        return (dark == lit)[sides].mean()

    assert share(256) < share(64) / 3
    assert share(256) < 0.02


@pytest.mark.parametrize("kind", LIGHTS)
def test_a_slanted_ground_is_not_torn(kind):
    """Its depths change from texel to texel, but do not jump."""
    ground = {"type": "rectangle", "to_world": mi.ScalarTransform4f().scale(9)}
    scene = scene_of({"ground": ground}, kind)
    si, lit, _ = shaded(scene)
    volumes = make_hybrid_shadow(
        scene, scene.sensors()[0], scene.emitters()[0], resolution=32, jump=8
    )
    assert lit.mean() > 0.8
    assert np.all(np.array(volumes.visibility(si.p, si.n))[lit] == 1)


def test_without_walls_all_is_lit():
    scene = scene_of(objects())
    si, _, _ = shaded(scene)
    parts = scene.sensors()[0], scene.emitters()[0]
    torn = make_hybrid_shadow(scene, *parts, resolution=8, jump=0)
    for volumes in (torn, volumes_of(scene, [])):
        assert np.all(np.array(volumes.visibility(si.p, si.n)) == 1)


# What is refused


def picture(scene, **how):
    return mi.load_dict({"type": "shadow_volume", **how}).render(scene, spp=1)


GROUP = {"type": "shapegroup", "leaf": {"type": "cube"}}
TREE = {"type": "instance", "group": {"type": "ref", "id": "group"}}
AROUND_THE_LIGHT = {"type": "sphere", "center": [-4, 2, 8], "radius": 1}


@pytest.mark.parametrize(
    ("shapes", "how", "sentence"),
    [
        ({}, {"casters": "light_facing"}, "ground: the mesh is not closed"),
        ({}, {"silhouettes": "shared_edges"}, "ground: the mesh is not closed"),
        ({"ground": AROUND_THE_LIGHT}, {"casters": "facing_away"}, "the light is inside this"),
        ({"ground": AROUND_THE_LIGHT}, {"back_cap": "fan"}, "ground: .* surrounds the light"),
        ({"group": GROUP, "tree": TREE}, {}, "tree: shadow volumes need triangles"),
        ({"sky": {"type": "constant"}}, {}, "no single place or direction"),
    ],
)
def test_what_cannot_be_right_is_one_sentence(shapes, how, sentence):
    with pytest.raises(BrdfkitError, match=sentence):
        picture(scene_of({**objects(), **shapes}), **how)


def test_a_lens_is_one_sentence():
    lens = {"type": "thinlens", "aperture_radius": 0.1, "focus_distance": 5}
    with pytest.raises(BrdfkitError, match="start on its lens"):
        picture(scene_of(objects(), **lens))
