"""Checks of the sampling: its density, its weights, and that it reaches every lobe."""

import numpy as np

from brdfkit.checks.subject import INCIDENCES, checked, incidences

# All tests of one check together reject a right sampler once in a hundred runs; seeds are
# fixed, so a check that passed goes on to pass.
SIGNIFICANCE = 0.01
SAMPLES = 1_000_000


@checked
def chi_squared(subject):
    """Samples follow the density that `pdf` states, at every incidence (Pearson's χ² test)."""
    import drjit as dr
    import mitsuba as mi
    from mitsuba.chi2 import ChiSquareTest, SphericalDomain

    class UpperHemisphere(SphericalDomain):
        # The horizon, where densities jump, lies on an edge of the histogram
        def bounds(self):
            return mi.ScalarBoundingBox2f([-dr.pi, -1], [dr.pi, 0])

        # At grazing incidence a lobe is narrower in azimuth: four times the cells of z
        def aspect(self):
            return 1 / 4

    p_values, messages = [], []
    for degrees, wi in incidences():
        si = subject.interaction(wi)

        def sample(u, si=si):
            drawn, _ = subject.bsdf.sample(mi.BSDFContext(), si, u[0], mi.Point2f(u[1], u[2]))
            kept = drawn.pdf > 0
            return dr.select(kept, drawn.wo, mi.Vector3f(0, 0, 1)), dr.select(kept, mi.Float(1), 0)

        def pdf(wo, si=si):
            return subject.bsdf.pdf(mi.BSDFContext(), si, wo)

        test = ChiSquareTest(UpperHemisphere(), sample, pdf, 3, SAMPLES, res=32, ires=96)
        if not test.run(SIGNIFICANCE, test_count=len(INCIDENCES), quiet=True):
            messages.append(f"rejected at {degrees}°")
        p_values.append(test.p_value)
    return not messages, "; ".join([f"least p {np.min(p_values):.3g}", *messages])


@checked
def coverage(subject):
    """Albedo by own sampling = albedo by cosine sampling: no lobe is missed (χ² cannot see it)."""
    worst, where = 0.0, ""
    for degrees, wi in incidences():
        own, own_error = _mean(_own_weights(subject, wi))
        cosine, cosine_error = _mean(_cosine_weights(subject, wi))
        deviation = abs(own - cosine) / max(np.hypot(own_error, cosine_error), 1e-5 * cosine)
        if deviation >= worst:
            worst, where = deviation, f" at {degrees}° ({own:.4f} and {cosine:.4f})"
    return worst < 4.5, f"at most {worst:.1f} standard errors apart{where}"


@checked
def weights(subject):
    """The weight of a sample = eval / pdf, its density = pdf, and eval_pdf = both."""
    import mitsuba as mi

    worst = 0.0
    for _degrees, wi in incidences():
        n = 20_000
        si = subject.interaction(np.tile(wi, (n, 1)))
        drawn, weight = subject.bsdf.sample(mi.BSDFContext(), si, *_uniform(n, seed=3))
        value, pdf = subject.bsdf.eval_pdf(mi.BSDFContext(), si, drawn.wo)
        value_2 = subject.bsdf.eval(mi.BSDFContext(), si, drawn.wo)
        pdf_2 = subject.bsdf.pdf(mi.BSDFContext(), si, drawn.wo)
        kept = np.array(drawn.pdf) > 0
        value, value_2, weight = (np.array(x)[:, kept] for x in (value, value_2, weight))
        pdf, pdf_2, stated = (np.array(x)[kept] for x in (pdf, pdf_2, drawn.pdf))
        pairs = [(weight * pdf, value), (value, value_2), (pdf, pdf_2), (pdf, stated)]
        for a, b in pairs:
            worst = max(worst, float(np.max(np.abs(a - b) / np.maximum(np.abs(b), 1e-6))))
    return worst < 1e-3, f"relative difference at most {worst:.1e}"


def spread(subject, degrees):
    """Standard deviation of the weight of a sample over its mean, at an incidence [degrees]."""
    wi = dict(incidences())[degrees]
    weights = _own_weights(subject, wi)
    return float(weights.std() / weights.mean())


def albedo(subject, wi):
    """(albedo, standard error) at incidence `wi`, by the material's own sampling."""
    return _mean(_own_weights(subject, wi))


def _own_weights(subject, wi):
    import mitsuba as mi

    si = subject.interaction(np.tile(wi, (SAMPLES, 1)))
    _, weight = subject.bsdf.sample(mi.BSDFContext(), si, *_uniform(SAMPLES, seed=1))
    return np.array(weight).mean(axis=0, dtype=float)


def _cosine_weights(subject, wi):
    import mitsuba as mi

    _, u = _uniform(SAMPLES, seed=2)
    wo = np.array(mi.warp.square_to_cosine_hemisphere(u)).T
    return subject.plugin_eval(np.tile(wi, (SAMPLES, 1)), wo).mean(axis=1) * np.pi / wo[:, 2]


def _uniform(n, seed):
    import mitsuba as mi

    u = np.random.default_rng(seed).random((3, n), np.float32)
    return mi.Float(u[0]), mi.Point2f(u[1], u[2])


def _mean(x):
    return float(x.mean()), float(x.std() / np.sqrt(len(x)))
