"""Phase functions: their values and samplers to five digits, and BSDFs in the place of them."""

import numpy as np
import pytest
from brdfkit.plugins.phase import bsdf_phase, mie_hazy, mie_murky, schlick

from brdfkit.checks import directions
from brdfkit.mitsuba_bridge import phase_functions

MU, XI = np.linspace(-1, 1, 5), np.array([0.1, 0.25, 0.5, 0.75, 0.9])
# By a program of its own, in double precision: p(μ) at the MU, and the μ below which XI lies
BUILT_IN = {
    "henyey_greenstein": (
        {"type": "hg", "g": 0.6},
        [0.012434, 0.018560, 0.032112, 0.076869, 0.795775],
    ),
    "backward": (
        {"type": "hg", "g": -0.3},
        [0.211124, 0.103131, 0.063634, 0.044189, 0.032961],
    ),
    "rayleigh": (
        {"type": "rayleigh"},
        [0.119366, 0.074604, 0.059683, 0.074604, 0.119366],
    ),
    "schlick": (
        {"type": "schlick", "k": 0.8112},
        [0.008295, 0.013773, 0.027212, 0.077020, 0.763404],
    ),
    "schlick, wide": (
        {"type": "schlick", "k": 0.45015},
        [0.030173, 0.042279, 0.063452, 0.105664, 0.209874],
    ),
    "mie_hazy": (
        {"type": "mie_hazy"},
        [0.039789, 0.039794, 0.041188, 0.075639, 0.397887],
    ),
    "mie_murky": (
        {"type": "mie_murky"},
        [0.039789, 0.039789, 0.039789, 0.039921, 1.352817],
    ),
}
HALVES = {
    mie_hazy: ([-0.600001, -0.003776, 0.648601, 0.875964, 0.956805], 2 / 5),
    mie_murky: ([-0.6, 0, 0.849284, 0.960717, 0.987009], 8 / 17),
}


def interaction(mi, wi, p=(0, 0, 0)):
    it = mi.MediumInteraction3f()
    it.wi, it.p = mi.Vector3f([float(x) for x in wi]), mi.Point3f([float(x) for x in p])
    it.sh_frame = mi.Frame3f(it.wi)
    return it


def values(mi, phase, mu, wi=(0, 0, -1)):
    """p of light that came along z and leaves at the cosines `mu`; (value, density)."""
    wo = mi.Vector3f(np.sqrt(1 - mu**2), 0 * mu, mu)
    value, pdf = phase.eval_pdf(mi.PhaseFunctionContext(None), interaction(mi, wi), wo)
    return np.broadcast_to(np.array(value), (3, len(mu))), np.array(pdf)


@pytest.mark.quick
@pytest.mark.parametrize("name", BUILT_IN)
def test_values_in_the_forward_convention(name, llvm_variant):
    """Of Mitsuba's own as well, which stand where brdfkit has none."""
    entries, expected = BUILT_IN[name]
    found = values(llvm_variant, llvm_variant.load_dict(entries), MU)[1]
    np.testing.assert_allclose(found, expected, atol=6e-7, rtol=3e-6)


@pytest.mark.quick
def test_the_inverse_of_schlicks_distribution():
    found = schlick.draw_cosine(0.8112, XI)
    expected = [0.031905, 0.523553, 0.811200, 0.932840, 0.977101]
    np.testing.assert_allclose(found, expected, atol=6e-7)


@pytest.mark.quick
@pytest.mark.parametrize("module", HALVES, ids=lambda m: m.__name__.rpartition(".")[2])
def test_mie_by_quadrature_and_its_samples(module):
    """∫ p = 1 and the mean cosine; evenly spread random numbers have the known quantiles."""
    quantiles, mean = HALVES[module]
    mu, weight = np.polynomial.legendre.leggauss(40)
    p = 2 * np.pi * weight * phase_functions.even_and_forward_density(module.EXPONENT, mu)
    assert [p.sum(), p @ mu] == pytest.approx([1, mean], abs=1e-12)
    u = (np.arange(100_000) + 0.5) / 100_000
    drawn = [phase_functions.draw_cosine(module.EXPONENT, half, u) for half in (0.25, 0.75)]
    np.testing.assert_allclose(np.quantile(drawn, XI), quantiles, atol=1e-5)


@pytest.mark.quick
def test_a_mixture_by_mitsuba(llvm_variant):
    """Two of Schlick's in the place of Rayleigh's: the weighted sum, drawn as it says."""
    mi = llvm_variant
    forward, back = ({"type": "schlick", "k": k} for k in (0.4697, -0.4697))
    mixture = {"type": "blendphase", "weight": 0.3, "a": forward, "b": back}
    parts = [values(mi, mi.load_dict(part), MU)[1] for part in (forward, back)]
    value, pdf = values(mi, mi.load_dict(mixture), MU)
    np.testing.assert_allclose(pdf, 0.7 * parts[0] + 0.3 * parts[1], rtol=1e-5)
    np.testing.assert_allclose(value[0], pdf)


# BSDFs


def ball(mi):
    """A density that falls linearly from the middle of the cube -1..1."""
    x = (np.arange(32) + 0.5) / 16 - 1
    r = np.sqrt(x**2 + x[:, None] ** 2 + x[:, None, None] ** 2)
    cube = mi.ScalarTransform4f().translate(-1).scale(2)
    grid = mi.VolumeGrid((2 - r[..., None]).astype(np.float32))
    return mi.load_dict({"type": "gridvolume", "grid": grid, "to_world": cube})


def scattered(mi, entries, wi, wo, p):
    phase = mi.load_dict({"type": "bsdf_phase", **entries})
    it = interaction(mi, wi, p)
    value, pdf = phase.eval_pdf(mi.PhaseFunctionContext(None), it, mi.Vector3f(wo.tolist()))
    return np.array(value).ravel()[0], np.array(pdf).ravel()[0]


@pytest.mark.parametrize("side", [1, -1])
def test_the_normal_is_against_the_gradient(side, llvm_variant):
    """A ball, not along an axis; light of both its sides is reflected, none goes through."""
    n = np.array([2, -1, 2]) / 3
    grey = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.6}}
    entries = {"density": ball(llvm_variant), "bsdf": grey}
    wi, wo = side * np.array([0, 0, 1.0]), side * np.array([0.6, 0, 0.8])
    value, pdf = scattered(llvm_variant, entries, wi, wo, 0.6 * n)
    assert pdf == pytest.approx(abs(n @ wo) / np.pi, rel=2e-3)
    assert value == pytest.approx(0.6 * pdf, rel=1e-5)
    assert scattered(llvm_variant, entries, wi, -wo, 0.6 * n) == (0, 0)


def test_even_where_the_gradient_vanishes(llvm_variant):
    entries = {"density": ball(llvm_variant)}
    for density in (entries, {}):  # in the middle of the ball; a constant
        found = scattered(llvm_variant, density, (0, 0, 1), np.array([0, 0, -1]), (0, 0, 0))
        assert found == pytest.approx((1 / (4 * np.pi),) * 2, rel=1e-5)


def test_refraction_scales_no_light(llvm_variant):
    """A smooth glass, seen from both sides, scatters what it receives."""
    mi = llvm_variant
    glass = {"type": "roughdielectric", "alpha": 0.1, "int_ior": 1.3}
    phase = mi.load_dict({**bsdf_phase.example(), "bsdf": glass})
    w, solid_angle = directions.make_sphere_quadrature()
    for wi in ((0, 0, 1), (0, 0, -1)):
        value, _ = phase.eval_pdf(mi.PhaseFunctionContext(None), interaction(mi, wi), w)
        assert np.array(value)[0] @ solid_angle == pytest.approx(1, abs=0.01)


@pytest.mark.quick
def test_mirrors_are_refused(llvm_variant):
    for kind in ("conductor", "dielectric"):
        with pytest.raises(RuntimeError, match="give a rough one"):
            llvm_variant.load_dict({"type": "bsdf_phase", "bsdf": {"type": kind}})


def test_single_scattering_in_a_slab(llvm_variant):
    """A slab under a sun, whose density falls upwards: the closed form."""
    mi, sigma, alpha, depth, toward = llvm_variant, 1.0, 0.5, 2.0, -0.5
    d = np.array([np.sqrt(1 - toward**2), 0, toward])
    phase = bsdf_phase.example()
    phase["density"]["to_world"] = mi.ScalarTransform4f().scale(10).translate(-0.5)
    film = {"type": "hdrfilm", "width": 4, "height": 4, "rfilter": {"type": "box"}}
    t = mi.ScalarTransform4f
    camera = t().look_at([0, 0, 3], [0, 0, 0], [0, 1, 0]).scale(1e-3)
    medium = {"type": "homogeneous", "albedo": alpha, "sigma_t": sigma, "phase": phase}
    slab = {"type": "cube", "to_world": t().scale([1e4, 1e4, depth / 2]), "interior": medium}
    scene = {
        "type": "scene",
        "integrator": {"type": "volpath", "max_depth": 2},
        "sensor": {"type": "orthographic", "to_world": camera, "film": film},
        "sun": {"type": "directional", "direction": d.tolist(), "irradiance": 1.0},
        "slab": slab | {"bsdf": {"type": "null"}},
    }
    pixels = np.array(mi.render(mi.load_dict(scene), spp=1024))[..., 0]
    # what light of the sun crosses and what the camera's ray does, per unit of depth
    rate = sigma * (1 + 1 / abs(toward))
    expected = sigma * alpha * abs(toward) / np.pi * -np.expm1(-rate * depth) / rate
    error = pixels.std() / np.sqrt(pixels.size - 1)
    assert pixels.mean() == pytest.approx(expected, abs=4 * error)
    assert error < 0.02 * expected
