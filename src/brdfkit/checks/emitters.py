"""Checks that samples of an environment emitter have its density, and miss no light."""

from collections.abc import Callable
from typing import Any

import numpy as np

from brdfkit.checks import directions
from brdfkit.checks.plugin_subject import PluginSubject
from brdfkit.checks.registry import check_of, larger_or_nan
from brdfkit.checks.variants import WAVELENGTHS, stack_channels
from brdfkit.core.array_types import JitColour, JitFloat, JitVector, MitsubaObject

NO_ENVIRONMENT = "nothing to check: the emitter is no environment"


def make_sampler(
    subject: PluginSubject,
) -> tuple[Callable[..., Any], Callable[[JitVector], tuple[JitColour, JitFloat]]]:
    """Return two functions that draw and evaluate directions of an emitter, for the checks.

    The first is `draw` as in `directions.py`, the second maps a direction to (radiance, density).
    """
    import drjit as dr
    import mitsuba as mi

    it: MitsubaObject = dr.zeros(mi.Interaction3f)
    if mi.is_spectral:
        it.wavelengths = WAVELENGTHS

    def draw(u: JitFloat, v: JitFloat) -> tuple[JitVector, JitColour, JitFloat]:
        ds, weight = subject.plugin.sample_direction(it, mi.Point2f(u, v))
        return ds.d, weight, ds.pdf

    def eval_radiance_and_pdf(w: JitVector) -> tuple[JitColour, JitFloat]:
        si = dr.zeros(mi.SurfaceInteraction3f, dr.width(w))
        si.wi, si.wavelengths = -w, it.wavelengths
        ds = dr.zeros(mi.DirectionSample3f, dr.width(w))
        ds.d = w
        return subject.plugin.eval(si), subject.plugin.pdf_direction(it, ds)

    return draw, eval_radiance_and_pdf


@check_of("emitters")
def check_chi_squared(subject: PluginSubject) -> tuple[bool, str]:
    """Check by Pearson's χ² test that sampled directions have the density `pdf_direction`."""
    if not subject.plugin.is_environment():
        return True, NO_ENVIRONMENT
    draw, eval_radiance_and_pdf = make_sampler(subject)
    p = directions.run_chi_squared_test(draw, lambda w: eval_radiance_and_pdf(w)[1], tests=1)
    return p is not None, "rejected" if p is None else f"p-value {p:.3g}"


@check_of("emitters")
def check_weights(subject: PluginSubject) -> tuple[bool, str]:
    """Check that samples have the weight radiance / density, and the density `pdf_direction`."""
    if not subject.plugin.is_environment():
        return True, NO_ENVIRONMENT
    n = 20_000
    u = directions.draw_points(n, seed=1)
    draw, eval_radiance_and_pdf = make_sampler(subject)
    w, weight, sample_pdf = draw(*u)
    radiance, pdf = eval_radiance_and_pdf(w)
    weight, radiance = (stack_channels(x, n) for x in (weight, radiance))
    pdf, sample_pdf = (directions.broadcast_to_array(x, n) for x in (pdf, sample_pdf))
    worst = 0.0
    for a, b in ((weight * sample_pdf, radiance), (sample_pdf, pdf)):
        # Rounding decides in which block of the map a direction on an edge lies, so 0.1 % of the
        # samples may differ
        difference = np.abs(a - b) / np.maximum(np.abs(b), 1e-6)
        worst = larger_or_nan(worst, float(np.percentile(difference, 99.9)))
    return worst < 1e-3, f"relative difference at most {worst:.1e} in 999 of 1000 samples"


@check_of("emitters")
def check_normalisation(subject: PluginSubject) -> tuple[bool, str]:
    """Check that the density `pdf_direction` integrates to 1 over the sphere."""
    if not subject.plugin.is_environment():
        return True, NO_ENVIRONMENT
    w, solid_angle = directions.make_sphere_quadrature()
    pdf = make_sampler(subject)[1](w)[1]
    total = float(directions.broadcast_to_array(pdf, len(solid_angle)) @ solid_angle)
    return abs(total - 1) < 5e-3, f"integral {total:.5f}"


@check_of("emitters")
def check_mean_light(subject: PluginSubject) -> tuple[bool, str]:
    """Check that samples miss no light: their mean weight is the integral of the radiance."""
    if not subject.plugin.is_environment():
        return True, NO_ENVIRONMENT
    u = directions.draw_points(directions.SAMPLES, seed=2)
    draw, eval_radiance_and_pdf = make_sampler(subject)
    _, weight, _ = draw(*u)
    w, solid_angle = directions.make_sphere_quadrature()
    expected = stack_channels(eval_radiance_and_pdf(w)[0], len(solid_angle)) @ solid_angle
    deviation = directions.count_standard_errors(
        stack_channels(weight, directions.SAMPLES), expected
    )
    return deviation < 4.5, f"mean weight and quadrature {deviation:.1f} standard errors apart"
