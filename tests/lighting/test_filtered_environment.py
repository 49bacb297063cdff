"""Filtered maps of environments, the integrator that reads them, and previews."""

import math
from importlib import import_module
from itertools import pairwise

import numpy as np
import pytest
from click.testing import CliRunner

import brdfkit as bk
from brdfkit.checks.plugin_subject import make_example
from brdfkit.cli import main
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.latitude_rows import solid_angles
from brdfkit.images.errors.psnr import psnr
from brdfkit.lighting.filtering import paraboloid_levels as levels
from brdfkit.lighting.filtering.filtered_map import (
    FilteredMap,
    LobeMaps,
    Mips,
    make_finest_level,
    make_latlong_picture,
)
from brdfkit.lighting.filtering.light_filtering import filter_irradiance
from brdfkit.lighting.filtering.lobe_light import LobeLight
from brdfkit.lighting.filtering.scene_bsdfs import (
    find_period,
    has_separate_diffuse_part,
    is_isotropic,
    is_uniform_over_surface,
)
from brdfkit.lighting.filtering.sphere_filter import (
    column_azimuths,
    convolve_on_sphere,
    row_polar_angles,
)
from brdfkit.lighting.spherical_gaussians.von_mises_fisher import log_density
from brdfkit.rendering.previewing.cache import _load_measured_bsdf
from brdfkit.rendering.previewing.scene import describe_preview
from brdfkit.rendering.scene_input.environment import describe_environment
from brdfkit.rendering.scene_input.material import load_material
from brdfkit.rendering.scenes.ball import ball

SIDE = 128


def sky(w):
    """Light (n, 3) from directions (n, 3): a horizon, a lamp of 5 degrees, and waves of colour."""
    lamp = 400 * np.exp(200 * (w @ [0.48, 0.6, 0.64] - 1))
    waves = np.sin(5 * w[:, 1]) * np.cos(4 * w[:, 2] + np.sin(6 * w[:, 0]))
    grey = 1 + 0.4 * np.tanh(10 * w[:, 2]) + lamp
    return np.stack([grey, grey + 0.5 * waves, 0.8 * grey - 0.3 * waves], axis=-1)


def filter_sky(kind):
    """The filtered sky, of one of both kinds."""
    return kind(kind.make_levels(make_finest_level(sky, SIDE), make_latlong_picture(sky, SIDE)))


def quadrature(axes, kernel, height=256):
    """∫ sky kernel(axis·ω) dω (n, 3), by points on a fine grid."""
    theta, phi = np.meshgrid(row_polar_angles(height), column_azimuths(2 * height), indexing="ij")
    w = from_angles(theta, phi).reshape(-1, 3)
    light = (
        sky(w) * np.repeat(solid_angles(height, 2 * height, at_poles=False), 2 * height)[:, None]
    )
    return np.stack([kernel(w @ axis) @ light for axis in axes])


def lobe(cos, kappa):
    """The density [sr⁻¹] of a lobe at the cosine to its axis."""
    return np.exp(log_density(cos, kappa))


def axes(n=20):
    w = np.random.default_rng(0).normal(size=(n, 3))
    return w / np.linalg.norm(w, axis=1, keepdims=True)


def error(found, expected):
    return np.sqrt(np.mean((found - expected) ** 2) / np.mean(expected**2))


# The rule for levels [Ergun 2015, eqs. 8.8-8.10]


@pytest.mark.quick
def test_the_rule_for_levels():
    """The values that the digest of the thesis computes, for a = 0.9, κ = 100, b = 1.2, 512."""
    assert levels.BORDER == 1.2
    assert levels.cap_solid_angle(100.0, 0.9) == pytest.approx(0.1446757, abs=1e-7)
    angle = math.acos(1 - levels.cap_solid_angle(100.0, 0.9) / (2 * math.pi))
    assert math.degrees(angle) == pytest.approx(12.3192, abs=1e-4)
    assert levels.texel_solid_angle(0.0, 512) == pytest.approx(2.19727e-5, rel=1e-5)
    for z, level in ((0.0, 6.34241), (0.5, 5.75745), (1.0, 5.34241)):
        assert levels.mip_level(100.0, z, 512, 0.9) == pytest.approx(level, abs=1e-5)


@pytest.mark.quick
def test_texels_of_a_disc_cover_a_hemisphere():
    w = levels.texel_directions(512)
    for disc, sign in zip(w, (1, -1), strict=True):
        inside = sign * disc[..., 2] > 0
        covered = levels.texel_solid_angle(disc[inside][:, 2], 512).sum()
        assert covered == pytest.approx(2 * math.pi, rel=2e-4)


# Filters, by quadrature


@pytest.mark.quick
@pytest.mark.parametrize("kappa", [1.0, 30.0, 1000.0])
def test_convolution_is_that_of_the_quadrature(kappa):
    theta, phi = np.meshgrid(row_polar_angles(128), column_azimuths(256), indexing="ij")
    w = from_angles(theta, phi)
    reach = math.acos(max(1 - 18 / kappa, -1))
    filtered = convolve_on_sphere(
        make_latlong_picture(sky, 128), lambda cos: lobe(cos, kappa), reach
    )
    some = np.random.default_rng(1).integers(0, [[128], [256]], (2, 20))
    expected = quadrature(w[tuple(some)], lambda cos: lobe(cos, kappa))
    assert error(filtered[tuple(some)], expected) < 1e-3


def test_a_look_up_is_the_mean_over_the_lobe(module_in_llvm):
    """Of the root mean square within 1 % at the κ of a level, and 2 % halfway between two; the mips
    of graphics hardware are off by tens of per cent."""
    mi = module_in_llvm
    found = filter_sky(LobeMaps)
    w = axes()
    direction = mi.Vector3f(w.T.astype(np.float32))
    for level, tolerance in ((2, 0.01), (3.5, 0.02), (8, 0.01), (9.5, 0.02), (12, 0.01)):
        kappa = levels.sharpest_kappa(SIDE) / levels.STEP**level
        expected = quadrature(w, lambda cos, kappa=kappa: lobe(cos, kappa))
        assert (
            error(np.array(found.mean_over_lobe(direction, mi.Float(kappa))).T, expected)
            < tolerance
        )
    mips = filter_sky(Mips)
    assert error(np.array(mips.mean_over_lobe(direction, mi.Float(kappa))).T, expected) > 0.1
    sharp = np.array(found.mean_over_lobe(direction, mi.Float(np.inf))).T
    np.testing.assert_allclose(
        sharp, np.array(mips.interpolate_bilinearly(direction, 0)).T, rtol=1e-6
    )


def test_irradiance_is_that_of_the_quadrature(module_in_llvm):
    mi = module_in_llvm
    w = axes()
    expected = quadrature(w, lambda cos: np.maximum(cos, 0) / np.pi)
    found = FilteredMap([filter_irradiance(make_latlong_picture(sky, SIDE))])
    values = np.array(found.interpolate_bilinearly(mi.Vector3f(w.T.astype(np.float32)), 0)).T
    assert error(values, expected) < 2e-3


def test_levels_meet_at_the_rim(module_in_llvm):
    """Just above and just below the plane z = 0, where one disc ends and the other begins."""
    mi = module_in_llvm
    found = filter_sky(LobeMaps)
    phi = np.linspace(0, 2 * np.pi, 50)
    above, below = (
        mi.Vector3f(from_angles(np.pi / 2 - tilt, phi).T.astype(np.float32))
        for tilt in (1e-5, -1e-5)
    )
    for kappa in (2.0, 50.0):
        a, b = (np.array(found.mean_over_lobe(w, mi.Float(kappa))) for w in (above, below))
        np.testing.assert_allclose(a, b, rtol=0.02)


# The integrator


def scene(mi, integrator, bsdf, light, **more):
    """A ball that fills the picture, by its front."""
    camera = mi.ScalarTransform4f().look_at([0, -4, 0], [0, 0, 0], [0, 0, 1])
    film = {"type": "hdrfilm", "width": 16, "height": 16, "rfilter": {"type": "box"}}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": integrator,
            "sensor": {"type": "perspective", "fov": 18, "to_world": camera, "film": film},
            "ball": {"type": "sphere", "bsdf": bsdf},
            **({"light": light} if light else {}),
            **more,
        }
    )


def ours(**settings):
    return {"type": "filtered_environment", "resolution": 128, **settings}


def shown_with(mi, loaded, samples):
    """The picture by so many directions of each material."""
    return np.array(mi.load_dict(ours(samples=samples)).render(loaded, seed=0, spp=4))


def shown(loaded, spp=1):
    return np.array(loaded.integrator().render(loaded, seed=0, spp=spp))


WARD = {"type": "ward", "alpha_u": 0.1, "alpha_v": 0.1}
TURNED = {"type": "ward", "alpha_u": 0.1, "alpha_v": 0.3}


@pytest.mark.parametrize(
    ("bsdf", "settings", "expected"),
    [
        (WARD, {}, 38),
        (TURNED, {"samples": 128}, 38),
        ({"type": "principled", "roughness": 0.4}, {"samples": 256}, 36),
        (WARD, {"method": "gmm", "lobes": 12}, 42),
    ],
)
def test_pictures_are_those_of_path_tracing(llvm_variant, bsdf, settings, expected):
    """On a ball, which hides nothing from itself; PSNR [dB] to 4096 paths per pixel."""
    mi = llvm_variant
    light = make_example("kdtree_envmap")
    truth = shown(scene(mi, {"type": "path", "max_depth": 2}, bsdf, light), 4096)
    picture = shown(scene(mi, ours(**settings), bsdf, light), 16)
    assert psnr(truth, picture) > expected


@pytest.mark.parametrize("method", ["filtered_sampling", "warped"])
def test_both_sides_of_a_material_are_alike(llvm_variant, method):
    """As those of meshes, whose normals may point inwards."""
    mi = llvm_variant
    bsdf, light = {"type": "twosided", "inside": WARD}, make_example("kdtree_envmap")
    outside = shown(scene(mi, ours(method=method), bsdf, light))
    ball = {"type": "sphere", "bsdf": bsdf, "flip_normals": True}
    inside = shown(scene(mi, ours(method=method), bsdf, light, ball=ball))
    assert psnr(outside, inside) > 38  # directions are mirrored


def test_it_follows_the_light_and_the_material(llvm_variant):
    """What an update changes is seen in the next picture."""
    mi = llvm_variant
    loaded = scene(mi, ours(method="warped"), WARD, make_example("kdtree_envmap"))
    first = shown(loaded)
    parameters = mi.traverse(loaded)
    parameters["light.scale"] = 2.0
    parameters.update()
    brighter = shown(loaded)
    np.testing.assert_allclose(brighter, 2 * first, rtol=1e-5)
    parameters["ball.bsdf.specular_reflectance.value"] = 0.0
    parameters.update()
    assert shown(loaded).max() < 0.8 * brighter.max()


def test_levels_that_a_matt_ball_does_not_need_are_filtered_for_a_glossy_one(llvm_variant):
    mi = llvm_variant
    light = mi.load_dict(make_example("kdtree_envmap"))
    matt, glossy = {"type": "diffuse"}, {"type": "ward", "alpha_u": 0.02, "alpha_v": 0.02}
    one, fresh = mi.load_dict(ours()), mi.load_dict(ours())
    shown(scene(mi, one, matt, light))
    assert one.light.sharpest < one.light.lobes.sharpest
    found = shown(scene(mi, one, glossy, light))
    np.testing.assert_array_equal(found, shown(scene(mi, fresh, glossy, light)))
    assert one.light.sharpest == np.inf


@pytest.mark.quick
def test_what_is_told_apart(llvm_variant):
    mi = llvm_variant
    for entries, matte, period in (
        (WARD, True, 0),
        (TURNED, True, np.pi),
        ({"type": "twosided", "inside": WARD}, True, 0),
        ({"type": "ward", "alpha_u": 0.005, "alpha_v": 0.006}, True, np.pi),
        ({"type": "oren_nayar"}, False, 0),
        ({"type": "principled"}, False, 0),
        ({"type": "conductor"}, False, 0),
    ):
        bsdf = mi.load_dict(entries)
        assert has_separate_diffuse_part(bsdf) == matte, entries
        assert find_period(bsdf) == period, entries
        assert is_isotropic(bsdf) == (period == 0), entries


LAMP = {"type": "point", "position": [0, -5, 0]}


@pytest.mark.parametrize(
    ("light", "more", "settings", "variant", "said"),
    [
        (None, {}, {}, "llvm_ad_rgb", "no environment to light it; add an envmap"),
        ({"type": "constant"}, {"lamp": LAMP}, {}, "llvm_ad_rgb", "lamps besides its environment"),
        ({"type": "constant"}, {}, {}, "scalar_rgb", "does not run in scalar_rgb"),
        ({"type": "constant"}, {}, {"method": "gmm"}, "llvm_ad_spectral", "take filtered_sampling"),
        ({"type": "constant"}, {}, {"method": "gm"}, "llvm_ad_rgb", "did you mean gmm"),
        ({"type": "constant"}, {}, {"filter": "mip"}, "llvm_ad_rgb", "did you mean mips"),
    ],
)
def test_what_it_cannot_light_is_said(llvm_variant, light, more, settings, variant, said):
    mi = llvm_variant
    mi.set_variant(variant)
    try:
        with pytest.raises((RuntimeError, bk.BrdfkitError), match=said):
            shown(scene(mi, ours(**settings), {"type": "diffuse"}, light, **more))
    finally:
        mi.set_variant("llvm_ad_rgb")


@pytest.mark.parametrize(
    ("bsdf", "period", "alike"),
    [
        (WARD, 0, 42),
        ({"type": "twosided", "bsdf": TURNED}, np.pi, 38),
        ({"type": "twosided", "bsdf": TURNED}, 2 * np.pi, 38),
        ({"type": "principled"}, 0, 42),
    ],
)
def test_directions_of_views_are_those_of_points(llvm_variant, monkeypatch, bsdf, period, alike):
    """Pictures by directions that are drawn once for a grid of views, and at each point; PSNR."""
    mi, module = llvm_variant, import_module("brdfkit.lighting.filtering.filtered_sampling")
    stored = import_module("brdfkit.lighting.filtering.view_directions")
    monkeypatch.setattr(stored, "find_period", lambda bsdf: period)
    light = make_example("kdtree_envmap")
    by_views = shown(scene(mi, ours(), bsdf, light), 4)
    monkeypatch.setattr(module, "is_uniform_over_surface", lambda bsdf: False)
    assert psnr(shown(scene(mi, ours(), bsdf, light), 4), by_views) > alike


@pytest.mark.parametrize(("name", "most"), [("plaster", 0.003), ("blasted_gold", 0.008)])
def test_balls_of_tables_have_no_rings(llvm_variant, name, most):
    """What changes from pixel to pixel, along a line through the ball, and not in 1024 directions.

    0.006 and 0.023 where one random number chose the incidence and a place in its table.
    """
    mi = llvm_variant
    loaded = scene(mi, ours(samples=64), bk.load(name).scene_dict(), make_example("kdtree_envmap"))
    size = mi.ScalarVector2u(256, 4)
    film = mi.traverse(loaded.sensors()[0])
    film["film.size"] = size
    film.update()
    few, many = (
        shown_with(mi, loaded, samples)[:, 40:-40].mean(axis=(0, 2)) for samples in (64, 1024)
    )
    assert np.std(np.diff(np.log(few / many), n=2)) < most


@pytest.mark.quick
def test_what_is_the_same_everywhere(llvm_variant):
    import drjit as dr

    mi, checks = llvm_variant, {"type": "checkerboard"}
    for entries, same in (
        (TURNED, True),
        ({"type": "twosided", "bsdf": WARD}, True),
        ({"type": "ward", "alpha_u": checks}, False),
        ({"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": checks}}, False),
        ({"type": "bumpmap", "arbitrary": checks, "bsdf": {"type": "diffuse"}}, False),
        ({"type": "conductor"}, False),
    ):
        bsdf = mi.load_dict(entries)
        assert is_uniform_over_surface(bsdf) == same, entries
    bsdf = mi.load_dict(WARD)
    parameters = mi.traverse(bsdf)
    dr.enable_grad(parameters["diffuse_reflectance.value"])
    parameters.update()
    assert not is_uniform_over_surface(bsdf)


# Shadows


@pytest.mark.parametrize("bsdf", [{"type": "diffuse"}, {"type": "roughconductor", "alpha": 0.5}])
def test_a_high_wall_hides_half_of_the_light(llvm_variant, bsdf):
    """Of a ground beside it, seen from above: of its irradiance, and of a lobe about the normal.
    On average over four sides, up to one direction near the zenith, of cosines that sum to 64."""
    mi = llvm_variant
    t = mi.ScalarTransform4f
    half, gap = 50, 1.5  # beyond the clearance of parts, a hundredth of the wall's size
    film = {"type": "hdrfilm", "width": 8, "height": 8, "rfilter": {"type": "box"}}
    camera = t().look_at([0, 0, 1], [0, 0, 0], [0, 1, 0]).scale(1e-3)
    entries = {
        "type": "scene",
        "sensor": {"type": "orthographic", "to_world": camera, "film": film},
        "light": {"type": "constant"},
        "ground": {"type": "rectangle", "to_world": t().scale(100), "bsdf": bsdf},
    }
    open_air = shown(mi.load_dict(entries | {"integrator": ours()}), spp=4).mean()
    wall = {"type": "cube", "to_world": t().translate([half + gap, 0, 0]).scale(half)}
    shaded = mi.load_dict(entries | {"wall": wall, "integrator": ours(shadows="convex")})
    occluders, _ = shaded.integrator().casters.find_casters(shaded)
    shares = []
    for turn in (0, 90, 180, 270):
        occluders.move("wall", np.array(t().rotate([0, 0, 1], turn).matrix))
        shares.append(shown(shaded, spp=4).mean() / open_air)
    expected = (1 + gap / math.hypot(gap, half)) / 2
    assert np.mean(shares) == pytest.approx(expected, abs=1 / 64)


def test_shadows_of_convex_parts_are_those_of_path_tracing(llvm_variant):
    """A box on a ground in the studio; PSNR [dB] to 512 paths per pixel of direct light."""
    mi = llvm_variant
    t = mi.ScalarTransform4f
    box = {"type": "cube", "to_world": t().rotate([0, 0, 1], 20).scale(0.7), "bsdf": WARD}
    ground = {"type": "rectangle", "to_world": t().translate([0, 0, -0.7]).scale(4)}
    camera = t().look_at([3.2, -4.5, 2.3], [0, 0, 0], [0, 0, 1])
    pictures = {}
    for name, integrator, spp in (
        ("truth", {"type": "path", "max_depth": 2}, 512),
        ("without", ours(), 4),
        ("with", ours(shadows="convex"), 4),
    ):
        loaded = scene(
            mi, integrator, WARD, describe_environment("studio"), ball=box, ground=ground
        )
        parameters = mi.traverse(loaded)
        parameters["sensor.to_world"], parameters["sensor.x_fov"] = camera, 35.0
        parameters.update()
        pictures[name] = shown(loaded, spp)
    truth = pictures["truth"]
    assert psnr(truth, pictures["with"]) > psnr(truth, pictures["without"]) + 7


@pytest.mark.parametrize("alpha", [0.1, 0.3])
def test_little_light_leaks_into_the_shadow_on_a_glossy_ground(llvm_variant, alpha):
    """The light of the darkest part, over that of path tracing: 1.00 and 1.04. It is
    1.15 and 1.21 where shadow rays spread as far as the lobes of light, which overlap."""
    mi = llvm_variant
    t = mi.ScalarTransform4f
    bsdf = {"type": "roughconductor", "material": "none", "alpha": alpha}
    film = {"type": "hdrfilm", "width": 32, "height": 32, "rfilter": {"type": "box"}}
    camera = t().look_at([0, 3.2, 4], [0, -0.6, 0.8], [0, 1, 0])
    ball = {"type": "sphere", "center": [0, 0.8, -0.3], "radius": 0.7}
    entries = {
        "type": "scene",
        "sensor": {"type": "perspective", "fov": 14, "to_world": camera, "film": film},
        "light": {"type": "constant"},
        "ground": {
            "type": "rectangle",
            "to_world": t().rotate([1, 0, 0], -90).scale(20),
            "bsdf": bsdf,
        },
        "ball": ball | {"bsdf": {"type": "diffuse", "reflectance": 0.0}},
    }
    truth = shown(mi.load_dict(entries | {"integrator": {"type": "direct"}}), spp=512)
    loaded = mi.load_dict(entries | {"integrator": ours(samples=64, shadows="shapes")})
    dark = (truth > 0.02) & (truth < 0.3)
    assert dark.sum() > 100
    assert shown(loaded, spp=16)[dark].sum() / truth[dark].sum() == pytest.approx(1, abs=0.08)


# Previews


def test_a_preview_is_the_same_each_time_and_has_no_shadows(llvm_variant, tmp_path):
    first, again = (bk.preview(["ggx", "lambert"], size=32) for _ in range(2))
    for name, shown_once in first.pictures.items():
        assert shown_once.shape == (32, 32, 3)
        np.testing.assert_array_equal(shown_once, again.pictures[name])
    assert first.noise_floor == math.inf
    assert "no shadows" in first.captions["ggx"]
    assert "no shadows" in str(first)
    first.write(tmp_path / "both.exr")
    assert {file.name for file in tmp_path.iterdir()} == {"both.exr", "both.png"}


def show_by(monkeypatch, mi, **settings):
    """Let previews use an integrator of other settings, which is quicker."""
    module = import_module("brdfkit.rendering.previewing.preview")
    monkeypatch.setattr(module, "_load_integrator", lambda *_: mi.load_dict(ours(**settings)))


def test_a_file_is_read_and_prepared_again_when_it_changes(llvm_variant, monkeypatch, tmp_path):
    show_by(monkeypatch, llvm_variant, resolution=32)
    file, prepared = tmp_path / "paint.npz", _load_measured_bsdf.cache_info
    before, pictures = prepared().misses, []
    for value in (0.1, 0.1, 0.2):
        if not pictures or value != 0.1:
            bk.save(bk.Measured.from_table(np.full((2, 2, 2, 3), value), name="paint"), file)
        pictures.append(bk.preview(file, size=8).pictures["paint"])
    assert prepared().misses == before + 2
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert pictures[2].max() > 1.1 * pictures[0].max()


def test_a_ball_stands_in_the_shadow_and_the_light_of_its_ground(llvm_variant, monkeypatch):
    """PSNR [dB] to all light, path-traced, with and without shadows."""
    mi, size = llvm_variant, (32, 32)
    show_by(monkeypatch, mi, shadows="shapes")
    shaded = bk.preview("ggx", size=size, shadows=True)
    assert "approximate shadows" in str(shaded)

    light, material = (
        mi.load_dict(describe_environment("studio")),
        load_material({"type": "ggx"}, "ggx"),
    )
    staged = describe_preview(ball(material, size), light, mi.load_dict(ours()), 4, ground=True)
    plain = shown(mi.load_dict(staged), 4)
    staged["integrator"] = {"type": "path", "max_depth": 6}
    staged["sensor"]["sampler"] = {"type": "independent"}
    truth = shown(mi.load_dict(staged), 1024)
    assert psnr(truth, shaded.pictures["ggx"]) > psnr(truth, plain) + 4


def test_a_changed_or_turned_mesh_casts_its_own_shadows(llvm_variant, monkeypatch, tmp_path):
    """By its triangles: no convex parts are sought, which takes minutes."""
    show_by(monkeypatch, llvm_variant, shadows="shapes", resolution=32, samples=9)
    monkeypatch.setattr("brdfkit.lighting.visibility.casters.decompose", None)
    file = tmp_path / "step.obj"
    step = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 0 1 0\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    pictures = []
    for text, up in ((step, "y"), (step, "x"), (step.replace("v 0 1 0", "v 0 9 0"), "y")):
        file.write_text(text)
        shown_now = bk.preview("lambert", size=16, scene=f"{file}#{up}", shadows=True)
        pictures.append(shown_now.pictures["lambert"])
    for one, other in pairwise(pictures):
        assert np.abs(one - other).max() > 0.02


@pytest.mark.quick
@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"scene": "ball.obj#w"}, "behind the #, is x, y or z"),
        ({"environment": "nowhere.exr"}, "nowhere.exr"),
        ({"scene": "cornell_box"}, "A preview shows a shape"),
        ({"scene": "nothing.obj"}, "no such file"),
        ({"scene": 3}, "scene = 3 should be a scene's name or a mesh's file"),
        ({"method": "gm"}, "^filtered_environment: there is no method 'gm'; did you mean gmm"),
        ({"size": 0}, "size = 0"),
        ({"spp": 0}, "spp"),
        ({"spp": 3}, "spp = 3 should be a square number"),
    ],
)
def test_what_cannot_be_previewed_is_said(llvm_variant, tmp_path, monkeypatch, given, said):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ball.obj").touch()
    with pytest.raises(bk.BrdfkitError, match=said):
        bk.preview("lambert", **{"size": 8, **given})


def test_a_preview_has_the_same_colours_in_a_spectral_variant(llvm_variant, monkeypatch):
    show_by(monkeypatch, llvm_variant, resolution=32, samples=9)
    rgb = bk.preview("lambert", size=16, spp=25).pictures["lambert"]
    llvm_variant.set_variant("llvm_ad_spectral")
    try:
        with pytest.raises(bk.BrdfkitError, match="spp = 4 makes wrong colours"):
            bk.preview("lambert", size=16)
        spectral = bk.preview("lambert", size=16, spp=25).pictures["lambert"]
    finally:
        llvm_variant.set_variant("llvm_ad_rgb")
    np.testing.assert_allclose(spectral.mean(axis=(0, 1)), rgb.mean(axis=(0, 1)), rtol=0.01)


@pytest.mark.quick
def test_lobes_say_that_they_leave_mirrors_black(llvm_variant, capfd):
    LobeLight("warped", 1).fit_lobes(llvm_variant.load_dict({"type": "conductor"}))
    assert "leave mirrors and clear glass black" in "".join(capfd.readouterr())


@pytest.mark.quick
def test_the_command_line_refuses_noise_in_a_preview():
    for words in (["--noise-floor", "40"], ["--seed", "3"]):
        run = CliRunner().invoke(main, ["render", "ggx", "--preview", *words])
        assert run.exit_code == 2
        assert "A preview has no noise" in run.stderr
