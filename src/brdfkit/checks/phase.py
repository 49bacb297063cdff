"""Checks of phase functions: samples follow their density, no light is lost."""

import numpy as np

from brdfkit.checks import directions
from brdfkit.checks.registry import check_of, larger
from brdfkit.checks.variants import WAVELENGTHS, columns

# Two directions in which light travels: a phase function may treat the axes differently
FORWARD = ((0.0, 0.0, 1.0), (0.6, 0.48, 0.64))


def sampler(subject, forward):
    """(`draw` as in `directions.py`, a function direction → (value, density)) of light that travels
    along `forward`."""
    import mitsuba as mi

    context, it = mi.PhaseFunctionContext(None), mi.MediumInteraction3f()
    it.wi, it.p = -mi.Vector3f(*forward), mi.Point3f(0)
    it.sh_frame = mi.Frame3f(it.wi)
    if mi.is_spectral:
        it.wavelengths = WAVELENGTHS

    def draw(u, v, lobe):
        return subject.plugin.sample(context, it, lobe, mi.Point2f(u, v))

    def value_and_pdf(wo):
        return subject.plugin.eval_pdf(context, it, wo)

    return draw, value_and_pdf


@check_of("phase")
def chi_squared(subject):
    """Samples follow the density that `eval_pdf` states (Pearson's χ² test)."""
    p_values = []
    for forward in FORWARD:
        draw, value_and_pdf = sampler(subject, forward)
        p = directions.chi_squared(draw, lambda wo, f=value_and_pdf: f(wo)[1], len(FORWARD), 3)
        p_values.append(p)
    if None in p_values:
        return False, "rejected"
    return True, f"smallest p-value {min(p_values):.3g}"


@check_of("phase")
def weights(subject):
    """The weight of a sample = value / density, and its density is that of `eval_pdf`."""
    n, worst = 20_000, 0.0
    u = directions.random_points(n, seed=1, dimensions=3)
    for forward in FORWARD:
        draw, value_and_pdf = sampler(subject, forward)
        wo, weight, stated = draw(*u)
        value, pdf = value_and_pdf(wo)
        weight, value = (columns(x, n) for x in (weight, value))
        pdf, stated = (directions.numbers(x, n) for x in (pdf, stated))
        for a, b in ((weight * pdf, value), (stated, pdf)):
            worst = larger(worst, float(np.max(np.abs(a - b) / np.maximum(np.abs(b), 1e-6))))
    return worst < 1e-3, f"relative difference at most {worst:.1e}"


@check_of("phase")
def normalisation(subject):
    """∫ p dω = 1 over the sphere, of the density and of the value: no light is gained or lost."""
    w, solid_angle = directions.quadrature()
    n, totals = len(solid_angle), {"density": [], "value": []}
    for forward in FORWARD:
        value, pdf = sampler(subject, forward)[1](w)
        totals["density"].append(directions.numbers(pdf, n) @ solid_angle)
        totals["value"].extend(columns(value, n) @ solid_angle)
    farthest = {name: max(t, key=lambda x: (np.isnan(x), abs(x - 1))) for name, t in totals.items()}
    passed = all(abs(total - 1) < 1e-3 for total in farthest.values())
    return passed, ", ".join(f"integral of the {n} {t:.5f}" for n, t in farthest.items())


@check_of("phase")
def mean_cosine(subject):
    """The weighted mean cosine of the samples = ∫ p μ dω by quadrature: no direction is missed."""
    import mitsuba as mi

    u = directions.random_points(directions.SAMPLES, seed=2, dimensions=3)
    w, solid_angle = directions.quadrature()
    worst = 0.0
    for forward in FORWARD:
        draw, value_and_pdf = sampler(subject, forward)
        wo, weight, _ = draw(*u)
        cosine = np.array(mi.Vector3f(*forward)).ravel() @ np.array(wo)
        found = columns(weight, directions.SAMPLES) * cosine
        value = columns(value_and_pdf(w)[0], len(solid_angle))
        expected = value @ (np.array(forward) @ np.array(w) * solid_angle)
        worst = larger(worst, directions.deviation(found, expected))
    return worst < 4.5, f"samples and quadrature at most {worst:.1f} standard errors apart"
