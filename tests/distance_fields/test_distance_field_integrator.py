"""The integrator of distance fields: light as in Mitsuba, every shadow, derivatives, bad input."""

import re

import drjit as dr
import numpy as np
import pytest

import brdfkit as bk
from brdfkit import BrdfkitError
from brdfkit.distance_fields import box, from_function, plane, sphere, torus
from brdfkit.distance_fields import parameters as kinds
from brdfkit.distance_fields.shading.direct_light import DirectLight
from brdfkit.rendering.progressive import Progressive

GREY = {"type": "diffuse", "reflectance": 0.5}
BALL = {"type": "sphere", "center": [2, 0, 3], "radius": 0.6}
POINT = {"type": "point", "position": [2, 0, 3], "intensity": 9.0}
SHADED = plane() | box(0.7).at(0.5, 0, 1)  # a cube above the ground, out of view; its shadow is not


@pytest.fixture
def mi(llvm_variant):
    return llvm_variant


def lit(shape):
    return {**shape, "emitter": {"type": "area", "radiance": 10.0}}


def scene(mi, node, light, size=24, view=([-1, 0, 0.4], [-0.5, 0, 0]), unit=1, **integrator):
    """The ground about the origin from above, without what casts the shadow; a lamp, or several."""
    given = {"bsdf": GREY, "field": node.to_json()}
    camera = mi.ScalarTransform4f().look_at(*(unit * np.array(view)).tolist(), [0, 0, 1])
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}}
    clips = {"near_clip": 0.01 * unit, "far_clip": 1e4 * unit}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "distance_field", **given, **integrator},
            "sensor": {"type": "perspective", "fov": 60, "to_world": camera, **clips, "film": film},
            **(light if "type" not in light else {"lamp": light}),
        }
    )


def picture(mi, field, light, spp=4, **settings):
    return np.array(mi.render(scene(mi, field, light, **settings), spp=spp), float)


# Light


def test_light_falls_as_in_mitsuba(mi):
    """A ground with a small ball on it, and the same shapes in Mitsuba's `direct`; each lamp."""
    t = mi.ScalarTransform4f
    turned = t().look_at([2, 0, 3], [0, 0, 0], [0, 1, 0]).scale([0.5, 0.3, 1])
    sky = {"type": "constant", "radiance": 0.7}
    lamps = [
        (lit(BALL), {}, 0.01), (lit(BALL), {"shading": "estimated"}, 0.01),
        (lit({"type": "rectangle", "to_world": turned}), {"shading": "estimated"}, 0.01),
        (lit({"type": "disk", "to_world": turned}), {"shading": "exact"}, 0.01),
        (POINT, {}, 0.005), (sky, {}, 0.01),
        ({"type": "directional", "direction": [-2, 0.3, -3], "irradiance": 2.0}, {}, 0.005),
    ]  # fmt: skip
    field = plane() | sphere(0.1).at(-0.6, 0.05, 0.1)
    for lamp, settings, tolerance in lamps:
        ours = scene(mi, field, lamp, **settings)
        given = {
            "type": "scene",
            "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0},
            "sensor": ours.sensors()[0],
            "lamp": lamp,
            "ground": {"type": "rectangle", "to_world": t().scale(50), "bsdf": GREY},
            "ball": {"type": "sphere", "center": [-0.6, 0.05, 0.1], "radius": 0.1, "bsdf": GREY},
        }
        found, known = (np.array(mi.render(s, spp=64)) for s in (ours, mi.load_dict(given)))
        assert found.mean() == pytest.approx(known.mean(), rel=tolerance), (lamp["type"], settings)


def test_the_unit_of_length_does_not_matter(mi):
    """A ball on the ground, its soft shadow, and the sky; in metres, in kilometres, in microns."""
    means = []
    for unit in (1, 1e4, 1e-5):
        field = plane() | sphere(0.3 * unit).at(-0.5 * unit, 0, 0.3 * unit)
        lamp = lit({"type": "sphere", "center": [0, unit, 2 * unit], "radius": 0.4 * unit})
        means.append(picture(mi, field, lamp, unit=unit).mean())
    np.testing.assert_allclose(means[1:], means[0], rtol=1e-3)


def test_large_pixels_are_as_light_as_small_ones(mi):
    """A cone of one sample ends far above the ground, which is lit nevertheless."""
    low, high = (picture(mi, plane(), POINT, spp=spp, size=12).mean() for spp in (1, 256))
    assert low == pytest.approx(high, rel=0.02)  # where the cone ends, it is 8 % lighter


def test_sharp_edges_do_not_glint(mi):
    """A cube of shiny metal, none of whose faces mirrors the lamp, as in Mitsuba's `direct`."""
    metal = {"type": "roughconductor", "alpha": 0.3, "distribution": "ggx"}
    lamp = {**POINT, "position": [2, -1, 4]}
    view = [0.5, -4, 2.5], [0, 0, 0]
    ours = scene(mi, box(1).rotate(np.radians(35)), lamp, view=view, bsdf=metal)
    turned = mi.ScalarTransform4f().rotate([0, 0, 1], 35).scale(0.5)
    given = {"type": "scene", "integrator": {"type": "direct"}, "sensor": ours.sensors()[0]}
    cube = {"type": "cube", "to_world": turned, "bsdf": metal}
    theirs = mi.load_dict({**given, "lamp": lamp, "cube": cube})
    found, known = (np.array(mi.render(s, spp=256)).mean() for s in (ours, theirs))
    assert found == pytest.approx(known, rel=0.05)  # by the normals of the cones 13 % more


@pytest.mark.parametrize("bsdf", ["conductor", "roughconductor", "ggx"])
def test_a_sky_with_a_sun_in_what_shines(mi, bsdf):
    """A ball under a map, without its lamp: as in Mitsuba's `direct`, also where it is a mirror."""
    texels = np.full((16, 32, 3), 0.2, np.float32)
    texels[4:7, 8:16] = 4
    sky = {"type": "envmap", "bitmap": mi.Bitmap(texels)}
    shiny = {"type": bsdf, "alpha": 0.05} if bsdf == "roughconductor" else {"type": bsdf}
    view = [0, -3, 2], [0, 0, 0]
    given = {"view": view, "bsdf": shiny, "samples": 1}
    ours = scene(mi, sphere(1), sky, **given)
    known = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "direct"},
            "sensor": ours.sensors()[0],
            "sky": sky,
            "ball": {"type": "sphere", "bsdf": shiny},
        }
    )
    found, known = (np.array(mi.render(s, spp=1024))[8:16, 8:16] for s in (ours, known))
    assert found.mean() == pytest.approx(known.mean(), rel=0.02)


def test_shadows_beside_the_truth(mi):
    """Of the light that a method finds too much or too little; the rivals are far too dark."""
    light = lit(BALL)
    truth = picture(mi, SHADED, light, shading="exact", spp=256).mean()
    whole = picture(mi, SHADED, light, shadow="none").mean()

    def error(**settings):
        return (picture(mi, SHADED, light, spp=16, **settings).mean() - truth) / whole

    assert truth < 0.3 * whole
    assert abs(error(shadow="monte_carlo")) < 0.01
    for shadow in ("linear", "base", "discrete", "convex", "split"):
        assert abs(error(shadow=shadow)) < 0.05, shadow
    assert abs(error(direction="B")) < 0.05
    assert abs(error(shading="estimated")) < 0.05
    for shadow in ("hard", "quilez", "aaltonen"):
        assert error(shadow=shadow) < -0.025, shadow


def test_parts_have_their_bsdfs(mi):
    """Looked at from above: a named ball, one without a name, and the ground between them."""
    field = (
        plane().made_of("chalk")
        | sphere(0.2).at(-0.7, 0, 0.2).scale(1.2)
        | (sphere(2).made_of("coal") - box(1)).scale(0.1).rotate(0.5).at(-0.2, 0, 0.2)
    )
    bsdfs = {
        name: {"type": "diffuse", "reflectance": value}
        for name, value in {"chalk": 0.8, "coal": 0.1, "bsdf": 0.4}.items()
    }
    loaded = scene(mi, field, {"type": "constant", "radiance": 1.0}, **bsdfs)
    parts, now = loaded.integrator().parts, loaded.integrator().now
    where = mi.Point3f([-0.84, -0.2, 0.5], [0, 0, 0.1], [0.48, 0.4, 0])
    found = parts.find_bsdf(now, loaded.integrator().larger, where)
    si = dr.zeros(mi.SurfaceInteraction3f, 3)
    albedo = found.eval_diffuse_reflectance(si).x
    np.testing.assert_allclose(albedo, [0.4, 0.1, 0.8])


# Derivatives


def grid_ball():
    return sphere(0.4).to_grid(12).at(0.5, 0, 1)


MOVED = {
    "a lamp's place": (SHADED, "lamp.place", {}),
    "lamp's radius": (SHADED, "lamp.radius", {}),
    "an occluder's size": (SHADED, "integrator.union.1.translate.box.size", {}),
    "how two solids blend": (
        plane() | (sphere(0.35).at(0.5, 0, 1) | box(0.5).at(0.5, 0.3, 1).k(0.2)),
        "integrator.union.1.union.blend",
        {"direction": "B"},
    ),
    "a ball's grid": (plane() | grid_ball(), "integrator.union.1.translate.grid.values", {}),
}


def change(mi, parameters, name, start, x):
    """Change the one of a scene's parameters called `name` by x, from its value at the `start`."""
    if name.startswith("lamp"):
        centre, radius = mi.Vector3f(BALL["center"]), mi.Float(BALL["radius"])
        centre.x += x if name == "lamp.place" else 0
        radius += x if name == "lamp.radius" else 0
        parameters["lamp.to_world"] = mi.Transform4f().translate(centre).scale(radius)
    else:
        parameters[name] = start + x
    parameters.update()


@pytest.mark.parametrize("name", MOVED)
def test_derivatives_are_those_of_differences(mi, name):
    """Backward and forward; of the ground alone, so that no silhouette moves."""
    field, parameter, settings = MOVED[name]
    weights = mi.Float(np.random.default_rng(2).uniform(0, 1, 16 * 16 * 3))
    loaded = scene(mi, field, lit(BALL), size=16, epsilon=0.01, **settings)
    parameters = mi.traverse(loaded)
    value = parameters.get(parameter)  # None of the lamp, see `change`
    start = value is not None and type(value)(value)

    def rendered(step, propagate=False):
        change(mi, parameters, parameter, start, step)
        if propagate:
            dr.forward(step, flags=dr.ADFlag.ClearEdges)
        return dr.ravel(mi.render(loaded, parameters, spp=16, seed=5)) * weights

    x = mi.Float(0)
    dr.enable_grad(x)
    dr.backward(dr.sum(rendered(x)))
    backward = dr.grad(x)[0]

    x = mi.Float(0)
    dr.enable_grad(x)
    forward = dr.sum(dr.forward_to(rendered(x, propagate=True)))[0]

    ends = [np.array(rendered(mi.Float(step)), float).sum() for step in (-0.01, 0.01)]
    expected = (ends[1] - ends[0]) / 0.02
    assert backward == pytest.approx(expected, rel=0.05)
    assert forward == pytest.approx(backward, rel=1e-3)


def several_lamps(mi, count):
    """Balls, rectangles, points and a sun about a cube, `count` of each, with their names."""
    rng, t = np.random.default_rng(0), mi.ScalarTransform4f
    made = {}
    for i in range(count):
        at = [rng.uniform((-3, -3, 3), (3, 3, 4)).tolist() for _ in "abc"]
        turned = t().look_at(at[0], [0, 0, 0], [0, 1, 0]).scale([0.3, 0.2, 1])
        made[f"ball_{i}"] = lit({"type": "sphere", "center": at[1], "radius": 0.1 + 0.05 * i})
        made[f"rectangle_{i}"] = lit({"type": "rectangle", "to_world": turned})
        made[f"point_{i}"] = POINT | {"position": at[2]}
    return made | {"sun": {"type": "directional", "direction": [0, 1, -1], "irradiance": 2.0}}


@pytest.mark.parametrize("settings", [{}, {"shading": "exact", "samples": 16}])
def test_many_lamps_are_the_sum_of_each(mi, settings):
    """Lamps are taken by a loop; a single one is not."""
    lamps, size = several_lamps(mi, 2), 12
    whole, *each = (
        picture(mi, SHADED, some, size=size, **settings)
        for some in (lamps, *({name: lamp} for name, lamp in lamps.items()))
    )
    tolerance = 1e-4 if not settings else 0.02
    np.testing.assert_allclose(whole, sum(each), rtol=tolerance, atol=1e-5)


def test_a_kernel_for_many_lamps_is_as_short_as_for_few(mi):
    def count_operations(count):
        loaded = scene(mi, SHADED, several_lamps(mi, count), size=4)
        with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
            dr.kernel_history_clear()
            dr.eval(mi.render(loaded, spp=1))
            return max(kernel.get("operation_count", 0) for kernel in dr.kernel_history())

    assert count_operations(20) < 3 * count_operations(2)  # 10 times as many without the loop


def test_one_of_several_lamps_has_derivatives(mi):
    loaded = scene(mi, SHADED, several_lamps(mi, 2), size=8)
    name = "rectangle_1.to_world"
    parameters = mi.traverse(loaded)
    start = mi.Transform4f(parameters[name])

    def brightness(x):
        parameters[name] = mi.Transform4f().translate(mi.Vector3f(x, 0, 0)) @ start
        parameters.update()
        return dr.sum(mi.render(loaded, parameters, spp=16, seed=5).array)

    x = mi.Float(0)
    dr.enable_grad(x)
    dr.backward(brightness(x))
    ends = [brightness(mi.Float(step))[0] for step in (-0.1, 0.1)]
    assert dr.grad(x)[0] == pytest.approx((ends[1] - ends[0]) / 0.2, rel=0.05)


def along(mi, loaded, name, step=None, spp=1024):
    """How each pixel changes with a parameter, or with a vector's x: by Dr.Jit, or differences."""
    parameters = mi.traverse(loaded)
    start = type(parameters[name])(parameters[name])

    def image(x):
        parameters[name] = start + (mi.Vector3f(x, 0, 0) if dr.size_v(start) == 3 else x)
        parameters.update()
        return mi.render(loaded, parameters, spp=spp, seed=1 if step else 0, seed_grad=2)

    if step:
        return (np.array(image(step), float) - np.array(image(-step)))[:, :, 0] / (2 * step)
    x = mi.Float(0)
    dr.enable_grad(x)
    found = image(x)
    dr.forward(x)
    parameters[name] = start
    return np.array(dr.grad(found), float)[:, :, 0]


def test_a_silhouette_moves_as_in_closed_form(mi):
    """A black disc before a white sky: its area changes by 2πr per radius, its moment by πr²."""
    size, r = 16, 0.6
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}}
    black = {"type": "diffuse", "reflectance": 0.0}
    field = sphere(r).at(0.1, 0, 0).to_json()
    camera = mi.ScalarTransform4f().look_at([0, 0, 2], [0, 0, 0], [0, 1, 0])
    loaded = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "distance_field", "field": field, "bsdf": black, "samples": 1},
            "sensor": {"type": "orthographic", "to_world": camera, "film": film},
            "sky": {"type": "constant", "radiance": 1.0},
        }
    )
    pixel = 2 / size
    x = (np.arange(size) + 0.5) * pixel - 1
    grown = along(mi, loaded, "integrator.translate.sphere.radius").sum() * pixel**2
    shifted = (x * along(mi, loaded, "integrator.translate.offset")).sum() * pixel**2
    assert grown == pytest.approx(-2 * np.pi * r, rel=0.05)
    assert abs(shifted) == pytest.approx(np.pi * r**2, rel=0.05)


SEEN = {
    "a ring before itself": (torus(0.5, 0.2).at(0, 0, 0.5), "translate.torus.tube"),
    "two that blend": (
        sphere(0.4).at(0.3, 0, 0.5) | box(0.5).at(-0.2, 0, 0.4).k(0.2),
        "union.0.translate.sphere.radius",
    ),
}


@pytest.mark.parametrize("name", SEEN)
def test_a_silhouette_moves_as_by_differences(mi, name):
    """Before a lit ground, with shadows on both; the sum within 7 %, and pixel by pixel.

    Without shadows the sum of the second one is 6 % off, because silhouettes are a band outside.
    """
    solid, parameter = SEEN[name]
    view = [0, -2.2, 1.8], [0, 0, 0.3]
    loaded = scene(mi, plane() | solid, lit(BALL), size=16, view=view)
    parameter = f"integrator.union.1.{parameter}"
    found = along(mi, loaded, parameter)
    expected = along(mi, loaded, parameter, step=0.02)
    assert found.sum() == pytest.approx(expected.sum(), rel=0.07)
    assert np.abs(found - expected).sum() < 0.2 * np.abs(expected).sum()  # without them 0.5


def test_mitsuba_has_no_derivative_of_a_shadow(mi):
    """Of the same ball as a grid that Mitsuba renders; it is out of view, and its shadow is not.

    `prb_projective` has the derivatives of `prb`, and those of silhouettes besides.
    """
    grid = grid_ball().child
    low, high = (np.array(corner) for corner in (grid.low, grid.high))
    t = mi.ScalarTransform4f()
    place = t.translate((low + np.array([0.5, 0, 1])).tolist()).scale((high - low).tolist())
    values = np.asarray(grid.values, np.float32)[..., None] / (high - low)[0]
    ours = scene(mi, plane(), lit(BALL), size=16)
    loaded = mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "prb_projective", "max_depth": 2},
            "sensor": ours.sensors()[0],
            "lamp": lit(BALL),
            "ground": {"type": "rectangle", "to_world": t.scale(50), "bsdf": GREY},
            "ball": {"type": "sdfgrid", "grid": mi.TensorXf(values), "to_world": place},
        }
    )
    parameters = mi.traverse(loaded)
    leaf = mi.TensorXf(parameters["ball.grid"])
    dr.enable_grad(leaf)
    parameters["ball.grid"] = leaf
    parameters.update()
    image = mi.render(loaded, parameters, spp=16)
    assert np.array(image).mean() < 0.6 * picture(mi, plane(), lit(BALL)).mean()  # its shadow
    dr.backward(dr.sum(dr.ravel(image)))
    assert np.abs(np.array(dr.grad(leaf))).max() == 0


# Bad input


@pytest.mark.quick
def test_a_field_that_is_no_distance_is_refused(mi, monkeypatch):
    """Of kinds that a user defines: one that is too steep, far away, and one with holes."""
    monkeypatch.setattr(kinds, "_KINDS", kinds._KINDS.copy())

    class steep(sphere):
        def distance(self, p):
            return 2 * super().distance(p)

    class holed(plane):
        def distance(self, p):
            return super().distance(p) + dr.sqrt(p.x)

    for field, said in (
        (plane() | steep(1).at(30, 0, 1), "field: .*but its surface is less than .* its slope"),
        (holed(), r"field: the field is nan at \(-.*; make it finite"),
    ):
        with pytest.raises(RuntimeError, match=said):
            scene(mi, field, POINT)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"field": ""}, "give the field as a filename, or in Python as field.to_json"),
        ({"filename": "a.json"}, "give the field as a filename, or"),
        ({"filename": "a.json", "field": ""}, "a.json: there is no such file"),
        ({"field": "[1]"}, 'distance_field: field: .* should be an object with a "kind"'),
        ({"field": '{"kind": "union", "children": []}'}, "union: it has no children"),
        ({"field": '{"kind": "sphere", "radius": NaN}'}, "radius = nan should be a number"),
        ({"shadow": "soft"}, "distance_field: shadow = soft should be one of linear, base"),
        (
            {"shading": "estimated", "shadow": "quilez"},
            "shadow = quilez does not find; give one of",
        ),
        ({"field": sphere(1).made_of("gold").to_json()}, "made of 'gold'; give a bsdf"),
        ({"more": GREY}, "bsdfs bsdf, more belong to no part of the field"),
        ({"lamp": lit(BALL)}, "distance_field: lamp is not a bsdf"),
    ],
)
def test_what_cannot_be_rendered_is_said(mi, given, said):
    with pytest.raises(RuntimeError, match=said):
        scene(mi, plane(), POINT, **given)


@pytest.mark.quick
@pytest.mark.parametrize(
    "bsdf", [{"type": "mask", "opacity": 0.5, "of": GREY}, {"type": "dielectric"}]
)
def test_a_bsdf_that_lets_light_through_is_said_to_be_dark(mi, bsdf):
    with pytest.warns(UserWarning, match="the bsdf glass lets light through"):
        scene(mi, plane() | sphere(1).made_of("glass"), POINT, glass=bsdf)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("more", "said"),
    [
        ({"lamp": {"type": "cube"}}, "the shape 'lamp' is not a lamp; remove it"),
        ({"lamp": GREY}, "the scene has no light; add an emitter"),
    ],
)
def test_what_is_in_the_scene_is_checked(mi, more, said):
    with pytest.raises(RuntimeError) as error:
        mi.render(scene(mi, plane(), more["lamp"]), spp=1)
    assert re.search(said, str(error.value.__cause__))


@pytest.mark.parametrize("error", [BrdfkitError("say what to do."), KeyboardInterrupt()])
def test_what_is_raised_within_a_loop_arrives_as_it_is(mi, monkeypatch, error):
    """An error, or Ctrl-C, while Dr.Jit records the loop over samples of a lamp."""

    def is_free(*_):
        raise error

    monkeypatch.setattr(DirectLight, "_is_unoccluded", is_free)
    loaded = scene(mi, plane(), lit(BALL), shading="exact")
    with pytest.raises(type(error)) as found:
        Progressive({"plane": loaded}).generate("plane", 1)
    assert found.value is error


def test_a_plain_function_is_shown_as_the_same_solid_is(mi):
    """In the same picture, by rays, and by a grid of it; what is too steep is refused."""
    cube = (-1,) * 3, (1,) * 3
    ball, far, around, steep = (
        bk.render(thing, spp=4, size=(24, 18)).pictures["field"]
        for thing in (
            sphere(1),
            lambda p: dr.sqrt(p.x * p.x + p.y * p.y + p.z * p.z) - 1,
            from_function(lambda p: np.linalg.norm(p, axis=-1) - 1, bounds=cube),
            from_function(lambda p: 3 * dr.sqrt(p.x**2 + p.y**2 + p.z**2) - 3, 3, cube),
        )
    )
    assert ball.max() > 0.1
    np.testing.assert_allclose(far, ball, atol=0.02)
    np.testing.assert_allclose(steep, ball, atol=0.02)
    assert np.median(np.abs(around - ball)) < 0.01
    with pytest.raises(BrdfkitError, match="steeper than its bound 1; divide it by its slope, or"):
        bk.render(lambda p: 9 * (p.x * p.x + p.y * p.y + p.z * p.z - 1), spp=1, size=8)


def test_a_function_carries_the_derivatives_of_what_it_holds(mi):
    radius = mi.Float(1)
    dr.enable_grad(radius)
    field = from_function(lambda p: dr.sqrt(p.x * p.x + p.y * p.y + p.z * p.z) - radius)
    dr.backward(dr.sum(field.distance(mi.Point3f(0, 0, [2, 3]))))
    assert dr.grad(radius)[0] == -2
