"""`robust_normal_map`: energy, sampling, derivatives, beside quadrature and Mitsuba's own map."""

import drjit as dr
import numpy as np
import pytest

import brdfkit as bk
from brdfkit.core.geometry.directions import from_angles
from brdfkit.mitsuba_bridge.bsdf.tilted_facets import LEAST_FACING

WHITE = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 1.0}}
GLOSSY = {"type": "ggx", "diffuse_reflectance": 0.3, "specular_reflectance": 0.8, "alpha_u": 0.4}
TILTS = [15, 40, 60]
VIEWS = [0, 45, 85]


def facet(tilt, azimuth=0.7):
    return from_angles(np.radians(tilt), azimuth)


def load(mi, normal, nested, name="robust_normal_map", **settings):
    pixel = mi.Bitmap(np.float32((np.asarray(normal) + 1) / 2).reshape(1, 1, 3))
    texture = {"type": "bitmap", "bitmap": pixel, "raw": True}
    return mi.load_dict({"type": name, "normalmap": texture, "inner": nested, **settings})


def values(mi, bsdf, wi, wo):
    """The BSDF times the cosine (n,), of the mean channel."""
    si = dr.zeros(mi.SurfaceInteraction3f, len(wo))
    si.wi = mi.Vector3f(np.broadcast_to(np.float32(wi), wo.shape).T)
    si.sh_frame = mi.Frame3f(mi.Vector3f(0, 0, 1))
    return np.array(bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(np.float32(wo).T))).mean(axis=0)


def hemisphere(count=300):
    """Directions (n, 3) whose solid angles are equal, and this solid angle."""
    z, phi = (np.arange(count) + 0.5) / count, np.arange(2 * count) * np.pi / count
    wo = from_angles(*(a.ravel() for a in np.meshgrid(np.arccos(z), phi)))
    return wo, 2 * np.pi / len(wo)


def pairs(count, seed=0):
    z, phi = np.random.default_rng(seed).random((2, 2, count))
    return (from_angles(np.arccos(0.05 + 0.95 * z[k]), 2 * np.pi * phi[k]) for k in range(2))


@pytest.mark.parametrize("nested", [WHITE, GLOSSY, {"type": "roughconductor"}])
def test_a_flat_map_changes_nothing(mi, nested):
    wi, wo = pairs(1000)
    found = values(mi, load(mi, [0, 0, 1], nested), wi, wo)
    np.testing.assert_allclose(found, values(mi, mi.load_dict(nested), wi, wo), rtol=1e-5)
    flat = load(mi, [0, 0, 1], nested, "normalmap")
    np.testing.assert_allclose(found, values(mi, flat, wi, wo), rtol=1e-5)


def test_flat_maps_have_the_derivatives_of_mitsubas(mi):
    """An optimiser may start there, where a tilt has no azimuth."""
    wi, wo = pairs(1000)
    found = {}
    for name in ("robust_normal_map", "normalmap"):
        bsdf = load(mi, [0, 0, 1], GLOSSY, name)
        params = mi.traverse(bsdf)
        dr.enable_grad(params["normalmap.data"])
        params.update()
        si = dr.zeros(mi.SurfaceInteraction3f, len(wi))
        si.wi = mi.Vector3f(np.float32(wi).T)
        value = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(np.float32(wo).T))
        dr.backward(dr.sum(value.x * mi.Float(1 + wo[:, 0])))
        found[name] = np.array(dr.grad(params["normalmap.data"])).ravel()[:2]
    np.testing.assert_allclose(*found.values(), rtol=1e-3)


@pytest.mark.parametrize("azimuth", [0.7, 0.7 + np.pi])
@pytest.mark.parametrize("tilt", TILTS)
def test_white_facets_reflect_all_light(mi, tilt, azimuth):
    """By quadrature, seen from the front and from behind; without the second term, less."""
    wo, solid_angle = hemisphere()
    for view in VIEWS:
        wi = from_angles(np.radians(view), azimuth)
        albedo = values(mi, load(mi, facet(tilt), WHITE), wi, wo).sum() * solid_angle
        assert albedo == pytest.approx(1, abs=2e-3)
        plain = load(mi, facet(tilt), WHITE, conserve_energy=False)
        assert values(mi, plain, wi, wo).sum() * solid_angle < albedo
        mirrors = load(mi, facet(tilt), {"type": "roughconductor", "alpha": 0.3})
        assert values(mi, mirrors, wi, wo).sum() * solid_angle <= 1.002


@pytest.mark.parametrize("tilt", TILTS)
def test_matt_facets_have_a_closed_form(mi, tilt):
    wo, _ = hemisphere(40)
    n = facet(tilt)
    expected = (np.maximum(wo @ n, 0) + (1 - n[2]) / 2 * wo[:, 2]) / np.pi
    found = values(mi, load(mi, n, WHITE), from_angles(0.4, 0.7), wo)
    np.testing.assert_allclose(found, expected, atol=2e-5)


def test_values_are_those_of_drawn_and_raised_light(mi):
    """Light drawn from the nested BSDF and raised by NumPy, through coordinates of both discs."""
    n, wi, count = facet(50, 0.0), from_angles(0.9, 0.3), 400_000
    s, t = np.array([n[2], 0, -n[0]]), np.array([0.0, 1, 0])
    frame = np.stack([s, t, n])
    si = dr.zeros(mi.SurfaceInteraction3f, count)
    si.wi = mi.Vector3f(*map(float, frame @ wi))
    u = np.random.default_rng(3).random((3, count), np.float32)
    drawn, weight = mi.load_dict(GLOSSY).sample(
        mi.BSDFContext(), si, mi.Float(u[0]), mi.Point2f(u[1], u[2])
    )
    a, b, c = np.array(drawn.wo, float)
    w = np.stack([a, b, c], axis=1) @ frame
    radius = np.sqrt(1 - b * b)
    along = radius * (1 - 2 * (a / radius - n[2]) / (1 - n[2]))
    raised = np.stack([along, b, np.sqrt(np.maximum(1 - along**2 - b * b, 0))], axis=1)
    lost = w[:, 2] < 0
    assert lost.mean() > 0.05
    w[lost] = raised[lost]

    def bins(w, amount):
        across = np.arctan2(w[:, 1], w[:, 0])
        edges = np.linspace(0, 1, 5), np.linspace(-np.pi, np.pi, 7)
        return np.histogram2d(w[:, 2], across, edges, weights=amount)[0].ravel()

    arrived = bins(w, np.array(weight).mean(axis=0)) / count
    wo, solid_angle = hemisphere()
    expected = bins(wo, values(mi, load(mi, n, GLOSSY), wi, wo)) * solid_angle
    np.testing.assert_allclose(arrived, expected, atol=4e-3 * expected.max(), rtol=0.02)


@pytest.mark.parametrize("shadowed", [False, True])
def test_without_the_second_term_it_is_mitsubas(mi, shadowed):
    n = facet(30)
    wi, wo = pairs(2000, seed=1)
    facing = wi @ n > LEAST_FACING * wi[:, 2]
    wi, wo, settings = wi[facing], wo[facing], {"use_shadowing_function": shadowed}
    found = values(mi, load(mi, n, GLOSSY, conserve_energy=False, **settings), wi, wo)
    expected = values(mi, load(mi, n, GLOSSY, "normalmap", **settings), wi, wo)
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-5)


@pytest.mark.parametrize("nested", [GLOSSY, {"type": "roughdielectric", "alpha": 0.3}])
def test_it_passes_the_checks_of_materials(mi, nested):
    """χ², weights and coverage; of what transmits light only the χ² test, which sees one side."""
    pixel = {"type": "rgb", "value": list(map(float, (facet(40) + 1) / 2))}
    entries = {"type": "robust_normal_map", "normalmap": pixel, "bsdf": nested}
    only = ["chi squared", "weights", "coverage", "finite", "energy", "reciprocity"]
    report = bk.check(entries, only=only if nested is GLOSSY else only[1:2])
    assert report, str(report)


@pytest.mark.parametrize("name", ["llvm_ad_mono", "llvm_ad_spectral_polarized"])
def test_it_runs_in_other_variants(variant, name):
    variant(name)
    assert bk.check("robust_normal_map", only=["weights"])


def plane(mi, view, kind, nested, light, pixels=(48, 12), **settings):
    """A bumpy plane of 2 x 2, seen at an angle [degrees] from its normal; bumps of up to 60°."""
    u = 2 * np.pi * np.arange(32) / 32
    x, y = np.broadcast_arrays(1.3 * np.sin(u), 1.3 * np.cos(u)[:, None])
    n = np.stack([x, y, np.ones_like(x)], axis=-1)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    bumps = {"type": "bitmap", "bitmap": mi.Bitmap(((n + 1) / 2).astype(np.float32)), "raw": True}
    theta = np.radians(view)
    place = [0, -30 * float(np.sin(theta)), 30 * float(np.cos(theta))]
    film = {"type": "hdrfilm", "width": pixels[0], "height": pixels[1], "rfilter": {"type": "box"}}
    return mi.load_dict(
        {
            "type": "scene",
            "integrator": {"type": "prb", "max_depth": 2},
            "plane": {
                "type": "rectangle",
                "bsdf": {"type": kind, "normalmap": bumps, "inner": nested, **settings},
            },
            "sensor": {
                "type": "orthographic",
                "to_world": mi.ScalarTransform4f().look_at(place, [0, 0, 0], [0, 0, 1])
                @ mi.ScalarTransform4f().scale([0.9, 0.9 * 4 * float(np.cos(theta)), 1]),
                "film": {**film, "pixel_format": "rgb"},
            },
            "light": light,
        }
    )


def test_nothing_is_black_at_grazing_angles(mi):
    """A white plane under a white sky, at 85° to its normal."""
    sky = {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}}

    def look(kind, **settings):
        return np.array(mi.render(plane(mi, 85, kind, WHITE, sky, **settings), spp=64))

    assert (look("normalmap", flip_invalid_normals=False) < 0.02).mean() > 0.15
    assert look("normalmap").mean() < 0.92  # mirrored normals: not black, but too dark
    found = look("robust_normal_map")
    assert found.min() > 0.8
    assert found.mean() == pytest.approx(1, abs=0.005)


@pytest.mark.parametrize("view", [30, 80])
def test_derivatives_are_those_of_differences(mi, view):
    """Of values in one direction of view, by both slopes of the normal and by a width inside."""
    wi, (wo, _) = from_angles(np.radians(view), 0.2), hemisphere(100)
    kinds = {"facing": facet(35, 0.4), "away": facet(35, 0.4 + np.pi)}
    weights = (1 + wo[:, 0]) ** 2 + wo[:, 1]
    for kind, n in kinds.items():
        bsdf = load(mi, n, GLOSSY)
        params = mi.traverse(bsdf)
        keys = "normalmap.data", "nested_bsdf.alpha_u.value"
        assert set(keys) < set(params.keys())
        start = {key: type(params[key])(params[key]) for key in keys}

        def total(params=params, bsdf=bsdf):
            si = dr.zeros(mi.SurfaceInteraction3f, len(wo))
            si.wi = mi.Vector3f(*map(float, wi))
            value = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(np.float32(wo).T))
            return dr.sum(mi.Float(weights) * value.y)

        for key in keys:
            dr.enable_grad(params[key])
        params.update()
        dr.backward(total())
        found = {key: np.array(dr.grad(params[key])).ravel() for key in keys}
        for key in keys:
            for k in range(min(found[key].size, 2)):
                ends = []
                for sign in (1, -1):
                    moved = np.array(start[key])
                    moved.ravel()[k] += sign * 2e-3
                    params[key] = type(start[key])(moved)
                    params.update()
                    ends.append(float(total()[0]))
                slope = (ends[0] - ends[1]) / 4e-3
                assert found[key][k] == pytest.approx(slope, rel=0.01), (kind, key, k)
            params[key] = start[key]
            params.update()


@pytest.mark.parametrize("view", [30, 80])
def test_derivatives_of_samples_are_those_of_the_integral(mi, view):
    """Of the light in x, Σ weight (1 + wo.x), by the slope of a normal that faces away."""
    wi, (wo, solid_angle), count = from_angles(np.radians(view), 0.2), hemisphere(), 400_000
    bsdf = load(mi, facet(40, 2.5), GLOSSY)
    params = mi.traverse(bsdf)
    start, red = mi.TensorXf(params["normalmap.data"]), mi.TensorXf(np.float32([[[1, 0, 0]]]))
    step = mi.Float(0)
    dr.enable_grad(step)
    params["normalmap.data"] = start + step * red
    params.update()
    si = dr.zeros(mi.SurfaceInteraction3f, count)
    si.wi = mi.Vector3f(*map(float, wi))
    u = np.random.default_rng(3).random((3, count), np.float32)
    drawn, weight = bsdf.sample(mi.BSDFContext(), si, mi.Float(u[0]), mi.Point2f(u[1], u[2]))
    dr.forward(step)
    found = np.array(dr.grad(weight)).mean(axis=0) * (1 + np.array(drawn.wo.x, float))

    ends = []
    for sign in (1, -1):
        params["normalmap.data"] = start + mi.Float(sign * 2e-3) * red
        params.update()
        ends.append(np.sum(values(mi, bsdf, wi, wo) * (1 + wo[:, 0]), dtype=float) * solid_angle)
    error = found.std() / np.sqrt(count)
    assert abs(found.mean() - (ends[0] - ends[1]) / 4e-3) < 4 * error + 2e-3


def test_derivatives_of_pictures_are_those_of_differences(mi):
    """Of a plane in the light of a lamp, seen at 80°, by the first channel of all normals."""
    lamp = {"type": "point", "position": [2.0, 1.0, 3.0], "intensity": 20.0}
    scene = plane(mi, 80, "robust_normal_map", GLOSSY, lamp, (24, 8))
    params = mi.traverse(scene)
    start = mi.TensorXf(params["plane.bsdf.normalmap.data"])
    red = mi.TensorXf(np.tile(np.float32([1, 0, 0]), (32, 32, 1)))

    def mean(step):
        params["plane.bsdf.normalmap.data"] = start + step * red
        params.update()
        return dr.mean(mi.render(scene, params, spp=1024, seed=1, seed_grad=2).array)

    step = mi.Float(0)
    dr.enable_grad(step)
    dr.backward(mean(step))
    ends = [float(mean(mi.Float(sign * 5e-3))[0]) for sign in (1, -1)]
    assert dr.grad(step)[0] == pytest.approx((ends[0] - ends[1]) / 0.01, rel=0.02)


@pytest.mark.parametrize(
    ("entries", "said"),
    [
        ({"normals": 1.0}, "did you mean normalmap"),
        ({"normalmap": 0.5}, "normalmap = 0.5 should be a texture with three channels"),
        ({"conserve_energy": 1}, "conserve_energy = 1 should be true or false"),
        ({"a": WHITE, "b": GLOSSY}, "a and b are materials"),
    ],
)
def test_bad_parameters_are_one_sentence(mi, entries, said):
    with pytest.raises(RuntimeError, match=said):
        mi.load_dict({"type": "robust_normal_map", **entries})


@pytest.mark.parametrize("nested", [GLOSSY, {"type": "plastic"}, {"type": "dielectric"}])
def test_pictures_of_the_scalar_variant(variant, nested):
    """The same as LLVM's, of tilted facets, with raised mirror directions."""
    import mitsuba as mi

    pictures = []
    for name in ("llvm_ad_rgb", "scalar_rgb"):
        variant(name)
        at = mi.ScalarTransform4f().look_at([1, -2, 2], [0, 0, 0], [0, 0, 1])
        film = {"type": "hdrfilm", "width": 4, "height": 4, "rfilter": {"type": "box"}}
        tilted = {"type": "rgb", "value": [0.2, 0.5, 0.9]}
        bsdf = {"type": "robust_normal_map", "normalmap": tilted, "a": nested}
        scene = {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 3},
            "sensor": {"type": "perspective", "to_world": at, "film": film, "fov": 20},
            "sample": {"type": "rectangle", "bsdf": bsdf},
            "light": {"type": "constant"},
        }
        pictures.append(np.array(mi.render(mi.load_dict(scene), spp=16)).mean())
    assert pictures[1] == pytest.approx(pictures[0], rel=0.05)
