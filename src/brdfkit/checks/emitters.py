"""Checks of environment emitters: samples follow their density, no light is missed."""

import numpy as np

from brdfkit.checks import directions
from brdfkit.checks.registry import check_of, larger
from brdfkit.checks.variants import WAVELENGTHS, columns

NO_ENVIRONMENT = "nothing to check: the emitter is no environment"


def sampler(subject):
    """(`draw` as in `directions.py`, a function direction → (radiance, density))."""
    import drjit as dr
    import mitsuba as mi

    it = dr.zeros(mi.Interaction3f)
    if mi.is_spectral:
        it.wavelengths = WAVELENGTHS

    def draw(u, v):
        ds, weight = subject.plugin.sample_direction(it, mi.Point2f(u, v))
        return ds.d, weight, ds.pdf

    def radiance_and_pdf(w):
        si = dr.zeros(mi.SurfaceInteraction3f, dr.width(w))
        si.wi, si.wavelengths = -w, it.wavelengths
        ds = dr.zeros(mi.DirectionSample3f, dr.width(w))
        ds.d = w
        return subject.plugin.eval(si), subject.plugin.pdf_direction(it, ds)

    return draw, radiance_and_pdf


@check_of("emitters")
def chi_squared(subject):
    """Directions follow the density that `pdf_direction` states (Pearson's χ² test)."""
    if not subject.plugin.is_environment():
        return True, NO_ENVIRONMENT
    draw, radiance_and_pdf = sampler(subject)
    p = directions.chi_squared(draw, lambda w: radiance_and_pdf(w)[1], tests=1)
    return p is not None, "rejected" if p is None else f"p-value {p:.3g}"


@check_of("emitters")
def weights(subject):
    """The weight of a sample = radiance / density, and its density is that of `pdf_direction`."""
    if not subject.plugin.is_environment():
        return True, NO_ENVIRONMENT
    n = 20_000
    u = directions.random_points(n, seed=1)
    draw, radiance_and_pdf = sampler(subject)
    w, weight, stated = draw(*u)
    radiance, pdf = radiance_and_pdf(w)
    weight, radiance = (columns(x, n) for x in (weight, radiance))
    pdf, stated = (directions.numbers(x, n) for x in (pdf, stated))
    worst = 0.0
    for a, b in ((weight * stated, radiance), (stated, pdf)):
        # a direction on the edge of two blocks belongs to either, by rounding: 0.1 % may be off
        off = np.abs(a - b) / np.maximum(np.abs(b), 1e-6)
        worst = larger(worst, float(np.percentile(off, 99.9)))
    return worst < 1e-3, f"relative difference at most {worst:.1e} in 999 of 1000 samples"


@check_of("emitters")
def normalisation(subject):
    """∫ density dω = 1 over the sphere."""
    if not subject.plugin.is_environment():
        return True, NO_ENVIRONMENT
    w, solid_angle = directions.quadrature()
    pdf = sampler(subject)[1](w)[1]
    total = float(directions.numbers(pdf, len(solid_angle)) @ solid_angle)
    return abs(total - 1) < 5e-3, f"integral {total:.5f}"


@check_of("emitters")
def mean_light(subject):
    """The mean weight of a sample = ∫ L dω by quadrature: no light is missed."""
    if not subject.plugin.is_environment():
        return True, NO_ENVIRONMENT
    u = directions.random_points(directions.SAMPLES, seed=2)
    draw, radiance_and_pdf = sampler(subject)
    _, weight, _ = draw(*u)
    w, solid_angle = directions.quadrature()
    expected = columns(radiance_and_pdf(w)[0], len(solid_angle)) @ solid_angle
    apart = directions.deviation(columns(weight, directions.SAMPLES), expected)
    return apart < 4.5, f"mean weight and quadrature {apart:.1f} standard errors apart"
