"""The models that are linear in all their weights: Koenderink's basis and the PCA polynomial."""

import math
import sys

import drjit as dr
import numpy as np
import pytest

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.core.geometry.directions import from_angles
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model import labels, weight
from brdfkit.model.evaluation import compute_lobe_values


def hemisphere(n_theta, n_phi):
    """Directions (n, 3) and solid angles (n,): Gauss-Legendre in cosθ, even in φ."""
    x, w = np.polynomial.legendre.leggauss(n_theta)
    z, w = (x + 1) / 2, w / 2
    phi = np.arange(n_phi) * 2 * np.pi / n_phi
    directions = from_angles(np.arccos(z)[:, None], phi[None, :]).reshape(-1, 3)
    return directions, np.repeat(w * 2 * np.pi / n_phi, n_phi)


@pytest.mark.quick
def test_lobes_are_evaluated_together():
    """In one kernel, not in one for each of 120: a thousand of them took half a minute."""
    model = labels.model("koenderink:order=4,symmetry=anisotropic")()
    directions, _ = hemisphere(4, 8)
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory):
        dr.kernel_history_clear()
        compute_lobe_values(model, directions, directions)
        assert len(dr.kernel_history([dr.KernelType.JIT])) == 1


@pytest.mark.quick
@pytest.mark.parametrize(
    ("order", "isotropic", "anisotropic"),
    [
        (0, 1, 1),
        (2, 5, 21),
        (4, 14, 120),
        (6, 30, None),
        (8, 55, 1035),
    ],
)
def test_counts_of_weights(order, isotropic, anisotropic):
    """Kurt 2007 prints 14, 55 and 295 anisotropic ones, which is no truncation of the basis."""
    assert len(labels.model(f"koenderink:order={order}").weights()) == isotropic
    if anisotropic:
        label = f"koenderink:order={order},symmetry=anisotropic"
        assert len(labels.model(label).weights()) == anisotropic


@pytest.mark.parametrize("label", ["koenderink:order=8", "koenderink:symmetry=anisotropic"])
def test_basis_is_orthonormal(label):
    """∫∫ I_a I_b dω_i dω_r = δ_ab, by a quadrature that is exact for the polynomials."""
    model = labels.model(label)()
    isotropic = "8" in label
    wo, weight_o = hemisphere(9, 18)
    if isotropic:  # only Δφ counts: one azimuth of wi stands for all
        wi, weight_i = hemisphere(9, 1)
    else:
        wi, weight_i = hemisphere(4, 8)
    pairs_i, pairs_o = np.repeat(wi, len(wo), axis=0), np.tile(wo, (len(wi), 1))
    weights = np.repeat(weight_i, len(wo)) * np.tile(weight_o, len(wi))
    basis, _ = compute_lobe_values(model, pairs_i, pairs_o)
    gram = (basis * weights[:, None]).T @ basis
    np.testing.assert_allclose(gram, np.eye(len(gram)), atol=1e-10)


@pytest.mark.quick
def test_order_0_is_lambert():
    koenderink = labels.model("koenderink:order=0")(a_0_0_0=0.6)
    wi, wo = from_angles([0.3], [0.1]), from_angles([1.2], [2.0])
    assert koenderink.eval(wi, wo) == pytest.approx(0.3 / np.pi, rel=1e-12)


@pytest.mark.quick
def test_counts_of_the_polynomial():
    """2p + 1 weights and one angle, which stands for the 4 entries of U; anisotropic 3p + 1."""
    for degree in (1, 2, 7):
        model = labels.model(f"pca_polynomial:degree={degree}")
        assert (len(model.weights()), len(model.shapes())) == (2 * degree + 1, 1)
        model = labels.model(f"pca_polynomial:degree={degree},symmetry=anisotropic")
        assert (len(model.weights()), len(model.shapes())) == (3 * degree + 1, 3)


@pytest.mark.quick
def test_turned_by_its_angles_data_has_its_principal_axes():
    rng = np.random.default_rng(1)
    data = rng.normal(size=(500, 3)) @ rng.normal(size=(3, 3))
    model = labels.model("pca_polynomial")
    module = sys.modules[model.__module__]
    _, axes = np.linalg.eigh(np.cov(data.T))
    import drjit as dr

    columns = [dr.llvm.Float64(np.ascontiguousarray(c)) for c in data.T]
    rotated = module.rotate_to_axes(columns, module.find_rotation_angles(axes.T))
    covariance = np.cov(np.array([np.array(c) for c in rotated]))
    np.testing.assert_allclose(covariance, np.diag(np.diag(covariance)), atol=1e-10)


def test_principal_axes_of_curet(measured_data):
    """Kurt 2007: the first axis at -1.80°, by the 189 geometries below 80°."""
    samples = select_samples(bk.load(measured_data / "curet" / "abrdf.dat#1"), 80.0)
    angles = labels.model("pca_polynomial").determine_parameters(samples)
    assert np.degrees(angles["angle_1_2"]) == pytest.approx(-1.80, abs=5e-3)
    # All 205 geometries: -0.92°
    samples = select_samples(bk.load(measured_data / "curet" / "abrdf.dat#1"), 89.0)
    angles = labels.model("pca_polynomial").determine_parameters(samples)
    assert np.degrees(angles["angle_1_2"]) == pytest.approx(-0.92, abs=5e-3)


# Kurt 2007, digest: E of the weighted least squares on the RGB-averaged CUReT
OPTIMA = {
    (12, "pca_polynomial:degree=2"): 0.029292,
    (12, "pca_polynomial:degree=7"): 0.010463,
    (12, "koenderink:order=2"): 0.026411,
    (12, "koenderink:order=8"): 0.003462,
    (33, "pca_polynomial:degree=2"): 0.006708,
    (33, "pca_polynomial:degree=7"): 0.003911,
    (33, "koenderink:order=2"): 0.006020,
    (33, "koenderink:order=8"): 0.002639,
}


@pytest.mark.parametrize(("sample", "label"), OPTIMA)
def test_optima_on_curet(sample, label, measured_data):
    data = bk.load(measured_data / "curet" / f"abrdf.dat#{sample}")
    assert bk.fit(data, label, loss="kurt").loss == pytest.approx(OPTIMA[sample, label], abs=1e-5)


def test_what_is_clamped_is_said():
    dark = labels.model("koenderink")(a_0_0_0=0.1, a_2_2_0=0.2)
    wi, wo = (from_angles(np.full(50, 0.4), np.zeros(50)), from_angles(np.linspace(0, 1.5, 50), 2))
    assert (dark.eval(wi, wo) >= 0).all()
    assert (dark.eval(wi, wo) == 0).any()
    data = bk.Measured.from_samples(
        wi, wo, np.where(np.arange(50) < 25, 0.3, 0.0)[:, None], channels=("Y",)
    )
    notes = bk.fit(data, "koenderink:order=4", loss="cosine").notes
    assert any("pairs are clamped at 0" in note for note in notes)


def test_a_derived_class_may_have_a_highlight_below_zero(no_user_plugins):
    """Weights of any sign are declared in a class of the model: docs/how_to/your_model.md."""

    class SignedWard(labels.model("ward")):
        specular_reflectance = weight(0.2, "k_s of any sign", (-math.inf, math.inf))

    truth = SignedWard(diffuse_reflectance=0.5, specular_reflectance=-0.03, alpha_u=0.4)
    wi, wo = draw_direction_pairs(500, seed=3, max_degrees=70)
    data = bk.Measured.from_samples(wi, wo, truth.eval(wi, wo), channels=("Y",))
    signed, known = (bk.fit(data, model, loss="cosine") for model in (SignedWard, "ward"))
    np.testing.assert_allclose(signed.values["specular_reflectance"], -0.03, rtol=1e-3)
    assert signed.loss < 1e-6 < known.loss
    assert known.values["specular_reflectance"] == (0.0,)
