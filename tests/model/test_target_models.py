"""Models of other renderers: their formulas, and fits whose weights have bounds on both sides."""

import importlib

import numpy as np
import pytest
from random_models import random_model
from scipy.optimize import lsq_linear

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.quadrature import directional_albedo
from brdfkit.core.jit import double_precision
from brdfkit.materials.measured.selection import select_samples
from brdfkit.materials.resolve import to_material
from brdfkit.model import labels
from brdfkit.model.evaluation import compute_fixed_values, compute_lobe_values
from brdfkit.model.ggx_albedo import schlick_albedo

DISNEY = bk.models()["disney"]
MITSUBAS_NAMES = {"anisotropy": "anisotropic", "ior": "eta"}


@pytest.mark.quick
@pytest.mark.parametrize("seed", range(6))
def test_disney_is_mitsubas_principled(llvm_variant, seed):
    """To 1e-3, which single precision leaves of narrow coats."""
    drawn = random_model(DISNEY, seed)
    own = {"anisotropy": abs(drawn.anisotropy) * (seed % 2), "roughness": 0.1 + 0.15 * seed}
    ours = drawn.changed(clearcoat_gloss=0.8 * drawn.clearcoat_gloss, **own)
    entries = {MITSUBAS_NAMES.get(name, name): value for name, value in ours.values.items()}
    entries["base_color"] = {"type": "rgb", "value": list(ours.base_color)}
    theirs = to_material({"type": "principled", **entries})
    wi, wo = draw_direction_pairs(2000, seed, 85)
    np.testing.assert_allclose(ours.eval(wi, wo), theirs.eval(wi, wo), rtol=1e-3)


@pytest.mark.quick
@pytest.mark.parametrize("roughness", [0.05, 0.3, 1.0])
@pytest.mark.parametrize("degrees", [0, 50, 80, 88])
def test_an_albedo_is_that_of_a_quadrature(roughness, degrees):
    """To 1e-3, and at two reflectances, so both of its polynomials are right."""
    wi, alpha = from_angles(np.radians(degrees), 0.3), roughness**2
    cosine = double_precision.to_scalar(np.cos(np.radians(degrees)))
    for f0 in (0.04, 1.0):
        facets = bk.models()["ggx"](
            diffuse_reflectance=0, specular_reflectance=1, alpha_u=alpha, f0=f0
        )
        found = schlick_albedo(cosine, double_precision.to_scalar(alpha), f0)
        assert float(found[0]) == pytest.approx(directional_albedo(facets.eval, wi)[0], abs=1e-3)


@pytest.mark.quick
def test_fuzz_is_a_transformed_cosine_of_its_albedo():
    """Before both directions are exchanged, and the mean is taken."""
    openpbr = importlib.import_module(bk.models()["openpbr"].__module__)

    def evaluate(wi, wo):
        pair = (double_precision.to_vector(w) for w in (wi, wo))
        return np.array(openpbr.scatter_by_fuzz(*pair, double_precision.to_scalar(0.5)))[:, None]

    for degrees in (0, 40, 80):
        cosine = np.cos(np.radians(degrees))
        expected = openpbr.fuzz_albedo(cosine, 0.5)
        albedo = directional_albedo(evaluate, from_angles(np.radians(degrees), 0.3))[0]
        assert albedo == pytest.approx(expected, rel=1e-3)


@pytest.mark.quick
def test_forms_of_gltf_agree_where_both_hold_a_material():
    """A metal, and a plastic of the full `specular`."""
    white, coloured = (labels.model(f"gltf:highlights={h}") for h in ("white", "coloured"))
    shared = {"roughness": 0.3, "anisotropy": 0.4, "clearcoat": 0.5, "clearcoat_roughness": 0.2}
    colour, pairs = np.array([0.7, 0.4, 0.1]), draw_direction_pairs(500, 2)
    for plastic in (0.0, 1.0):
        one = white(base_color=colour, metallic=1 - plastic, ior=1.5, **shared)
        f0 = plastic * 0.04 + (1 - plastic) * colour
        colours = {"diffuse_color": plastic * 0.96 * colour, "specular_color": f0}
        other = coloured(specular=1.0, **colours, **shared)
        np.testing.assert_allclose(one.eval(*pairs), other.eval(*pairs), rtol=1e-12)


@pytest.mark.quick
def test_bounded_weights_are_those_of_bounded_least_squares():
    """Of a material that is brighter than the base colour may be, and redder than the highlight."""
    model = labels.model("disney+ward")
    wi, wo = draw_direction_pairs(1000, 1, 80)
    shapes = {n: v for n, v in model().values.items() if n in model.shapes()}
    bright = model(disney_1_base_color=[1.0, 0.9, 0.2], ward_2_specular_reflectance=[0.5, 0.0, 0.1])
    measured = bright.eval(wi, wo) * [1.4, 0.7, 1.0]
    data = bk.Measured.from_samples(wi, wo, measured)
    fit = bk.fit(data, "disney+ward", loss="plain", fixed=shapes)
    samples = select_samples(data, 80.0)
    lobes, _ = compute_lobe_values(fit.model, samples.wi, samples.wo)
    target = samples.values - compute_fixed_values(fit.model, samples.wi, samples.wo)
    root = np.sqrt(bk.losses.named.by_sample["plain"].importance(samples))[:, None]
    limits = [0, 0], [1, np.inf]
    for c, values in enumerate(target.T):
        best = lsq_linear(root * lobes, root[:, 0] * values, limits, tol=1e-14).x
        own = [fit.values[name][c] for name in model.weights()]
        np.testing.assert_allclose(own, best, atol=1e-8)
    assert fit.values["disney_1_base_color"][0] == 1
    assert fit.values["ward_2_specular_reflectance"][1] == 0
    assert "disney_1_base_color" in fit.at_bounds
    assert np.isnan(fit.standard_errors["disney_1_base_color"][0])
    assert any("brighter than the model can be" in note for note in fit.notes)
