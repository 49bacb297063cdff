"""Checks of environments: density, weight and sampler belong together, and all light is met."""

import numpy as np

from brdfkit.checks import directions
from brdfkit.checks.registry import checked
from brdfkit.checks.variants import WAVELENGTHS, columns

NO_ENVIRONMENT = "no environment: directions are not sampled"


def sampler(subject):
    """The sampler of `directions.py`, and a function direction → (radiance, density)."""
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


@checked("emitters")
def chi_squared(subject):
    """Directions follow the density that `pdf_direction` states (Pearson's χ² test)."""
    if not subject.plugin.is_environment():
        return True, NO_ENVIRONMENT
    draw, radiance_and_pdf = sampler(subject)
    p = directions.chi_squared(draw, lambda w: radiance_and_pdf(w)[1], tests=1)
    return p is not None, "rejected" if p is None else f"p {p:.3g}"


@checked("emitters")
def weights(subject):
    """The weight of a sample = radiance / density, and its density is that of `pdf_direction`."""

    if not subject.plugin.is_environment():
        return True, NO_ENVIRONMENT
    n = 20_000
    u = directions.square(n, seed=1)
    draw, radiance_and_pdf = sampler(subject)
    w, weight, stated = draw(*u)
    radiance, pdf = radiance_and_pdf(w)
    weight, radiance = (columns(x, n) for x in (weight, radiance))
    pdf, stated = (directions.numbers(x, n) for x in (pdf, stated))
    worst = 0.0
    for a, b in ((weight * stated, radiance), (stated, pdf)):
        # at the edge of two blocks rounding decides which of them a direction belongs to
        off = np.abs(a - b) / np.maximum(np.abs(b), 1e-6)
        worst = max(worst, float(np.percentile(off, 99.9)))
    return worst < 1e-3, f"relative difference at most {worst:.1e} in 999 of 1000 samples"


@checked("emitters")
def normalisation(subject):
    """∫ density dω = 1 over the sphere."""
    if not subject.plugin.is_environment():
        return True, NO_ENVIRONMENT
    w, solid_angle = directions.sphere()
    pdf = sampler(subject)[1](w)[1]
    total = float(directions.numbers(pdf, len(solid_angle)) @ solid_angle)
    return abs(total - 1) < 5e-3, f"integral {total:.5f}"


@checked("emitters")
def mean_light(subject):
    """The mean weight of a sample = ∫ L dω by quadrature: no light is missed."""

    if not subject.plugin.is_environment():
        return True, NO_ENVIRONMENT
    u = directions.square(directions.SAMPLES, seed=2)
    draw, radiance_and_pdf = sampler(subject)
    _, weight, _ = draw(*u)
    w, solid_angle = directions.sphere()
    expected = columns(radiance_and_pdf(w)[0], len(solid_angle)) @ solid_angle
    apart = directions.agreement(columns(weight, directions.SAMPLES), expected)
    return apart < 4.5, f"{apart:.1f} standard errors apart"
