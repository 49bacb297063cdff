"""Spherical Gaussians: the densities, mixtures, warps, and the lobes of materials."""

import numpy as np
import pytest

from brdfkit.geometry.directions import from_angles, normalize
from brdfkit.lighting.spherical_gaussians import LobeTable
from brdfkit.lighting.spherical_gaussians import von_mises_fisher as vmf

UP = np.array([0.0, 0.0, 1.0])
quick = pytest.mark.quick


def sphere(n=100):
    """Directions (2n², 3) and the solid angles of a rule that is exact for smooth functions."""
    z, weight = np.polynomial.legendre.leggauss(n)
    phi = (np.arange(2 * n) + 0.5) * np.pi / n
    x = from_angles(*np.meshgrid(np.arccos(z), phi, indexing="ij")).reshape(-1, 3)
    return x, np.repeat(weight, 2 * n) * np.pi / n


# One lobe: Ergun 2015, section 8.1, and the values of it that were computed apart


@quick
@pytest.mark.parametrize("kappa", [0.0, 1e-6, 0.5, 5.0, 50.0, 700.0])
def test_a_lobe_integrates_to_one_and_has_its_mean(kappa):
    x, solid_angle = sphere()
    mu = normalize([0.3, -0.5, 0.2])
    g = vmf.density(x, mu, kappa) * solid_angle
    assert g.sum() == pytest.approx(1, rel=1e-9)
    np.testing.assert_allclose(g @ x, vmf.mean_cosine(kappa) * mu, atol=1e-9)


@quick
def test_a_lobe_is_that_of_eq_8_1_and_nearly_that_of_eq_8_2():
    kappa = np.array([0.5, 2.0, 5.0])
    eq_8_1 = kappa / (4 * np.pi * np.sinh(kappa)) * np.exp(kappa * 0.7)
    eq_8_2 = kappa / (2 * np.pi) * np.exp(-kappa * 0.3)
    g = np.exp(vmf.log_density(0.7, kappa))
    np.testing.assert_allclose(g, eq_8_1, rtol=1e-12)
    np.testing.assert_allclose((eq_8_2 / g)[1:], [0.9817, 0.99995], atol=5e-5)
    assert np.isfinite(vmf.log_density(1.0, 1e8))


@quick
def test_kappa_of_the_mean_cosine():
    r = np.array([0.5, 0.9, 0.99, 0.999])
    np.testing.assert_allclose(vmf.kappa_near(r), [1.833, 10.374, 100.49, 1000.50], rtol=2e-4)
    np.testing.assert_allclose(vmf.kappa_of(r), [1.797, 10.0, 100.0, 1000.0], rtol=2e-4)
    kappa = np.logspace(-4, 6, 50)
    np.testing.assert_allclose(vmf.kappa_of(vmf.mean_cosine(kappa)), kappa, rtol=1e-7)
    np.testing.assert_allclose(vmf.kappa_of(np.array([0.0, 1.0])), [0, vmf.MOST], rtol=1e-6)


@quick
def test_the_cap_that_holds_nine_tenths():
    assert np.degrees(vmf.cap_angle(0.9, 100.0)) == pytest.approx(12.3192, abs=1e-4)
    assert vmf.cap_solid_angle(0.9, 100.0) == pytest.approx(0.1446757, abs=1e-7)
    # By quadrature over z, where e^(-2κ), which eq. 8.8 leaves out, is no longer small, too
    z, weight = np.polynomial.legendre.leggauss(50)
    for kappa in 0.5, 20.0:
        edge = np.cos(vmf.cap_angle(0.6, kappa))
        g = np.exp(vmf.log_density(edge + (1 - edge) * (1 + z) / 2, kappa))
        assert 2 * np.pi * (1 - edge) / 2 * (weight @ g) == pytest.approx(0.6, rel=1e-9)


@quick
def test_samples_and_points_have_the_mean_of_the_lobe():
    mu = normalize([0.2, 0.9, -0.4])
    for kappa in 0.7, 30.0:
        u = np.random.default_rng(1).random((40_000, 2))
        cosine = vmf.sample(mu, kappa, u) @ mu
        # The mean of 40,000: within 4 standard errors
        error = cosine.std() / 200
        assert abs(cosine.mean() - vmf.mean_cosine(kappa)) < 4 * error
        mean = vmf.points(mu, kappa, 2000).mean(axis=0)
        np.testing.assert_allclose(mean, vmf.mean_cosine(kappa) * mu, atol=2e-3)
    several = vmf.points(np.stack([mu, UP]), np.array([5.0, 80.0]), 8)
    np.testing.assert_allclose(several[1], vmf.points(UP, 80.0, 8))
    np.testing.assert_allclose(np.linalg.norm(several, axis=-1), 1)


# Tables of lobes


def table_of_two_views():
    """At 0° one lobe along z, at 60° one along the mirror direction; one channel."""
    theta = np.radians([0, 60])
    return LobeTable(
        theta_o=theta,
        phi_o=np.zeros(1),
        diffuse=np.array([[0.1], [0.3]]),
        weights=np.array([[[0.5]], [[0.7]]]),
        axes=from_angles(theta, np.pi)[:, None],
        kappa=np.array([[10.0], [30.0]]),
    )


@quick
def test_views_between_the_stored_ones_are_interpolated_and_turned():
    table = table_of_two_views()
    wo = from_angles(np.radians([30, 30, 90]), np.radians([0, 70, 0]))
    diffuse, weights, axes, kappa = table.at(wo)
    np.testing.assert_allclose(diffuse[:, 0], [0.2, 0.2, 0.3])
    np.testing.assert_allclose(weights[:, 0, 0], [0.6, 0.6, 0.7])
    np.testing.assert_allclose(kappa[:, 0], [20, 20, 30])
    expected = from_angles(np.radians([30, 30, 60]), np.radians([180, 250, 180]))
    np.testing.assert_allclose(axes[:, 0], expected, atol=1e-12)


@quick
def test_white_light_gives_the_sum_of_the_weights():
    x, solid_angle = sphere()
    found = table_of_two_views().eval(x, np.broadcast_to(from_angles(0.5, 1.0), x.shape))
    diffuse, weights, _, _ = table_of_two_views().at(from_angles([0.5], [1.0]))
    assert solid_angle @ found[:, 0] == pytest.approx(weights.sum() + diffuse.sum(), rel=1e-4)
