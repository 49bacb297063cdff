"""Checks of a BSDF's sampling: its density, its weights, and that it reaches every lobe."""

import numpy as np

from brdfkit.checks.material_subject import INCIDENCES, incidences
from brdfkit.checks.registry import check_of, larger
from brdfkit.checks.variants import columns
from brdfkit.core.discovery.plugin_files import MODELS
from brdfkit.core.geometry.quadrature import TOLERANCE, directional_albedo
from brdfkit.core.jit.padding import pad

# All tests of one check together reject a correct sampler once in a hundred runs. Seeds are fixed:
# a check that has passed will pass again.
SIGNIFICANCE = 0.01
SAMPLES = 1_000_000
# Cells of the histogram, and points to integrate the density in a cell, both along each axis. Where
# a number rejects, the same samples are compared with the next, finer integral: narrow lobes need
# it.
CELLS, SUBCELLS = 48, (16, 64, 128)


@check_of(MODELS)
def chi_squared(subject):
    """Samples follow the density that `pdf` states, at every incidence (Pearson's χ² test).

    The histogram is over half vectors: there a narrow lobe is as round at grazing as at normal
    incidence. Its cells shrink towards the normal.
    """
    import drjit as dr
    import mitsuba as mi
    from mitsuba.chi2 import ChiSquareTest, PlanarDomain

    domain = PlanarDomain(mi.ScalarBoundingBox2f([0, 0], [1, 1]))
    p_values, rejected = [], []
    for degrees, wi in incidences():
        si = subject.interaction(wi)

        def sample(u, si=si):
            drawn, _ = subject.bsdf.sample(mi.BSDFContext(), si, u[0], mi.Point2f(u[1], u[2]))
            return _to_square(mi, drawn.wo, si.wi), dr.select(drawn.pdf > 0, mi.Float(1), 0)

        def pdf(point, si=si):
            wo, jacobian = _to_direction(mi, point, si.wi)
            return subject.bsdf.pdf(mi.BSDFContext(), si, wo) * jacobian

        # the finest integral decides where the coarser ones reject
        for subcells in SUBCELLS:
            test = ChiSquareTest(domain, sample, pdf, 3, SAMPLES, res=CELLS, ires=subcells)
            if test.run(SIGNIFICANCE, test_count=len(INCIDENCES), quiet=True):
                break
        else:
            rejected.append(f"rejected at {degrees}°")
        p_values.append(test.p_value)
    return not rejected, "; ".join([f"smallest p-value {np.min(p_values):.3g}", *rejected])


def _to_square(mi, wo, wi):
    """The point (φ_h / 2π, y) of the unit square; θ_h = π/2 y³ makes cells fine around h = n."""
    import drjit as dr

    s = wi + wo
    s = s * dr.rsqrt(dr.maximum(dr.dot(s, s), 1e-20))
    s = dr.select(s.z < 0, -s, s)  # below the surface, where the density is 0
    theta = dr.atan2(dr.sqrt(s.x * s.x + s.y * s.y), s.z)
    phi = dr.atan2(s.y, s.x) / (2 * dr.pi)
    return mi.Point2f(dr.select(phi < 0, phi + 1, phi), (theta / (dr.pi / 2)) ** (1 / 3))


def _to_direction(mi, point, wi):
    """The inverse of `_to_square`: wo at a point, and the Jacobian d solid angle / d area."""
    import drjit as dr

    sin_phi, cos_phi = dr.sincos(2 * dr.pi * point.x)
    sin_theta, cos_theta = dr.sincos(dr.pi / 2 * point.y**3)
    h = mi.Vector3f(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
    cos_d = dr.dot(wi, h)
    jacobian = 4 * cos_d * sin_theta * 2 * dr.pi * (1.5 * dr.pi * point.y**2)
    return 2 * cos_d * h - wi, dr.select(cos_d > 0, jacobian, 0)


@check_of(MODELS)
def coverage(subject):
    """Mean weight of a sample = albedo by quadrature: no lobe is missed, which χ² cannot see."""
    worst, where = 0.0, ""
    for degrees, wi in incidences():
        weights = _means(sample_weights(subject, wi), SAMPLES)
        mean = float(weights.mean())
        expected = float(directional_albedo(subject.values, wi).mean())
        error = np.hypot(weights.std() / np.sqrt(len(weights)), TOLERANCE * expected)
        deviation = abs(mean - expected) / max(error, 1e-12)
        if deviation >= worst:
            worst, where = deviation, f" at {degrees}° ({mean:.4f} and {expected:.4f})"
    said = f"mean weight and albedo at most {worst:.1f} standard errors apart{where}"
    return bool(worst < 4.5), said


@check_of(MODELS)
def weights(subject):
    """The weight of a sample = eval / pdf, its density = pdf, and eval_pdf = both."""
    import drjit as dr
    import mitsuba as mi

    worst = 0.0
    for _degrees, wi in incidences():
        n = 20_000
        si = subject.interaction(wi)
        drawn, weight = subject.bsdf.sample(mi.BSDFContext(), si, *uniform(n, seed=3))
        value, pdf = subject.bsdf.eval_pdf(mi.BSDFContext(), si, drawn.wo)
        value_2 = subject.bsdf.eval(mi.BSDFContext(), si, drawn.wo)
        pdf_2 = subject.bsdf.pdf(mi.BSDFContext(), si, drawn.wo)
        dr.eval(drawn, weight, value, pdf, value_2, pdf_2)  # in one kernel, compiled once

        # samples that were not rejected
        kept = np.array(drawn.pdf) > 0
        value, value_2, weight = (columns(x, n)[:, kept] for x in (value, value_2, weight))
        pdf, pdf_2, stated = (np.array(x)[kept] for x in (pdf, pdf_2, drawn.pdf))
        pairs = [(weight * pdf, value), (value, value_2), (pdf, pdf_2), (pdf, stated)]
        for a, b in pairs:
            worst = larger(worst, float(np.max(np.abs(a - b) / np.maximum(np.abs(b), 1e-6))))
    return worst < 1e-3, f"relative difference at most {worst:.1e}"


def spread(subject, degrees, samples=SAMPLES):
    """The standard deviation of the samples' weights over their mean, at an incidence [degrees]."""
    weights = _means(sample_weights(subject, dict(incidences())[degrees], samples), samples)
    return float(weights.std() / weights.mean())


def sample_weights(subject, wi, samples=SAMPLES, seed=1):
    """The weights of samples at one incidence, a spectrum of the variant."""
    import mitsuba as mi

    si = subject.interaction(wi)
    return subject.bsdf.sample(mi.BSDFContext(), si, *uniform(samples, seed))[1]


def _means(spectrum, n):
    """The mean of the channels (n,)."""
    return columns(spectrum, n).mean(axis=0)


def uniform(n, seed):
    """Uniform random numbers for `n` samples: (mi.Float, mi.Point2f)."""
    import mitsuba as mi

    u = [pad(row) for row in np.random.default_rng(seed).random((3, n), np.float32)]
    return mi.Float(u[0]), mi.Point2f(u[1], u[2])
