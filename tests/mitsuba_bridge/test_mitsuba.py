"""The models as citizens of Mitsuba: gradients of pictures, BSDFs around BSDFs, instances, albedo
and attributes, contexts that ask for one component, and every kind of colour.

All is compared with something found another way: differences, mixtures by hand, cosine samples.
"""

import itertools
import math

import drjit as dr
import numpy as np
import pytest

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.checks.sampling import draw_uniform_numbers
from brdfkit.core.geometry.directions import from_angles, normalize
from brdfkit.mitsuba_bridge.bsdf.signed_sum import tabulate_lobe_sum
from brdfkit.model.lobes import group_components

# All z-scores of this file, some 30: a right renderer exceeds this once in 5,000 files
HIGHEST_Z = 4.5
# The luminance of linear sRGB
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def coloured(model):
    """`model` with values near its defaults: coloured, anisotropic, none of them 0."""
    values = {}
    for name, value in model().values.items():
        parameter = model.parameters[name]
        value = value or (0.02 if parameter.linear else 0.3)
        value = min(value, 0.8 * parameter.bounds[1])
        if parameter.linear:
            values[name] = [value, 0.8 * value, 0.5 * value]
        else:
            values[name] = value * (1.2 if parameter.follows else 1)
    if "c_z" in values:  # Lafortune: a lobe about the mirror direction
        values |= {"c_x": -0.6, "c_y": -0.65, "exponent": 20.0}
    return model(**values)


def lights():
    """Light from everywhere, and some from a small area."""
    to_world = look_at([0, -2, 4], [0, 0, 0]).scale(0.2)
    emitter = {"type": "area", "radiance": {"type": "rgb", "value": 100.0}}
    return {
        "everywhere": {"type": "constant", "radiance": {"type": "rgb", "value": 0.05}},
        "area": {"type": "rectangle", "to_world": to_world, "emitter": emitter},
    }


def look_at(origin, target):
    import mitsuba as mi

    return mi.ScalarTransform4f().look_at(origin, target, [0, 1, 0])


def scene(shapes, integrator=None, size=16, variant_lights=None):
    """`shapes` under `lights`, seen from aside: in line with a pole, a ball shows one azimuth."""
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}}
    camera = {"type": "perspective", "fov": 32, "to_world": look_at([2.2, -2, 2.6], [0, 0, 0])}
    return {
        "type": "scene",
        "integrator": integrator or {"type": "path", "max_depth": 3},
        "sensor": {**camera, "film": film},
        **(lights() if variant_lights is None else variant_lights),
        **shapes,
    }


def ball(bsdf):
    return {"ball": {"type": "sphere", "bsdf": bsdf}}


def interaction(mi, wi):
    """A surface interaction that also has what a bump map looks at."""
    wi = np.atleast_2d(np.asarray(wi, np.float32))
    si = dr.zeros(mi.SurfaceInteraction3f, len(wi))
    si.t = 1.0
    si.wi = mi.Vector3f(wi.T)
    si.n = mi.Normal3f(0, 0, 1)
    si.sh_frame = mi.Frame3f([0, 0, 1])
    si.uv = mi.Point2f(0.3, 0.4)
    si.dp_du, si.dp_dv = mi.Vector3f(1, 0, 0), mi.Vector3f(0, 1, 0)
    return si


def evaluated(mi, bsdf, wi, wo, ctx=None):
    """BRDF times cosine (n, channels) and density (n,)."""
    si, wo = interaction(mi, wi), mi.Vector3f(np.asarray(wo, np.float32).T)
    value, pdf = bsdf.eval_pdf(ctx or mi.BSDFContext(), si, wo)
    return np.array(value, float).T, np.array(pdf, float)


def z_of(values, expected=0.0):
    """Standard errors between the mean of independent `values` (n, ...) and `expected`."""
    error = values.std(axis=0, ddof=1) / math.sqrt(len(values))
    return float(np.max(np.abs(values.mean(axis=0) - expected) / np.maximum(error, 1e-12)))


# Models whose BSDFs differ in their plugin: without shape, with one, of signed weights, of parts
EACH_WAY = ("lambert", "ward", "koenderink", "mixture")

# Gradients of pictures

# Samples of a pixel; central differences of a parameter, relative; and how far they may be off
SAMPLES, STEP, TOLERANCE = 256, 0.03, 0.02


def test_gradient_of_a_picture(model, llvm_variant, monkeypatch):
    """By every parameter, backwards through prb, what differences of pictures of the same seed say.

    The directions of prb are detached and those of a difference move, so that the two agree in the
    mean over samples. The highlight weighs most: over the whole picture the derivative by a width
    nearly cancels.
    """
    mi = llvm_variant
    tables = {}  # a table drawn from moves with the weights, and the directions would with it
    monkeypatch.setattr(
        "brdfkit.mitsuba_bridge.bsdf.adapter.tabulate_lobe_sum",
        lambda model, weights, lobes: tables.setdefault(
            tuple(lobes), tabulate_lobe_sum(model, weights, lobes)
        ),
    )
    integrator = {"type": "prb", "max_depth": 2}
    loaded = mi.load_dict(scene(ball(coloured(model).scene_dict()), integrator))
    found = mi.traverse(loaded)
    names = list(model.parameters)
    if model.has_signed_weights():  # many weights, all alike
        names = [*model.weights()[:2], model.weights()[-1], *model.shapes()]
    keys = {name: f"ball.bsdf.{name}.value" for name in names}
    before = {name: type(found[key])(found[key]) for name, key in keys.items()}

    def picture(seed=0):
        return np.array(mi.render(loaded, spp=SAMPLES, seed=seed), float).sum(axis=2)

    def moved(name, factor):
        found[keys[name]] = before[name] * factor
        found.update()
        image = picture()
        found[keys[name]] = before[name]
        found.update()
        return image

    pixels = picture(seed=1)
    pixels = (pixels / pixels.max()) ** 2
    expected = {}
    for name in names:
        slope = (moved(name, 1 + STEP) - moved(name, 1 - STEP)) / (2 * STEP)
        expected[name] = np.sum(pixels * slope)
    for name in names:
        value = type(before[name])(before[name])
        dr.enable_grad(value)
        found[keys[name]] = value
    found.update()
    # not by mi.render, which takes other samples for the derivative
    weights = mi.TensorXf(np.repeat(pixels[..., None], 3, axis=2).astype(np.float32))
    loaded.integrator().render_backward(loaded, found, weights, seed=0, spp=SAMPLES)
    exact = {n: np.sum(np.array(dr.grad(found[k]) * before[n])) for n, k in keys.items()}
    assert all(np.abs(list(exact.values())) > 1e-3), exact
    given, known = ([d[n] for n in names] for d in (exact, expected))
    # Parameters that hardly change the picture drown in the noise of the differences
    np.testing.assert_allclose(given, known, TOLERANCE, atol=2e-3 * np.abs(known).max())


# BSDFs around BSDFs


def flat():
    """A normal map that changes nothing."""
    return uniform_map([0.5, 0.5, 1.0])


def uniform_map(colour):
    import mitsuba as mi

    pixels = np.tile(np.float32(colour), (4, 4, 1))
    return {"type": "bitmap", "bitmap": mi.Bitmap(pixels), "raw": True}


def bumps():
    import mitsuba as mi

    u = np.linspace(0, 6 * np.pi, 64, dtype=np.float32)
    pixels = (0.01 * np.sin(u)[:, None] * np.sin(u))[..., None]
    return {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(pixels)), "raw": True}


def test_nested(model, llvm_variant):
    """Each outer BSDF with a model inside says what its definition makes of the model's values."""
    mi = llvm_variant
    inner, other = coloured(model).scene_dict(), {"type": "roughplastic"}
    plain, second = mi.load_dict(inner), mi.load_dict(other)
    wi, wo = draw_direction_pairs(2000, seed=1, max_degrees=80)
    value, pdf = evaluated(mi, plain, wi, wo)
    assert value.min() >= 0
    assert value.max() > 0

    twosided = mi.load_dict({"type": "twosided", "bsdf": inner})
    below = [1, 1, -1]
    for sides in (1, below):
        both = evaluated(mi, twosided, wi * sides, wo * sides)
        np.testing.assert_array_equal(both[0], value)
        np.testing.assert_array_equal(both[1], pdf)
    assert not evaluated(mi, plain, wi * below, wo * below)[0].any()
    assert not evaluated(mi, twosided, wi * below, wo)[0].any()
    assert mi.has_flag(twosided.flags(), mi.BSDFFlags.BackSide)

    blend = mi.load_dict({"type": "blendbsdf", "weight": 0.3, "a": inner, "b": other})
    for mixed, a, b in zip(
        evaluated(mi, blend, wi, wo), (value, pdf), evaluated(mi, second, wi, wo), strict=True
    ):
        np.testing.assert_allclose(mixed, 0.7 * a + 0.3 * b, rtol=1e-4, atol=1e-6)
    assert blend.component_count() == plain.component_count() + second.component_count()

    mask = mi.load_dict({"type": "mask", "opacity": 0.4, "bsdf": inner})
    masked = evaluated(mi, mask, wi, wo)[0]
    np.testing.assert_allclose(masked, 0.4 * value, rtol=1e-5, atol=1e-9)

    for outer in (
        {"type": "bumpmap", "map": uniform_map([0.5])},
        {"type": "normalmap", "normalmap": flat()},
    ):
        found = evaluated(mi, mi.load_dict({**outer, "bsdf": inner}), wi, wo)[0]
        np.testing.assert_allclose(found, value, rtol=1e-3, atol=1e-3 * value.max())


def test_tilted_by_a_map(model, llvm_variant):
    """A normal map and a bump map show the model in a turned frame."""
    mi = llvm_variant
    inner = coloured(model).scene_dict()
    wi, wo = draw_direction_pairs(2000, seed=2, max_degrees=50)
    normal = np.array([0.3, -0.2, 1.0]) / math.sqrt(1.13)
    # A bump's height h(u, v) has the normal (-∂h/∂u, -∂h/∂v, 1)
    pixels = (np.arange(64)[:, None] * 0.2 - np.arange(64) * 0.3) / 64
    slope = mi.Bitmap(np.ascontiguousarray(pixels[..., None], np.float32))
    maps = {
        "normalmap": {"normalmap": uniform_map((normal + 1) / 2)},
        "bumpmap": {"map": {"type": "bitmap", "bitmap": slope, "raw": True}},
    }
    s = np.array([1, 0, 0]) - normal * normal[0]
    s /= np.linalg.norm(s)
    frame = np.stack([s, np.cross(normal, s), normal], axis=1)
    expected = evaluated(mi, mi.load_dict(inner), wi @ frame, wo @ frame)[0]
    for outer, given in maps.items():
        plain = {"type": outer, "use_shadowing_function": False, **given, "bsdf": inner}
        found = evaluated(mi, mi.load_dict(plain), wi, wo)[0]
        np.testing.assert_allclose(found, expected, rtol=2e-3, atol=1e-4 * expected.max())


@pytest.mark.parametrize("outer", ["twosided", "mask", "bumpmap", "normalmap", "blendbsdf"])
def test_nested_parameters_are_traversed(model, llvm_variant, outer):
    """An optimiser reaches the parameters inside, and they act."""
    mi = llvm_variant
    extra = {
        "mask": {"opacity": 0.5},
        "bumpmap": {"map": bumps()},
        "normalmap": {"normalmap": flat()},
        "blendbsdf": {"weight": 0.5, "b": {"type": "diffuse"}},
    }.get(outer, {})
    bsdf = mi.load_dict({"type": outer, "a": coloured(model).scene_dict(), **extra})
    found = mi.traverse(bsdf)
    name = model.weights()[0]
    (key,) = [k for k in found.keys() if f".{name}." in k]  # noqa: SIM118
    wi, wo = draw_direction_pairs(100, seed=2, max_degrees=60)
    before = evaluated(mi, bsdf, wi, wo)[0]
    found[key] = found[key] * 1.5
    found.update()
    assert (evaluated(mi, bsdf, wi, wo)[0] > before).any()


@pytest.mark.parametrize("name", EACH_WAY)
def test_nested_render(name, llvm_variant):
    """Every outer BSDF in one picture, seen and lit from both sides: finite, and nowhere black."""
    mi = llvm_variant
    inner = coloured(bk.models()[name]).scene_dict()
    nested = [
        {"type": "twosided", "bsdf": inner},
        {"type": "bumpmap", "map": bumps(), "bsdf": inner},
        {"type": "normalmap", "normalmap": uniform_map([0.6, 0.45, 0.95]), "bsdf": inner},
        {"type": "mask", "opacity": 0.5, "bsdf": inner},
        {"type": "blendbsdf", "weight": 0.5, "a": inner, "b": {"type": "roughplastic"}},
    ]
    shapes = {}
    for i, bsdf in enumerate(nested):
        centre = [math.sin(1.2566 * i), math.cos(1.2566 * i), 0]
        shapes[f"ball_{i}"] = {"type": "sphere", "center": centre, "radius": 0.5, "bsdf": bsdf}
    to_world = look_at([0, 0, -1], [0, 0, -5])  # shows its back
    shapes["back"] = {"type": "rectangle", "to_world": to_world, "bsdf": nested[0]}
    image = np.array(mi.render(mi.load_dict(scene(shapes, size=32)), spp=16))
    assert np.isfinite(image).all()
    assert image.min() > 0


# Instances, albedo and attributes


@pytest.mark.parametrize("name", EACH_WAY)
def test_an_instance_is_the_shape(name, llvm_variant):
    """The same picture from the same seed, of a ball and of an instance of it."""
    mi = llvm_variant
    bsdf = coloured(bk.models()[name]).scene_dict()
    group = {"type": "shapegroup", **ball(bsdf)}
    instance = {
        "group": group,
        "ball": {"type": "instance", "group": {"type": "ref", "id": "group"}},
    }
    one, other = (
        np.array(mi.render(mi.load_dict(scene(shapes)), spp=16, seed=3))
        for shapes in (ball(bsdf), instance)
    )
    assert one.max() > 0.1
    np.testing.assert_allclose(other, one, rtol=2e-3, atol=1e-4)


def test_albedo(model, llvm_variant):
    """`eval_diffuse_reflectance` is the weight of a Lambertian lobe, and of others about the
    albedo from above; so the aov integrator shows it. Mitsuba's default would show highlights.
    """
    mi = llvm_variant
    values = coloured(model)
    for material in (model(), values):
        bsdf = mi.load_dict(material.scene_dict())
        found = np.array(bsdf.eval_diffuse_reflectance(interaction(mi, [0, 0, 1.0]))).ravel()
        assert (found >= 0).all()
        assert (found <= 1).all()
        if lambertian_diffuse(mi, model):
            np.testing.assert_allclose(found, material.diffuse_reflectance * np.ones(3), rtol=1e-5)
            continue
        ctx = mi.BSDFContext()
        ctx.type_mask = mi.BSDFFlags.DiffuseReflection
        _, u = draw_uniform_numbers(200_000, seed=4)
        wo = mi.warp.square_to_cosine_hemisphere(u)
        value = bsdf.eval(ctx, interaction(mi, [[0, 0, 1.0]]), wo)
        albedo = np.mean(np.array(value * (dr.pi / wo.z), float), axis=1)
        np.testing.assert_allclose(found, albedo, rtol=2e-3)
    integrator = {"type": "aov", "aovs": "albedo:albedo"}
    image = np.array(mi.render(mi.load_dict(scene(ball(values.scene_dict()), integrator)), spp=4))
    np.testing.assert_allclose(image[8, 8, -3:], found, rtol=1e-5)


def lambertian_diffuse(mi, model):
    """Whether the only diffuse lobe is 1/π."""
    diffuse = [lobe for _, lobe in model().drawn_lobes() if lobe.diffuse]
    up = mi.Vector3f(0, 0, 1)
    return len(diffuse) == 1 and isinstance(diffuse[0].eval(up, up), float)


@pytest.mark.quick
def test_attributes(model, llvm_variant):
    """Every parameter can be asked for by its name, as a roughness for a G-buffer."""
    mi = llvm_variant
    values = coloured(model)
    bsdf = mi.load_dict(values.scene_dict())
    si = interaction(mi, [0, 0, 1.0])
    for name, value in values.free_values.items():
        assert dr.all(bsdf.has_attribute(name))
        if model.parameters[name].linear:
            found = np.array(bsdf.eval_attribute(name, si)).ravel()
            np.testing.assert_allclose(found, value, rtol=1e-6)
        else:
            assert float(bsdf.eval_attribute_1(name, si)[0]) == pytest.approx(value, rel=1e-6)
    assert not dr.any(bsdf.has_attribute("no_such_parameter"))


def test_a_texture_is_held_to_the_bounds(model, llvm_variant):
    """A texture may hold anything; beyond a bound of its parameter it counts as the bound."""
    mi = llvm_variant
    wi, wo = draw_direction_pairs(200, seed=9, max_degrees=80)
    entries = coloured(model).scene_dict()
    for name, parameter in model.parameters.items():
        for bound, beyond in zip(parameter.bounds, (-3.0, 3.0), strict=True):
            if math.isinf(bound):
                continue
            texture = {"type": "uniform", "value": bound + beyond}
            found, expected = (
                evaluated(mi, mi.load_dict({**entries, name: value}), wi, wo)
                for value in (texture, bound)
            )
            np.testing.assert_array_equal(found[0], expected[0], err_msg=name)
            np.testing.assert_array_equal(found[1], expected[1], err_msg=name)


# Precision


@pytest.mark.quick
def test_mirror_directions_near_the_horizon(configured, llvm_variant):
    """There wo ≈ -wi, and single precision still has the formula's value and a density.

    Its value at the rounded directions: at 89.999° rounding turns the half vector by 0.1°.
    """
    mi = llvm_variant
    rng = np.random.default_rng(8)
    theta = np.radians(np.repeat([89.9, 89.97, 89.99, 89.999], 500))
    phi = rng.uniform(-np.pi, np.pi, len(theta))
    beside, above = rng.uniform(-1e-3, 1e-3, (2, len(theta)))
    wi = np.float32(from_angles(theta, phi))
    wo = np.float32(from_angles(theta - np.abs(above), phi + np.pi + beside))
    value, pdf = evaluated(mi, mi.load_dict(configured().scene_dict()), wi, wo)
    expected = configured().eval(normalize(wi.astype(float)), normalize(wo.astype(float)))
    np.testing.assert_allclose(value / wo[:, 2:], np.broadcast_to(expected, value.shape), rtol=5e-3)
    assert (pdf > 0).all()


# Contexts


def contexts(mi, bsdf):
    """A context per component, with its index."""
    for k in range(bsdf.component_count()):
        ctx = mi.BSDFContext()
        ctx.component = k
        yield k, ctx


@pytest.mark.quick
def test_components_sum_to_the_whole(model, llvm_variant):
    """Over the indices of the components, and over Mitsuba's kinds of them."""
    mi = llvm_variant
    bsdf = mi.load_dict(coloured(model).scene_dict())
    assert bsdf.component_count() == len(
        group_components([lobe for _, lobe in model().drawn_lobes()])
    )
    wi, wo = draw_direction_pairs(5000, seed=5, max_degrees=85)
    whole, _ = evaluated(mi, bsdf, wi, wo)
    parts = [evaluated(mi, bsdf, wi, wo, ctx)[0] for _, ctx in contexts(mi, bsdf)]
    assert all(part.max() > 0 for part in parts)
    kinds = []
    for kind in (mi.BSDFFlags.Diffuse, mi.BSDFFlags.Glossy):
        ctx = mi.BSDFContext()
        ctx.type_mask = kind
        kinds.append(evaluated(mi, bsdf, wi, wo, ctx)[0])
    for found in (parts, kinds):
        np.testing.assert_allclose(sum(found), whole, rtol=1e-5, atol=1e-7)


def test_sampling_of_a_component(model, llvm_variant):
    """It reports that component alone, with its pdf, and the mean weight is its albedo."""
    mi = llvm_variant
    bsdf = mi.load_dict(coloured(model).scene_dict())
    n = 100_000
    wi = from_angles(math.radians(40), 0.5)
    si = interaction(mi, np.tile(wi, (n, 1)))
    for k, ctx in contexts(mi, bsdf):
        drawn, weight = bsdf.sample(ctx, si, *draw_uniform_numbers(n, seed=6))
        assert np.unique(np.array(drawn.sampled_component)).tolist() == [k]
        assert dr.all((drawn.sampled_type & int(bsdf.flags(k))) == drawn.sampled_type)
        pdf = np.array(bsdf.pdf(ctx, si, drawn.wo))
        np.testing.assert_allclose(np.array(drawn.pdf), pdf, rtol=1e-3, atol=1e-6)
        _, u = draw_uniform_numbers(n, seed=7)
        wo = mi.warp.square_to_cosine_hemisphere(u)
        cosine = np.array(bsdf.eval(ctx, si, wo) * (dr.pi / wo.z), float).mean(axis=0)
        own = np.array(weight, float).mean(axis=0)
        error = math.hypot(own.std(), cosine.std()) / math.sqrt(n)
        z = abs(own.mean() - cosine.mean()) / max(error, 1e-5 * cosine.mean())
        assert z < HIGHEST_Z
    ctx = mi.BSDFContext()
    ctx.type_mask = mi.BSDFFlags.DeltaTransmission
    drawn, weight = bsdf.sample(ctx, si, *draw_uniform_numbers(n, seed=6))
    assert not np.array(weight).any()
    assert not np.array(drawn.pdf).any()


# Colours


def luminance(mi, material, seed=0, spp=256, **keywords):
    """Mean luminance of a picture of a ball."""
    loaded = mi.load_dict(scene(ball(material), {"type": "path", "max_depth": 2}, **keywords))
    image = np.array(mi.render(loaded, spp=spp, seed=seed), float)
    return float((image @ LUMINANCE if image.shape[2] == 3 else image).mean())


@pytest.mark.parametrize("name", EACH_WAY)
def test_spectral_has_the_luminance_of_rgb(name, variant):
    """A colour becomes a spectrum, and comes back from the film within 3 %; weights above 1 too.

    That the BSDF of every model has the spectrum of the formula's colour is a check.
    """
    import mitsuba as mi

    model, found = bk.models()[name], {}
    for name in ("llvm_ad_rgb", "llvm_ad_spectral"):
        variant(name)
        entries = coloured(model).scene_dict()
        if model.has_signed_weights():  # there is no spectrum of a negative colour
            for weight, value in model().values.items():
                entries[weight] = entries[weight] if value else 0.02
        found[name] = luminance(mi, entries)
    rgb, spectral = found.values()
    assert spectral == pytest.approx(rgb, rel=0.03)


@pytest.mark.parametrize("name", EACH_WAY)
def test_mono_is_a_channel_of_rgb(name, variant):
    """Under a constant light, from the same samples."""
    import mitsuba as mi

    model = bk.models()[name]
    grey = {"everywhere": {"type": "constant", "radiance": 0.5}}
    found = []
    for name in ("llvm_ad_rgb", "llvm_ad_mono"):
        variant(name)
        found.append(luminance(mi, model().scene_dict(), spp=64, variant_lights=grey))
    assert found[1] == pytest.approx(found[0], rel=1e-3)


@pytest.mark.parametrize("name", ["lambert", "ward"])
def test_scalar_is_llvm(variant, name):
    """The mean of tiny pictures, over seeds."""
    import mitsuba as mi

    material = coloured(bk.models()[name])
    variant("scalar_rgb")
    scalar = np.array(
        [luminance(mi, material.scene_dict(), seed, spp=4, size=4) for seed in range(12)]
    )
    variant("llvm_ad_rgb")
    expected = luminance(mi, material.scene_dict(), spp=8192, size=4)
    z = z_of(scalar, expected)
    assert z < HIGHEST_Z
    assert scalar.std(ddof=1) / math.sqrt(12) < 0.05 * expected


@pytest.mark.parametrize("label", ["llvm_ad_mono", "llvm_ad_spectral", "scalar_spectral"])
@pytest.mark.parametrize("name", ["lambert", "ward", "oren_nayar", "koenderink", "dusty_gold"])
def test_polarized_is_depolarized(variant, label, name):
    """The light of the variant without polarisation, and none polarised: as Mitsuba's diffuse."""
    import mitsuba as mi

    unpolarized = said(mi, variant, label, name)
    matrices = said(mi, variant, f"{label}_polarized", name)
    for matrix, light in zip(matrices, unpolarized, strict=True):
        assert matrix.shape == (4, 4, len(light))
        np.testing.assert_allclose(matrix[0, 0], light, rtol=1e-5)
    diffuse = said(mi, variant, f"{label}_polarized", "diffuse")
    for matrix, expected in zip(matrices, diffuse, strict=True):
        np.testing.assert_array_equal(matrix == 0, expected == 0)


def said(mi, variant, label, name):
    """What `eval`, `eval_pdf`, `sample` and `eval_diffuse_reflectance` say in a variant."""
    variant(label)
    if name == "diffuse":
        entries = {"type": "diffuse", "reflectance": 0.5}
    else:
        entries = (bk.models()[name]() if name in bk.models() else bk.load(name)).scene_dict()
    bsdf, ctx, si = mi.load_dict(entries), mi.BSDFContext(), dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(*map(float, from_angles(0.4, 0.3)))
    if mi.is_spectral:
        si.wavelengths = [450.0, 500.0, 550.0, 600.0]
    wo = mi.Vector3f(*map(float, from_angles(0.6, 3.0)))
    values = (
        bsdf.eval(ctx, si, wo),
        bsdf.eval_pdf(ctx, si, wo)[0],
        bsdf.sample(ctx, si, 0.5, mi.Point2f(0.4, 0.3))[1],
        bsdf.eval_diffuse_reflectance(si),
    )
    channels = 4 if mi.is_spectral else 1
    return [np.array(v).reshape(*(4, 4) * mi.is_polarized, channels) for v in values]


@pytest.mark.parametrize("label", ["scalar_rgb", "scalar_spectral", "scalar_spectral_polarized"])
@pytest.mark.parametrize("name", [*bk.models(), "dusty_gold"])
def test_scalar_renders(variant, label, name):
    """A picture, and samples at the ends of the incidences: there numbers are Python's, which
    raise where an array would hold an unused infinity."""
    import mitsuba as mi

    variant(label)
    material = bk.models()[name]() if name in bk.models() else bk.load(name)
    entries = material.scene_dict()
    image = np.array(mi.render(mi.load_dict(scene(ball(entries), size=4)), spp=4, seed=1))
    assert np.isfinite(image).all()
    assert image.max() > 0
    bsdf = mi.load_dict(entries)
    almost_1 = float(np.nextafter(np.float32(1), np.float32(0)))
    for degrees, u in itertools.product((0, 89.99), (0.0, 0.5, almost_1)):
        si = dr.zeros(mi.SurfaceInteraction3f)
        si.wi = mi.Vector3f(*map(float, from_angles(math.radians(degrees), 0.3)))
        for u_component in (0.05, 0.5, almost_1):
            drawn, weight = bsdf.sample(mi.BSDFContext(), si, u_component, mi.Point2f(u, u))
            assert np.isfinite([drawn.pdf, *np.ravel(np.array(weight))]).all()
        mirrored = mi.Vector3f(-si.wi.x, -si.wi.y, si.wi.z)
        assert bsdf.pdf(mi.BSDFContext(), si, mirrored) > 0


@pytest.mark.quick
def test_a_colour_above_1_is_an_attribute_in_a_spectral_variant(variant):
    """Of no spectrum Mitsuba can make; brdfkit scales one."""
    import mitsuba as mi

    variant("llvm_ad_spectral")
    bsdf = mi.load_dict({"type": "ward", "specular_reflectance": {"type": "rgb", "value": 3.0}})
    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wavelengths = [450.0, 500.0, 550.0, 600.0]
    found = bsdf.eval_attribute("specular_reflectance", si)
    np.testing.assert_allclose(np.array(found).ravel(), 3, rtol=1e-3)


def test_a_negative_colour_is_refused_where_it_has_no_spectrum():
    """Mitsuba would clip it, and a fitted Koenderink model would render wrong without a word."""
    import mitsuba as mi

    before = mi.variant()
    mi.set_variant("llvm_ad_spectral")
    try:
        colour = {"type": "rgb", "value": [0.1, -0.1, 0.2]}
        with pytest.raises(
            RuntimeError, match="koenderink: a_2_2_2 is a colour with a value below"
        ):
            mi.load_dict({"type": "koenderink", "a_2_2_2": colour})
    finally:
        mi.set_variant(before or "llvm_ad_rgb")


@pytest.mark.parametrize("label", ["scalar_rgb", "llvm_ad_rgb"])
def test_an_attribute_of_a_mesh_needs_no_mesh_to_load(label, variant):
    """The sampling of signed weights takes their default instead: it shows no surface."""
    import mitsuba as mi

    variant(label)
    colour = {"type": "mesh_attribute", "name": "vertex_color"}
    bsdf, plain = (
        mi.load_dict({"type": "koenderink", **given}) for given in ({"a_0_0_0": colour}, {})
    )
    (found,), (expected,) = bsdf.tables.values(), plain.tables.values()
    np.testing.assert_array_equal(found.density.values, expected.density.values)
