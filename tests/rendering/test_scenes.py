"""Scenes: each renders in every variant, knows where its material shows, and keeps energy."""

from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import brdfkit as bk
from brdfkit.core.colours import luminance
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import use_two_threads
from brdfkit.rendering.galleries import draw_grid
from brdfkit.rendering.scene_input import environment, mesh_file
from brdfkit.rendering.scenes import (
    _meshes,
    _studio,
    find_scene,
    knot,
    material_ball,
    scene_names,
    vase,
)

pytestmark = pytest.mark.usefixtures("module_in_llvm")

WHITE = {"name": "white", "type": "diffuse", "reflectance": 0.8}
BLACK = {"name": "black", "type": "diffuse", "reflectance": 0.02}
SCENES = scene_names()
SURFACES = {
    "vase": lambda: _meshes.revolve_profile(*vase.PROFILE.T, between=8),
    "knot": knot.make_knot_tube,
    "ball": lambda: _meshes.revolve_profile(*material_ball._make_ball_profile()),
    "ring": lambda: _meshes.revolve_profile(*material_ball._make_ring_profile()),
}
CUBE = """v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv -1 4 -1\nv 1 4 -1\nv 1 4 1\nv -1 4 1
f 1 2 3 4\nf 5 8 7 6\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n"""
KITCHEN = """<scene version="3.0.0"><integrator type="path"/><emitter type="constant"/>
<sensor type="perspective"><transform name="to_world">
<lookat origin="0,-8,1" target="0,0,1" up="0,0,1"/></transform><float name="fov" value="30"/>
<film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/>
<rfilter type="box"/></film></sensor>
<bsdf type="twosided" id="{id}"><bsdf type="diffuse"/></bsdf>
<bsdf type="twosided" id="Floor"><bsdf type="diffuse"/></bsdf>
<shape type="sphere"><point name="center" value="0,0,1"/><ref id="{id}"/></shape>
<shape type="disk"><transform name="to_world"><scale value="9"/></transform><ref id="Floor"/>
</shape></scene>"""


@pytest.mark.parametrize("name", SCENES)
def test_a_material_changes_what_its_mask_holds(name):
    """Outside, it is seen by its shadow, its reflection and at its edge only."""
    both = bk.render([WHITE, BLACK], spp=4, size=32, scene=name)
    changed = np.abs(both.differences["black"]).mean(axis=-1)
    assert 0.05 < both.mask.mean() < 0.5
    inside, outside = np.median(changed[both.mask]), np.median(changed[~both.mask])
    assert inside > 0.1
    assert outside < inside / 5
    assert np.percentile(both.pictures["white"], 95) > 0.1  # exposed


@pytest.fixture(scope="module")
def in_rgb():
    return {name: bk.render(WHITE, spp=30, size=8, scene=name) for name in SCENES}


@pytest.mark.parametrize("variant", ["llvm_ad_mono", "llvm_ad_spectral", "scalar_rgb"])
def test_every_variant_shows_the_same(in_rgb, variant):
    import mitsuba as mi

    mi.set_variant(variant)
    try:
        found = {name: bk.render(WHITE, spp=30, size=8, scene=name) for name in SCENES}
    finally:
        mi.set_variant("llvm_ad_rgb")
    for name, expected in in_rgb.items():
        mask = found[name].mask
        np.testing.assert_array_equal(mask, expected.mask)
        means = [luminance(r.pictures["white"][mask]).mean() for r in (found[name], expected)]
        assert means[0] == pytest.approx(means[1], rel=0.06), name


def test_the_mask_of_the_ball_is_its_outline():
    """A ray meets the ball, of radius 1, where it passes its middle at less than 1."""
    for width, height in ((32, 32), (48, 32), (24, 40)):
        mask = bk.render(WHITE, spp=1, size=(width, height)).mask
        forward = np.subtract(_studio.TARGET, _studio.CAMERA)
        forward /= np.linalg.norm(forward)
        up = np.cross((1, 0, 0), forward)
        scale = 2 * np.tan(np.radians(_studio.FOV) / 2) / min(width, height)
        x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
        x, y = (x - width / 2) * scale, (height / 2 - y) * scale
        ray = forward + x[..., None] * np.array([1, 0, 0]) + y[..., None] * up
        ray /= np.linalg.norm(ray, axis=-1, keepdims=True)
        to_ball = np.subtract(_studio.BALL, _studio.CAMERA)
        np.testing.assert_array_equal(mask, to_ball @ to_ball - (ray @ to_ball) ** 2 < 1)


@pytest.mark.parametrize("name", ["vase", "knot", "material_ball"])
def test_a_white_furnace_shows_nothing(name):
    """A closed surface of reflectance 1 under light of radiance 1 from everywhere is as bright."""

    def furnace(bsdf, size):
        found = find_scene(name)(bsdf, size)
        shapes = {k: s for k, s in found.items() if k in ("ball", "ring", "vase", "knot", "sensor")}
        light = {"type": "constant", "radiance": 1.0}
        return {"type": "scene", "integrator": {"type": "path"}, "light": light} | shapes

    white = {"type": "diffuse", "reflectance": 1.0}
    picture = bk.render(white, spp=64, size=24, scene=furnace).pictures["diffuse"]
    # between shading normals and triangles some light is lost; noise of the mean below 0.3 %
    assert picture.mean() == pytest.approx(1, abs=0.015)
    assert np.median(picture) == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("name", SURFACES)
def test_tangents_are_those_of_the_surface(name):
    """At random points: around the axis, z or that of the tube, to half a step of the mesh."""
    import mitsuba as mi

    points, normals = SURFACES[name]()
    made = _meshes.make_grid_mesh(points, normals, {"type": "diffuse"})
    samples = np.random.default_rng(0).random((3, 5000))
    on = made.sample_position(0.0, mi.Point2f(samples[:2]))
    n = np.array(on.n).T
    ray = mi.Ray3f(mi.Point3f(np.array(on.p) + 1e-3 * n.T), mi.Vector3f(-n.T))
    si = mi.load_dict({"type": "scene", "it": made}).ray_intersect(ray)
    p, s, face, shading = (np.array(x).T for x in (si.p, si.sh_frame.s, si.n, si.sh_frame.n))

    axis = np.broadcast_to([0.0, 0.0, 1.0], p.shape)
    if name == "knot":  # its axis is the mean around the tube
        middle = points[:, :-1].mean(axis=1)
        along = CubicSpline(np.linspace(0, 1, len(middle)), middle, bc_type="periodic")
        axis = along(np.array(si.uv.y), 1)
        p = p - along(np.array(si.uv.y))
        assert np.linalg.norm(p, axis=1) == pytest.approx(knot.TUBE, rel=0.01)
    around = np.cross(axis, p)
    around *= np.sign(np.sum(s * around, axis=1)[:1]) / np.linalg.norm(around, axis=1)[:, None]

    assert np.abs(np.sum(s * shading, axis=1)).max() < 1e-5
    assert np.sum(s * around, axis=1).min() > np.cos(np.pi / (points.shape[1] - 1))
    assert np.sum(face * n, axis=1).min() > 0.9  # outwards
    assert np.median(np.sum(face * shading, axis=1)) > np.cos(np.radians(2))


@pytest.fixture
def files(tmp_path, monkeypatch):
    """A folder with meshes, scene files and maps, in which one works."""
    import mitsuba as mi

    monkeypatch.chdir(tmp_path)
    Path("cube.obj").write_text(CUBE)
    Path("empty.obj").write_text(CUBE.partition("f ")[0])
    Path("broken.ply").write_text("ply of mine")
    Path("mesh.stl").write_text("solid")
    Path("kitchen.xml").write_text(KITCHEN.format(id="Counter"))
    Path("room.xml").write_text(KITCHEN.format(id="material"))
    grey = np.full((16, 32, 3), 0.3, np.float32)
    below_zero, inf = grey.copy(), grey.copy()
    below_zero[12, 3], inf[12, 3] = -1, np.inf
    maps = {"grey": grey, "night": 0 * grey, "below_zero": below_zero, "inf": inf}
    with use_two_threads():
        for name, pixels in maps.items():
            mi.Bitmap(pixels).write(f"{name}.exr")
    flat = CUBE.partition("f ")[0]
    Path("line.obj").write_text(flat + "f 1 1 2\nf 3 3 3\n")
    Path("beyond.obj").write_text(flat + "f -9 -1 -2\n")
    head = "ply\nformat ascii 1.0\nelement vertex 3\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    head += "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    for name, index in (("beyond", 99), ("below", -1)):
        Path(f"{name}.ply").write_text(f"{head}0 0 0\n1 0 0\n0 1 0\n3 0 1 {index}\n")


def test_a_mesh_stands_in_the_place_of_the_ball(files):
    """A box twice as high as wide, y up and without normals: 2 high, with sharp edges."""
    build = mesh_file.make_mesh_scene("cube.obj")
    made = build({"type": "diffuse"})["mesh"]
    low, high = (np.array(corner).ravel() for corner in (made.bbox().min, made.bbox().max))
    np.testing.assert_allclose(low, [-0.5, -0.5, 0], atol=1e-6)
    np.testing.assert_allclose(high, [0.5, 0.5, 2], atol=1e-6)
    import mitsuba as mi

    p = mi.Point3f([2.0, 0.1, 0.1], [0.2, -2.0, 0.2], [1.3, 1.2, 3.0])
    d = mi.Vector3f([-1.0, 0, 0], [0, 1.0, 0], [0, 0, -1.0])
    si = mi.load_dict({"type": "scene", "it": made}).ray_intersect(mi.Ray3f(p, d))
    np.testing.assert_allclose(np.array(si.sh_frame.n), -np.array(d), atol=1e-6)
    # brushed around the vertical axis: level on the sides
    np.testing.assert_allclose(np.array(si.sh_frame.s)[:, :2].T, [[0, 1, 0], [1, 0, 0]], atol=0.02)
    assert bk.render(WHITE, spp=1, size=32, scene="cube.obj").mask.mean() > 0.1


def tapered(top, order=(0, 1, 2), signs=(1, 1, 1)):
    """A frustum 3 high along y on a foot of side 2, with a `top` of another side; its axes turned
    as to `order`. An OBJ."""
    corners = [
        (s * x, y, s * z) for s, y in ((1, 0), (top / 2, 3)) for x in (-1, 1) for z in (-1, 1)
    ]
    turned = [[sign * c[k] for k, sign in zip(order, signs, strict=True)] for c in corners]
    faces = "1 2 4 3", "5 6 8 7", "1 2 6 5", "3 4 8 7", "1 3 7 5", "2 4 8 6"
    lines = [f"v {x} {y} {z}" for x, y, z in turned] + [f"f {face}" for face in faces]
    return "\n".join(lines)


Z_UP = {"order": (0, 2, 1), "signs": (1, -1, 1)}


@pytest.mark.parametrize(
    ("text", "given", "up"),
    [
        (tapered(0.5), "", "y"),
        (tapered(0.5, **Z_UP), "", "z"),
        (tapered(0.5, **Z_UP), "#y", "y"),
        (tapered(0.5, **Z_UP), "#z", "z"),
        (tapered(0.5, order=(1, 0, 2)), "#x", "x"),
        (tapered(0.5, order=(1, 0, 2)), "", "y"),  # neither y nor z: the custom
        (tapered(2), "", "y"),  # a box stands both ways
        (tapered(2, **Z_UP), "", "y"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "", "y"),  # a sheet stands neither way
    ],
)
def test_the_axis_that_points_up_is_given_or_guessed_where_it_is_obvious(tmp_path, text, given, up):
    """Upright it is 2 high; a guess that is not y is said."""
    file = tmp_path / "mesh.obj"
    file.write_text(text)
    guessed = pytest.warns(UserWarning, match="its axis z is taken to point up.*--up y")
    with guessed if (given, up) == ("", "z") else nullcontext():
        points, *_ = mesh_file.read_mesh(file, given[1:])
    expected = mesh_file.read_mesh(file, up)[0]
    np.testing.assert_array_equal(points, expected)
    if up == "x" or given == "#z":
        foot = points[points[:, 2] < 0.01]
        np.testing.assert_allclose(np.ptp(foot[:, :2], axis=0), 4 / 3, atol=1e-5)
        np.testing.assert_allclose(np.ptp(points[:, 2]), 2, atol=1e-5)


@pytest.mark.parametrize("unit", [1e-12, 1.0, 1e12])
def test_a_mesh_is_the_same_in_every_unit_and_way_to_write_it(files, unit):
    """Also beside a vertex of no face; with vertices counted backwards, between others."""
    lines = CUBE.splitlines()
    points = [[unit * float(x) for x in line.split()[1:]] for line in lines[:8]]
    vertices = [f"v {x!r} {y!r} {z!r}" for x, y, z in points]
    relative = [f"f {' '.join(str(int(i) - 9) for i in f.split()[1:])}" for f in lines[8:]]
    far = f"v {unit * 1e3!r} 0 0"
    expected = mesh_file.make_mesh_scene("cube.obj")({"type": "diffuse"})["mesh"]
    for text in ([*vertices, far, *lines[8:]], [far, *vertices, *relative, far]):
        Path("same.obj").write_text("\n".join(text))
        found = mesh_file.make_mesh_scene("same.obj")({"type": "diffuse"})["mesh"]
        for name in ("vertex_positions_buffer", "vertex_normals_buffer", "faces_buffer"):
            there, here = (np.array(getattr(m, name)()) for m in (expected, found))
            np.testing.assert_allclose(here, there, atol=1e-5)


@pytest.mark.parametrize("rows", [2, 3, 16])
def test_the_light_of_a_map_is_its_irradiance(files, rows):
    """Of radiance 1 from everywhere it is π, in a map of any number of rows."""
    import mitsuba as mi

    with use_two_threads():
        mi.Bitmap(np.ones((rows, 2 * rows, 3), np.float32)).write("white.exr")
    scale = environment.describe_environment("white.exr")["scale"]
    assert environment.ILLUMINANCE / scale == pytest.approx(np.pi, rel=1e-6)


def test_a_material_is_put_into_a_scene_file(files):
    both = bk.render([WHITE, BLACK], spp=8, scene="kitchen.xml#Counter")
    assert both.pictures["white"].shape == (16, 24, 3)  # the file's own
    changed = np.abs(both.differences["black"]).mean(axis=-1)
    assert np.percentile(changed[both.mask], 10) > 0.2
    assert np.median(changed[~both.mask]) < 0.05
    other = bk.render([WHITE], spp=1, size=(12, 8), scene=Path("room.xml"))
    assert other.pictures["white"].shape == (8, 12, 3)
    assert 0.1 < other.mask.mean() < 0.5


@pytest.mark.parametrize("file", [None, "grey.exr"])
def test_an_environment_map_lights_the_ground_as_the_sky_does(files, file):
    """Nothing stands on it: L = reflectance/π · E."""

    def empty(bsdf, size):
        found = _studio.make_studio(size)
        found = (
            environment.replace_light(environment.describe_environment(file), found)
            if file
            else found
        )
        return found | {"integrator": {"type": "direct"}}

    picture = luminance(bk.render(WHITE, spp=256, size=9, scene=empty).pictures["white"])
    expected = _studio.GROUND / np.pi * environment.ILLUMINANCE
    assert picture[3:6, 3:6].mean() == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"scene": "vaes"},
            r"no file or scene 'vaes'; did you mean vase\? There are ball, cornell_box",
        ),
        ({"scene": 3}, "scene = 3 should be the path of a file, or one of ball"),
        ({"scene": "missing.obj"}, r"missing\.obj: there is no such file"),
        ({"scene": "empty.obj"}, r"empty\.obj: the mesh has no faces"),
        ({"scene": "line.obj"}, r"line\.obj: the mesh has no faces, or none with an area"),
        ({"scene": "beyond.obj"}, r"beyond\.obj: Mitsuba cannot load it \(.*invalid vertex"),
        ({"scene": "beyond.ply"}, r"beyond\.ply: a face has a vertex that the mesh lacks"),
        ({"scene": "below.ply"}, r"below\.ply: "),
        ({"scene": lambda bsdf, size: None}, "The function for the scene gives NoneType; it shou"),
        ({"scene": lambda bsdf, size: {}}, "The scene has no sensor or no integrator"),
        ({"scene": "broken.ply"}, r"broken\.ply: Mitsuba cannot load it \(.*invalid PLY header"),
        ({"scene": "mesh.stl"}, r"mesh\.stl: a scene is a mesh \(\.obj, \.ply\), a scene file"),
        ({"scene": "missing.xml"}, r"missing\.xml: there is no such file"),
        ({"scene": "kitchen.xml"}, "no shape has a BSDF of the id 'material'.* are Counter, Floor"),
        ({"scene": "kitchen.xml#counter"}, r"did you mean kitchen\.xml#Counter\?"),
        ({"scene": "kitchen.xml#Counter", "environment": "grey.exr"}, "has lamps of its own"),
        ({"scene": "cornell_box", "environment": "grey.exr"}, "has lamps of its own"),
        ({"environment": "missing.exr"}, r"missing\.exr: there is no such file"),
        ({"environment": ""}, "environment map = '' should be the path of a file"),
        ({"environment": 3}, "environment map = 3 should be the path of a file"),
        ({"environment": "below_zero.exr"}, "the map has a value that is negative or not finite"),
        ({"environment": "inf.exr"}, "the map has a value that is negative or not finite"),
        ({"environment": "night.exr"}, r"night\.exr: the map gives no light from above"),
        ({"environment": "broken.ply"}, r"broken\.ply: Mitsuba cannot load it"),
    ],
)
def test_what_is_no_scene_is_said(files, arguments, message):
    with pytest.raises(BrdfkitError, match=message):
        bk.render(WHITE, spp=1, size=8, **arguments)


def test_a_gallery_has_a_row_for_each_material(tmp_path):
    rows = [[m, ("lambert", WHITE), ("ward", BLACK)] for m in (WHITE, BLACK)]
    found = bk.gallery(rows, spp=1, size=40)
    assert list(found.rows) == ["white", "black"]
    axes = draw_grid(found.rows).axes
    assert [a.get_title() for a in axes] == ["reference", "lambert", "ward", "", "", ""]
    assert [a.get_ylabel() for a in axes] == ["white", "", "", "black", "", ""]
    assert axes[4].get_xlabel() == f"{found.rows['black'].psnr()['lambert']:.1f} dB"
    found.write(tmp_path / "grid.png")
    assert (tmp_path / "grid.png").read_bytes()[:4] == b"\x89PNG"
    with pytest.raises(BrdfkitError, match=r"grid\.exr: a gallery is written as \.png"):
        found.write(tmp_path / "grid.exr")
    with pytest.raises(BrdfkitError, match="the same models: here are ggx, in the first row ward"):
        bk.gallery([[WHITE, "ward"], [BLACK, "ggx"]], spp=1, size=8)
    with pytest.raises(BrdfkitError, match="nothing to render"):
        bk.gallery([])
    for rows in (None, "car_paint"):
        with pytest.raises(BrdfkitError, match=f"materials = {rows!r} should be rows of materials"):
            bk.gallery(rows)


def test_names_are_drawn_as_they_are(tmp_path):
    """Dollars are no formulas, and a line's end does not stop the montage."""
    named = [("$x_{$", WHITE), ("two\nlines", BLACK)]
    found = bk.gallery([named], spp=1, size=16)
    found.write(tmp_path / "grid.png")
    assert [a.get_title() for a in draw_grid(found.rows).axes] == ["reference", "twolines"]
    bk.render(named, spp=1, size=16).write(tmp_path / "both.png")
