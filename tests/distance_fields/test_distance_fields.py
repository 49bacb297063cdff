"""Distance fields: their bounds, all forms of one tree, and where rays meet them."""

import re
import sys
from dataclasses import dataclass

import drjit as dr
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from brdfkit import BrdfkitError
from brdfkit import distance_fields as df
from brdfkit.core.jit import double_precision
from brdfkit.core.jit.double_precision import Vector
from brdfkit.distance_fields import parameters

# Random trees

size = st.floats(0.1, 1.0)
place = st.tuples(*[st.floats(-1.0, 1.0)] * 3)
direction = place.filter(lambda v: np.linalg.norm(v) > 0.1)
ends = st.tuples(place, place).filter(lambda e: np.linalg.norm(np.subtract(*e)) > 0.1)

SOLIDS = st.one_of(
    st.builds(df.plane, direction),
    st.builds(df.sphere, size),
    st.builds(df.box, st.tuples(size, size, size)),
    st.builds(lambda s, r: df.rounded_box(s, 0.5 * r * min(s)), st.tuples(size, size, size), size),
    st.builds(lambda r, t: df.torus(r, t * r), size, size),
    st.builds(lambda e, r: df.capsule(*e, r), ends, st.floats(0.0, 0.5)),
    st.builds(lambda e, r: df.capped_cylinder(*e, r), ends, size),
    st.builds(lambda e, a, b: df.capped_cone(*e, a, b), ends, size, st.floats(0.0, 1.0)),
)
k = st.one_of(st.just(0.0), size)
AWAY = st.tuples(st.floats(-9, 9), st.floats(-9, 9), st.just(0.0))


def larger(trees):
    two = st.tuples(trees, trees)
    return st.one_of(
        st.builds(df.union, two, k),
        st.builds(df.intersection, two, k),
        st.builds(df.difference, two, k),
        st.builds(df.dilate, trees, st.floats(-0.2, 0.3)),
        st.builds(df.shell, trees, size),
        st.builds(df.translate, trees, place),
        st.builds(df.rotate, trees, st.floats(-4, 4), direction),
        st.builds(df.scale, trees, st.floats(0.3, 3)),
        st.builds(df.circular_array, trees, st.integers(1, 7)),
        st.builds(df.circular_array, st.builds(df.translate, trees, AWAY), st.integers(3, 7)),
        st.builds(repeated, trees, st.sampled_from([None, 0, 1, 2]), st.floats(1.1, 2.0)),
    )


def repeated(tree, copies, room):
    """`tree` in a lattice along the axes in which it is bounded and not empty."""
    low, high = tree.bounds()
    reach = np.maximum(high, -low)
    fits = np.isfinite(reach) & (high > low) & (reach > 1e-3)
    return tree.repeat(tuple(np.where(fits, 2 * room * np.where(fits, reach, 1), 0)), copies)


TREES = st.recursive(SOLIDS, larger, max_leaves=4)


def values(field, points):
    """`field` at `points` (n, 3), as its call gives them, but by arrays that need no compiler."""
    import drjit as dr

    p = Vector(*(dr.scalar.ArrayXf64(np.ascontiguousarray(c)) for c in np.transpose(points)))
    return np.array(field.distance(p))


def around(field, n, seed):
    """Points in and about the box of a field."""
    low, high = np.clip(field.bounds(), -3, 3)
    centre, half = (low + high) / 2, np.abs(high - low) / 2 + 0.5
    return centre + half * np.random.default_rng(seed).uniform(-1, 1, (n, 3))


@settings(max_examples=80, deadline=None)
@given(TREES, st.integers(0, 2**32 - 1))
def test_no_tree_is_steeper_than_its_bound(field, seed):
    a = around(field, 400, seed)
    step = np.random.default_rng(seed).normal(size=a.shape)
    b = a + step * 10 ** np.linspace(-5, 0, len(a))[:, None]
    apart = np.linalg.norm(a - b, axis=1)
    change = np.abs(values(field, a) - values(field, b))
    assert (change <= field.lipschitz * apart * (1 + 1e-9) + 1e-12).all()


@settings(max_examples=60, deadline=None)
@given(TREES, st.integers(0, 2**32 - 1))
def test_what_is_not_above_a_level_lies_within_the_bounds_of_it(field, seed):
    points = around(field, 400, seed) * 1.5
    found = values(field, points)
    for level in (0.0, 0.3):
        low, high = field.bounds(level)
        within = points[found <= level]
        assert ((within >= low - 1e-9) & (within <= high + 1e-9)).all()


def gradients(field, points, step=1e-6):
    """Central differences of a field (n, 3)."""
    axes = np.eye(3) * step
    return np.stack([values(field, points + a) - values(field, points - a) for a in axes], 1) / (
        2 * step
    )


@settings(max_examples=60, deadline=None)
@given(TREES, st.integers(0, 2**32 - 1))
def test_what_is_called_exact_is_the_distance(field, seed):
    """A step by -f ∇f ends on the surface; the slope is 1 but where two ways are the shortest."""
    points = around(field, 400, seed)
    f = values(field, points)
    for exact, side in ((field.exact_outside, f > 1e-3), (field.exact_inside, f < -1e-3)):
        if not exact or side.sum() < 40:
            continue
        p, d, g = points[side], f[side], gradients(field, points[side])
        smooth = np.abs(np.linalg.norm(g, axis=1) - 1) < 1e-5
        assert smooth.mean() > 0.9
        end = p - d[:, None] * g
        assert np.abs(values(field, end)[smooth]).max() < 1e-4


@settings(max_examples=60, deadline=None)
@given(TREES, AWAY, st.integers(3, 7), st.integers(0, 2**32 - 1))
def test_a_circular_array_is_the_union_of_all_copies(child, offset, copies, seed):
    """Also where two of them are enough; within overlaps it is an estimate on both sides."""
    child = child.at(offset)
    array = child.circular_array(copies)
    points = around(array, 300, seed)
    alone = [values(child.rotate(k * array.sector), points) for k in range(copies)]
    found, expected = values(array, points), np.min(alone, axis=0)
    np.testing.assert_array_equal(found <= 0, expected <= 0)
    np.testing.assert_allclose(found[found > 0], expected[found > 0], rtol=1e-9, atol=1e-12)


@settings(max_examples=60, deadline=None)
@given(TREES, TREES, st.integers(0, 2**32 - 1))
def test_signs_are_those_of_sets(a, b, seed):
    points = around(a, 300, seed)
    in_a, in_b = (values(tree, points) <= 0 for tree in (a, b))
    found = [values(tree, points) <= 0 for tree in (a | b, a & b, a - b)]
    np.testing.assert_array_equal(found[0], in_a | in_b)
    np.testing.assert_array_equal(found[1], in_a & in_b)
    assert (found[2] == in_a & ~in_b).mean() > 0.99  # those at 0 are in neither


@settings(max_examples=30, deadline=None)
@given(TREES, st.integers(0, 2**32 - 1))
def test_a_convex_function_lies_above_its_tangents(field, seed):
    points = around(field, 300, seed)
    if field.is_convex:
        p, q = points[:150], points[150:]
        below = values(field, (p + q) / 2) - (values(field, p) + values(field, q)) / 2
        assert below.max() < 1e-12


# One tree of all kinds, in all forms


def everything():
    """A field with every kind of node but functions of the user's, which no file holds."""
    rods = df.capsule((-1, 0, 0), (1, 0.2, 0), 0.2) | df.capped_cylinder((0, -1, 0), (0, 1, 0), 0.3)
    cone = df.capped_cone((0, 0, -1), (0, 0, 1.2), 0.4, 0.1).rotate(0.7, (1, 2, 0.5))
    solids = df.box((1, 0.8, 1.2)).at(0.7, 0, 0) & df.sphere(0.8).at(0.6, 0.1, 0).k(0.2)
    rounded = df.rounded_box((0.6, 0.5, 0.4), 0.1).shell(0.05).repeat((1.2, 0, 0), 1)
    bulb = df.mandelbulb(8, 2).scale(0.5).at(0, 0, 1.2)
    below = df.plane((0.1, 0, 1)).at(0, 0, -0.9) & df.box(2)
    ring = df.torus(0.4, 0.1).at(0.6, -0.8, 0.5)
    sampled = df.torus(0.6, 0.2).to_grid(12).at(-0.5, 0.9, 0.3)
    hole = df.sphere(0.3).at(0, 0, 0.4)
    crown = df.capsule((0.5, 0, 0), (0.6, 0.1, 0.3), 0.05).circular_array(7, 0.2)
    whole = (
        crown.at(-0.8, -0.6, -0.5)
        | rods
        | cone
        | solids
        | rounded.at(0, 1.2, 0)
        | bulb
        | below
        | ring
        | sampled
    )
    return whole.dilate(0.02) - hole.made_of("felt").k(0.1)


def points_about(n=200):
    return np.random.default_rng(5).uniform(-1.5, 1.5, (n, 3))


def walk(node):
    return {node.kind}.union(*(walk(child) for child in node.children))


def test_the_tree_has_every_kind():
    own = {n for n, cls in parameters._KINDS.items() if cls.__module__.startswith("brdfkit.")}
    assert walk(everything()) == own - {"function"}


def test_numpy_and_dr_jit_agree(llvm_variant):
    mi, field, points = llvm_variant, everything(), points_about()
    single = np.array(field.distance(mi.Point3f(points.T.astype(np.float32))))
    assert single.dtype == np.float32
    np.testing.assert_allclose(single, field(points), atol=2e-5)
    np.testing.assert_allclose(values(field, points), field(points), atol=1e-12)


def test_numbers_do_as_well(llvm_variant):
    point = llvm_variant.ScalarPoint3f(0.3, -0.4, 1.1)
    assert everything().distance(point) == pytest.approx(everything()([list(point)])[0], abs=1e-6)


LINE = re.compile(r"    (float|int|bool) (v\d+) = (.+);")
GLSL = {
    "sqrt": np.sqrt, "abs": np.abs, "min": np.minimum, "max": np.maximum, "clamp": np.clip,
    "floor": np.floor, "sin": np.sin, "cos": np.cos, "acos": np.arccos, "atan": np.arctan2,
    "log": np.log, "pow": np.power, "int": lambda a: a.astype(int),
}  # fmt: skip


def run_glsl(source, points, textures):
    """The values of a function of GLSL that declares each name once, and only what it knows."""
    names = dict(GLSL) | {"p": Vector(*points.T)}
    for n, grid in enumerate(textures):
        names[f"grid_{n}"] = grid.values
    names["fetch"] = lambda values, i, j, k: values[k, j, i]
    *lines, last = source[source.index("{") + 2 : source.rindex("}")].splitlines()
    for line in lines:
        kind, name, code = LINE.fullmatch(line).groups()
        assert name not in names
        code = re.sub(r"texelFetch\((\w+), ivec3\((.+)\), 0\)\.r", r"fetch(\1, \2)", code)
        code = re.sub(r"(\S+) \? (\S+) : (\S+)", r"choose(\1, \2, \3)", code).replace("&&", "&")
        names[name] = eval(code, {"__builtins__": {}, "choose": np.where}, names)
        expected = {"float": "f", "int": "i", "bool": "b"}[kind]
        assert np.asarray(names[name]).dtype.kind == expected, line
    return names[re.fullmatch(r"    return (\w+);", last)[1]]


def grids(node):
    own = [node] if node.kind == "grid" else []
    return sum((grids(child) for child in node.children), own)


def test_glsl_computes_the_same():
    field, points = everything(), points_about()
    source = field.to_glsl("scene")
    assert source.startswith("uniform sampler3D grid_0;")
    assert "float scene(vec3 p) {" in source
    np.testing.assert_allclose(run_glsl(source, points, grids(field)), field(points), atol=1e-12)


def test_a_grid_differs_by_its_bound_at_most():
    field = everything()
    sampled = field.to_grid(40, ((-1.5,) * 3, (1.5,) * 3))
    error = np.abs(sampled(points_about(4000)) - field(points_about(4000))).max()
    assert 0.01 < error <= field.lipschitz * sampled.half_diagonal


def test_a_grid_has_its_values_at_the_corners_as_mitsubas(llvm_variant):
    """The first hits of its `sdfgrid`, by another way."""
    import drjit as dr

    mi, ring = llvm_variant, df.torus(0.3, 0.12).at(0.5, 0.5, 0.5)
    field = ring.to_grid(20, ((0, 0, 0), (1, 1, 1)))
    theirs = mi.TensorXf(field.values[..., None].astype(np.float32))
    scene = mi.load_dict({"type": "scene", "ring": {"type": "sdfgrid", "grid": theirs}})
    rng = np.random.default_rng(0)
    d = mi.Vector3f((rng.uniform(0.2, 0.8, (1000, 3)) - [0.5, 0.5, 2.0]).T.astype(np.float32))
    ray = mi.Ray3f(mi.Point3f(0.5, 0.5, 2.0), dr.normalize(d))
    expected = np.array(scene.ray_intersect_preliminary(ray).t)
    found = df.cone_trace(
        field.distance, ray.o, ray.d, 5.0, lipschitz=field.lipschitz, precision=1e-5
    )
    hits = np.isfinite(expected) & np.array(found.found)
    assert hits.sum() > 300
    assert (np.isfinite(expected) != np.array(found.found)).mean() < 0.01
    np.testing.assert_allclose(np.array(found.t)[hits], expected[hits], atol=1e-3)


def test_vertices_of_a_mesh_lie_on_the_surface_and_f_never_overstates():
    field = everything()
    box = ((-2,) * 3, (2,) * 3)
    mesh = df.to_mesh(field, 48, box)
    cell = 4 / 48
    assert np.abs(field(mesh.vertices)).max() <= field.lipschitz * cell / 2
    points = points_about(2000)
    away, _ = cKDTree(mesh.vertices[mesh.faces].mean(axis=1)).query(points)
    assert (np.abs(field(points)) / field.lipschitz <= away + cell).all()
    one, two, three = (
        df.to_mesh(df.sphere(1), 24).vertices[c] for c in df.to_mesh(df.sphere(1), 24).faces.T
    )
    outward = np.einsum("ij,ij->i", np.cross(two - one, three - one), one)
    assert (outward > 0).all()


def test_a_mesh_becomes_a_grid(tmp_path):
    pytest.importorskip("igl")
    solid = df.rounded_box((1, 2, 1.5), 0.2).at(0.3, 0, 0)
    mesh = solid.to_mesh(48)
    mesh.write(tmp_path / "solid.ply")
    sampled = df.from_mesh(tmp_path / "solid.ply", 32)
    points = np.random.default_rng(0).uniform(sampled.low, sampled.high, (2000, 3))
    error = np.abs(sampled(points) - solid(points)).max()
    assert error <= sampled.half_diagonal + 0.02  # and the mesh is less round than the solid
    assert ((sampled(points) < 0) == (solid(points) < 0)).mean() > 0.99


def test_json_is_the_same_field(tmp_path):
    field = everything()
    again = df.from_json(field.to_json())
    assert again.to_json() == field.to_json()
    np.testing.assert_array_equal(again(points_about()), field(points_about()))
    field.save(tmp_path / "scene.json")
    assert df.load(tmp_path / "scene.json").to_json() == field.to_json()
    endless = df.sphere(0.3).repeat(1)
    assert df.from_json(endless.to_json())([[7, 0, 0]]) == -0.3


def test_what_is_printed_makes_the_field():
    field = df.sphere(1) | df.box(2).at(1, 0, 0) | (df.torus(1, 0.2) - df.plane()).k(0.1)
    assert repr(df.sphere(1) | df.box(2).at(1, 0, 0)) == (
        "sphere(1) | box((2, 2, 2)).translate((1, 0, 0))"
    )
    again = eval(repr(field), {name: getattr(df, name) for name in dir(df)})
    assert again.to_json() == field.to_json()
    assert len(df.sphere().to_grid(4).__repr__()) < 80


# Derivatives


def test_derivatives_by_all_parameters_are_those_of_differences():
    """Of f near the surface, along one direction in the space of all numbers that make the field.

    (Further off, the bounds of repetition count, which have no derivatives.)
    """
    import drjit as dr

    if not double_precision.has_derivatives():
        pytest.skip("no derivatives here")
    field, points, t = everything(), points_about(1000), double_precision.to_scalar(0.0)
    for _ in range(3):
        points = points - values(field, points)[:, None] * gradients(field, points)
    points = points[np.abs(values(field, points)) < 0.01]
    assert len(points) > 500
    dr.enable_grad(t)
    f = moved(field, t).distance(double_precision.to_vector(points))
    dr.forward(t)
    low, middle, high = (values(moved(field, h), points) for h in (-1e-6, 0.0, 1e-6))
    smooth = np.abs(high - 2 * middle + low) < 1e-9
    assert smooth.mean() > 0.9
    difference = (high - low) / 2e-6
    np.testing.assert_allclose(np.array(dr.grad(f))[smooth], difference[smooth], atol=1e-4)
    assert (difference != 0).all()  # every point feels some of it


def moved(field, t):
    """A field whose parameters go at `t` times random speeds; what is 0 stays, as sharp edges."""
    rng = np.random.default_rng(2)
    return field.with_parameters({n: shifted(v, t, rng) for n, v in field.parameters().items()})


def shifted(value, t, rng):
    import drjit as dr

    if isinstance(value, tuple):
        return tuple(shifted(v, t, rng) for v in value)
    speed = np.where(value == 0, 0, rng.normal(size=np.shape(value)))
    if not dr.is_array_v(t):
        return value + speed * t
    if np.ndim(value) == 0:
        return value + float(speed) * t if speed else value
    tensor = dr.tensor_t(type(t))
    return tensor(tensor(value).array + tensor(speed).array * t, value.shape)


# Rays


def rays(mi, n=500, seed=0):
    """Rays from a sphere of radius 3 towards points near the origin, and NumPy's of the same."""
    rng = np.random.default_rng(seed)
    o = rng.normal(size=(n, 3))
    o *= 3 / np.linalg.norm(o, axis=1, keepdims=True)
    d = rng.uniform(-1, 1, (n, 3)) - o
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    return mi.Point3f(o.T.astype(np.float32)), mi.Vector3f(d.T.astype(np.float32)), o, d


def sphere_hits(o, d, radius=0.8):
    b, c = (o * d).sum(1), (o * o).sum(1) - radius**2
    with np.errstate(invalid="ignore"):
        return -b - np.sqrt(b * b - c)


def plane_hits(o, d):
    return np.where((o[:, 2] > 0) & (d[:, 2] < 0), -o[:, 2] / d[:, 2], np.nan)


def torus_hits(o, d, radius=0.7, tube=0.25):
    """The least root of (|x|² + R² - r²)² = 4 R² (x² + y²) along each ray."""
    found = []
    for p, v in zip(o, d, strict=True):
        square = np.polynomial.Polynomial([p @ p + radius**2 - tube**2, 2 * p @ v, 1.0])
        flat = np.polynomial.Polynomial([p[:2] @ p[:2], 2 * p[:2] @ v[:2], v[:2] @ v[:2]])
        roots = (square**2 - 4 * radius**2 * flat).roots()
        real = roots.real[(np.abs(roots.imag) < 1e-7) & (roots.real > 0)]
        found.append(real.min() if len(real) else np.nan)
    return np.array(found)


SHAPES = {
    "sphere": (df.sphere(0.8), sphere_hits),
    "plane": (df.plane(), plane_hits),
    "torus": (df.torus(0.7, 0.25), torus_hits),
}


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("way", ["cone_trace", "raymarch"])
def test_first_hits_are_those_of_formulas(llvm_variant, name, way):
    field, formula = SHAPES[name]
    o, d, *plain_rays = rays(llvm_variant)
    given = (0.02,) if way == "raymarch" else ()
    hit = getattr(df, way)(field.distance, o, d, 20.0, *given)
    expected = formula(*plain_rays)
    upper = np.ones(len(expected), bool) if name != "plane" else plain_rays[0][:, 2] > 0
    found = np.array(hit.found)[upper]
    expected = expected[upper]
    assert (found == np.isfinite(expected) & (expected < 20)).mean() > 0.985  # others graze it
    both = found & np.isfinite(expected)
    assert both.sum() > 100
    error = np.abs(np.array(hit.t)[upper] - expected)[both]
    assert np.quantile(error, 0.95) < 1e-3


def test_no_pixel_misses_a_segment(llvm_variant):
    """A line without width: each pixel that it crosses finds it, where single rays pass by."""
    mi, pixels, fov = llvm_variant, 24, 40.0
    line = df.capsule((-0.9, -0.31, 0.2), (0.8, 0.4, -0.1), 0.0)
    centres = (np.arange(pixels) + 0.5) / pixels * 2 - 1
    u, v = (c.ravel() * np.tan(np.radians(fov / 2)) for c in np.meshgrid(centres, centres))
    d = np.stack([u, v, -np.ones_like(u)])
    d = mi.Vector3f((d / np.linalg.norm(d, axis=0)).astype(np.float32))
    o = mi.Point3f(0, 0, 3)
    tangent = df.pixel_tangent(fov, pixels)
    cones = df.cone_trace(line.distance, o, d, 10.0, tangent=tangent, slack=0.25)
    axes = df.cone_trace(line.distance, o, d, 10.0)
    on_line = np.linspace(line.a, line.b, 2000)
    seen = on_line[:, :2] / (3 - on_line[:, 2:]) / np.tan(np.radians(fov / 2))
    column, row = np.floor((seen + 1) / 2 * pixels).astype(int).T
    crossed = np.zeros((pixels, pixels), bool)
    crossed[row, column] = True
    assert np.array(cones.found)[crossed.ravel()].all()
    assert np.array(axes.found).sum() < 0.2 * crossed.sum()
    assert crossed.sum() < np.array(cones.found).sum() < 3 * crossed.sum()
    ball = np.array(cones.distance)[np.array(cones.found)]  # about as large as a pixel there
    assert (ball < 1.3 * 4 * tangent).all()


def test_hits_move_with_the_parameters(llvm_variant):
    """dt by the radius, and by a grid's values, as by differences of traced hits."""
    import drjit as dr

    mi = llvm_variant
    o, d = mi.Point3f([0.1, 0.3, -0.2], [0.2, 0.4, 0.1], 3), mi.Vector3f(0, 0, -1)
    radius = mi.Float(1.0)
    dr.enable_grad(radius)
    ball = df.sphere(1).with_parameters({"sphere.radius": radius})
    hit = df.cone_trace(ball.distance, o, d, 10.0)
    dr.backward(dr.sum(df.reattach(ball.distance, o, d, hit.t)))
    z = 3 - np.array(hit.t)
    assert np.array(dr.grad(radius))[0] == pytest.approx(-(1 / z).sum(), rel=1e-3)

    grid = df.sphere(1).to_grid(10)
    tensor = mi.TensorXf(grid.values.astype(np.float32))
    dr.enable_grad(tensor)
    moved = grid.with_parameters({"grid.values": tensor})
    hit = df.raymarch(moved.distance, o, d, 10.0, 0.1)
    dr.backward(dr.sum(df.reattach(moved.distance, o, d, hit.t)))
    up = grid.with_parameters({"grid.values": grid.values + 1e-3})
    shifted = df.raymarch(up.distance, o, d, 10.0, 0.1)
    difference = (np.array(shifted.t) - np.array(hit.t)).sum() / 1e-3
    assert np.array(dr.grad(tensor)).sum() == pytest.approx(difference, rel=0.01)


def test_normals_are_gradients(llvm_variant):
    mi, field = llvm_variant, df.torus(0.7, 0.25) | df.box(0.5).rotate(0.4, (1, 1, 0)).at(1, 0, 0)
    points = points_about(300)
    p = mi.Point3f(points.T.astype(np.float32))
    found = np.array(df.normal(field.distance, p)).T
    expected = gradients(field, points)
    smooth = np.abs(np.linalg.norm(expected, axis=1) - 1) < 1e-4
    error = np.linalg.norm(found - expected, axis=1)[smooth]
    assert np.quantile(error, 0.95) < 0.01


def test_a_field_is_met_within_its_box(llvm_variant):
    """As without one, also by rays that start in it; the copies' radius is an array of Dr.Jit's."""
    import drjit as dr

    mi = llvm_variant
    radius = dr.opaque(mi.Float, 0.3)
    dr.enable_grad(radius)
    field = df.sphere(0.3).repeat(1, 1).with_parameters({"repeat.sphere.radius": radius})
    o, d, *_ = rays(mi, 2000)
    o = o * mi.Float(np.linspace(0.2, 1, 2000))
    near, everywhere = (
        df.intersect(field, o, d, 9.0),
        df.cone_trace(field.distance, o, d, 9.0, steps=4096),
    )
    found = np.array(near.found)
    assert (found == np.array(everywhere.found)).mean() > 0.995
    both = found & np.array(everywhere.found)
    assert np.quantile(np.abs(np.array(near.t) - np.array(everywhere.t))[both], 0.95) < 1e-3
    t = df.reattach(field.distance, o, d, near.t)
    dr.forward(radius)
    p = np.array(o + d * near.t).T
    n = p - np.round(p)
    expected = 0.3 / (n * np.array(d).T).sum(axis=1)
    steep = both & (np.abs(expected) < 3) & (np.array(near.t) > 0.01)
    assert steep.sum() > 500
    np.testing.assert_allclose(np.array(dr.grad(t))[steep], expected[steep], rtol=0.03)


def test_a_field_that_is_no_number_is_met_by_no_ray(llvm_variant):
    mi = llvm_variant
    o, d = mi.Point3f(0, 0, 3), mi.Vector3f(0, 0, -1)
    assert not np.array(df.cone_trace(lambda p: p.x * np.nan, o, d, 9.0).found).any()


def test_the_mandelbulb_is_nearer_than_a_third_of_its_estimate_says():
    """Nothing is proven for it: L against distances to points of its surface, by bisection."""
    bulb, rng = df.mandelbulb(), np.random.default_rng(0)
    d = rng.normal(size=(30_000, 3))
    d /= np.linalg.norm(d, axis=1, keepdims=True)
    low, high = np.zeros(len(d)), np.full(len(d), 1.2)
    for _ in range(20):
        middle = (low + high) / 2
        outside = bulb(d * middle[:, None]) > 0
        low, high = np.where(outside, low, middle), np.where(outside, middle, high)
    points = rng.uniform(-1.3, 1.3, (5000, 3))
    away, _ = cKDTree(d * high[:, None]).query(points)
    f = bulb(points)
    assert (f / bulb.lipschitz <= away).all()
    assert np.median((f / away)[f > 0.1]) > 0.7  # and it is not far from right


@pytest.mark.parametrize("way", ["cone_trace", "raymarch"])
def test_rays_of_numbers_are_traced(way):
    import mitsuba as mi

    given = (0.02,) if way == "raymarch" else ()
    o, d = mi.ScalarPoint3f(0, 0, 3), mi.ScalarVector3f(0, 0, -1)
    hit = getattr(df, way)(df.sphere(1).distance, o, d, 10.0, *given)
    assert hit.found
    assert hit.t == pytest.approx(2, abs=1e-3)


# What is wrong


def bad_slope(p):
    return 3.0 * p.x


def bad_hole(p):
    import drjit as dr

    return dr.sqrt(p.x)


def open_mesh():
    vertices, faces = df.to_mesh(df.sphere(1), 8)
    return df.from_mesh((vertices, faces[1:]))


WRONG = {
    "slope": (lambda: df.check(bad_slope, (0, 0, 0), (1, 1, 1)), r"changes by 3 per unit near \("),
    "nan": (lambda: df.check(bad_hole, (-1, 0, 0), (0, 1, 1)), r"the field is nan at \("),
    "nothing": (lambda: df.union(()), "union: it has no children"),
    "no surface": (
        lambda: (df.sphere(1) & df.sphere(1).at(3, 0, 0)).to_grid(8),
        "no surface in it",
    ),
    "all outside": (lambda: df.sphere(1).to_grid(8, ((2, 2, 2), (3, 3, 3))), "is all outside"),
    "no cells": (lambda: df.sphere(1).to_grid(0), "resolution = 0 should be a whole number"),
    "no corners": (lambda: df.sphere(1).to_grid(8, (1, 2)), r"\(1, 2\) should be two corners"),
    "no list": (lambda: df.union(df.sphere(1), df.box(1)), "give the fields as one list"),
    "slope of a node": (lambda: df.check(df.mandelbulb(), (0, 0, 0), (1, 1, 1)), "its bound 3"),
    "endless": (lambda: df.plane().to_grid(8), "is unbounded; give bounds"),
    "open mesh": (open_mesh, "not closed: 3 edges"),
    "no such node": (lambda: df.from_json('{"kind": "spere"}', "a.json"), "a.json: .*mean sphere"),
    "no such number": (
        lambda: df.from_json('{"kind": "sphere", "raduis": 1}', "a.json"),
        "a.json: .*mean radius",
    ),
    "no kind": (lambda: df.from_json("[1]"), 'should be an object with a "kind"'),
    "kind of no name": (lambda: df.from_json('{"kind": ["box"]}'), "there is no node"),
    "nested deeply": (lambda: df.from_json('{"child":' * 20_000), "this is not JSON"),
    "no text": (lambda: df.from_json(None), "this is not JSON"),
    "huge": (lambda: df.sphere(10**400), "should be a number"),
    "no JSON": (lambda: df.from_json("{", "a.json"), "a.json: this is not JSON"),
    "bad child": (lambda: df.from_json('{"kind": "shell"}'), "shell needs child"),
    "bad value": (
        lambda: df.from_json('{"kind": "sphere", "radius": -1}', "a"),
        "a: sphere.radius",
    ),
    "no number": (lambda: df.sphere("a"), "sphere.radius = 'a' should be a number above 0"),
    "infinite": (lambda: df.box((1, np.inf, 1)), r"box.size\[1\] = inf"),
    "no triple": (lambda: df.sphere(1).translate(1), "translate.offset = 1 should be three"),
    "no field": (lambda: df.sphere(1) | 2, "2 should be a distance field"),
    "one point": (lambda: df.capsule((0, 0, 0), (0, 0, 0)), "a and b are the same point"),
    "too round": (lambda: df.rounded_box(1, 0.6), "at most half of the shortest edge, 0.5"),
    "no room": (lambda: df.sphere(0.5).repeat(1), "from -0.5 to 0.5 along x"),
    "no parameter": (lambda: df.sphere(1).with_parameters({"radius": 1}), "mean sphere.radius"),
    "points": (lambda: df.sphere(1)([1, 2, 3]), r"shape \(3,\); it should be \(n, 3\)"),
    "grid of nan": (lambda: df.grid(np.full((2, 2, 2), np.nan)), "not finite at"),
    "ragged grid": (lambda: df.grid([[[1, 2], [1]]]), "numbers, in rows of one length"),
    "flat grid": (lambda: df.grid(np.ones((2, 2))), r"should be \(z, y, x\)"),
    "name": (lambda: df.sphere(1).to_glsl("a b"), "should be a word"),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_is_said(what):
    call, said = WRONG[what]
    if "mesh" in what:
        pytest.importorskip("igl")
    with pytest.raises(BrdfkitError, match=said) as error:
        call()
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("library", ["skimage.measure", "igl"])
def test_a_library_that_is_missing_is_named(library, monkeypatch):
    monkeypatch.setitem(sys.modules, library, None)
    call = df.from_mesh if library == "igl" else df.to_mesh
    with pytest.raises(BrdfkitError, match=r'pip install "brdfkit\[distance_fields\]"'):
        call(df.sphere(1))


# Python of the user's


def ball(p):
    return dr.sqrt(p.x * p.x + p.y * p.y + p.z * p.z) - 1


def numpy_ball(points):
    return np.linalg.norm(points, axis=-1) - 1


BOX = (-1.5, -1.5, -1.5), (1.5, 1.5, 1.5)


@pytest.mark.parametrize(("f", "near"), [(ball, 1e-12), (numpy_ball, 0.01)])
def test_a_function_of_points_is_a_field(f, near, tmp_path):
    field = df.from_function(f, bounds=BOX, resolution=64)
    points = np.random.default_rng(0).uniform(-1.4, 1.4, (100, 3))
    np.testing.assert_allclose(field(points), df.sphere(1)(points), atol=near)
    again = df.from_json((field.at(1, 0, 0) | df.sphere(0.1)).to_json())  # as for the integrator
    np.testing.assert_array_equal(again.children[0](points), field.at(1, 0, 0)(points))
    if f is numpy_ball:
        field.save(tmp_path / "ball.json")
        np.testing.assert_allclose(df.load(tmp_path / "ball.json")(points), field(points))


@dataclass(frozen=True, eq=False, repr=False)
class my_ball(df.Node):
    def distance(self, p):
        return ball(p)


@pytest.mark.parametrize("part", [my_ball(), df.from_function(ball)])
def test_python_of_the_users_is_not_saved_but_a_grid_of_it_is(part, tmp_path):
    file = tmp_path / "field.json"
    field = df.sphere(0.5) | part.at(0.1, 0, 0).k(0.1)
    with pytest.raises(BrdfkitError, match=r"field.json: the field contains .* Python of your own"):
        field.save(file)
    assert not list(tmp_path.iterdir())
    field.to_grid(8, BOX).save(file)
    df.load(file)


@pytest.mark.parametrize(
    ("f", "how", "said"),
    [
        (numpy_ball, {}, "numpy_ball works on NumPy's arrays.*from_function.*bounds="),
        (lambda p: "x", {}, r"is not a function of points .*; it should take points p with p\.x"),
        (lambda p: np.ones((3, 3)), {}, r"gives \(3, 3\) for 2 points"),
        (3, {}, "3 is not a function; it should take"),
        (ball, {"lipschitz": 0}, "lipschitz = 0 should be a number above 0"),
        (ball, {"bounds": 3}, "bounds = 3 should be two corners"),
    ],
)
def test_what_is_no_function_of_points_is_said(f, how, said):
    with pytest.raises(BrdfkitError, match=said):
        df.from_function(f, **how)
