"""Checks that samples of a phase function have its density, and that no light is lost."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from brdfkit.checks import directions
from brdfkit.checks.plugin_subject import PluginSubject
from brdfkit.checks.registry import check_of, larger_or_nan
from brdfkit.checks.variants import WAVELENGTHS, stack_channels
from brdfkit.core.array_types import JitColour, JitFloat, JitVector, MitsubaObject

# Two directions in which light travels, because phase functions may depend on the direction
FORWARD = ((0.0, 0.0, 1.0), (0.6, 0.48, 0.64))


def make_sampler(
    subject: PluginSubject, forward: Sequence[float]
) -> tuple[Callable[..., Any], Callable[[JitVector], tuple[JitColour, JitFloat]]]:
    """Return two functions that draw and evaluate scattered directions, for the checks.

    The light travels along `forward` (3,). The first function is `draw` as in `directions.py`, the
    second maps a direction to (value of the phase function, density).
    """
    import mitsuba as mi

    context = mi.PhaseFunctionContext(None)
    it: MitsubaObject = mi.MediumInteraction3f()
    it.wi, it.p = -mi.Vector3f(*forward), mi.Point3f(0)
    it.sh_frame = mi.Frame3f(it.wi)
    if mi.is_spectral:
        it.wavelengths = WAVELENGTHS

    def draw(u: JitFloat, v: JitFloat, lobe: JitFloat) -> tuple[JitVector, JitColour, JitFloat]:
        return subject.plugin.sample(context, it, lobe, mi.Point2f(u, v))

    def eval_value_and_pdf(wo: JitVector) -> tuple[JitColour, JitFloat]:
        return subject.plugin.eval_pdf(context, it, wo)

    return draw, eval_value_and_pdf


@check_of("phase")
def check_chi_squared(subject: PluginSubject) -> tuple[bool, str]:
    """Check by Pearson's χ² test that sampled directions have the density of `eval_pdf`."""
    p_values = []
    for forward in FORWARD:
        draw, eval_value_and_pdf = make_sampler(subject, forward)

        def pdf(wo: JitVector, f: Callable[..., Any] = eval_value_and_pdf) -> JitFloat:
            return f(wo)[1]

        p_values.append(directions.run_chi_squared_test(draw, pdf, len(FORWARD), dimensions=3))
    accepted = [p for p in p_values if p is not None]
    if len(accepted) < len(p_values):
        return False, "rejected"
    return True, f"smallest p-value {min(accepted):.3g}"


@check_of("phase")
def check_weights(subject: PluginSubject) -> tuple[bool, str]:
    """Check that samples have the weight value / density, and the density of `eval_pdf`."""
    n, worst = 20_000, 0.0
    u = directions.draw_points(n, seed=1, dimensions=3)
    for forward in FORWARD:
        draw, eval_value_and_pdf = make_sampler(subject, forward)
        wo, weight, sample_pdf = draw(*u)
        value, pdf = eval_value_and_pdf(wo)
        weight, value = (stack_channels(x, n) for x in (weight, value))
        pdf, sample_pdf = (directions.broadcast_to_array(x, n) for x in (pdf, sample_pdf))
        for a, b in ((weight * pdf, value), (sample_pdf, pdf)):
            worst = larger_or_nan(worst, float(np.max(np.abs(a - b) / np.maximum(np.abs(b), 1e-6))))
    return worst < 1e-3, f"relative difference at most {worst:.1e}"


@check_of("phase")
def check_normalisation(subject: PluginSubject) -> tuple[bool, str]:
    """Check that no light is lost: the density and the value integrate to 1 over the sphere."""
    w, solid_angle = directions.make_sphere_quadrature()
    n = len(solid_angle)
    totals: dict[str, list[float]] = {"density": [], "value": []}
    for forward in FORWARD:
        value, pdf = make_sampler(subject, forward)[1](w)
        totals["density"].append(float(directions.broadcast_to_array(pdf, n) @ solid_angle))
        totals["value"].extend(stack_channels(value, n) @ solid_angle)
    farthest = {name: max(t, key=lambda x: (np.isnan(x), abs(x - 1))) for name, t in totals.items()}
    passed = all(abs(total - 1) < 1e-3 for total in farthest.values())
    return passed, ", ".join(f"integral of the {name} {t:.5f}" for name, t in farthest.items())


@check_of("phase")
def check_mean_cosine(subject: PluginSubject) -> tuple[bool, str]:
    """Check that samples miss no direction: their weighted mean cosine μ equals ∫ p μ dω.

    μ is the cosine of the angle by which light is deflected, p the phase function.
    """
    import mitsuba as mi

    u = directions.draw_points(directions.SAMPLES, seed=2, dimensions=3)
    w, solid_angle = directions.make_sphere_quadrature()
    worst = 0.0
    for forward in FORWARD:
        draw, eval_value_and_pdf = make_sampler(subject, forward)
        wo, weight, _ = draw(*u)
        cosine = np.array(mi.Vector3f(*forward)).ravel() @ np.array(wo)
        weighted_cosine = stack_channels(weight, directions.SAMPLES) * cosine
        value = stack_channels(eval_value_and_pdf(w)[0], len(solid_angle))
        expected = value @ (np.array(forward) @ np.array(w) * solid_angle)
        worst = larger_or_nan(worst, directions.count_standard_errors(weighted_cosine, expected))
    return worst < 4.5, f"samples and quadrature at most {worst:.1f} standard errors apart"
