"""Checks that a BRDF is physical: reciprocal, finite, not negative, and energy-conserving."""

import numpy as np

from brdfkit.checks.material_subject import AZIMUTH, Subject, draw_direction_pairs, list_incidences
from brdfkit.checks.registry import check_of
from brdfkit.core.array_types import MitsubaObject
from brdfkit.core.discovery.plugin_files import MODELS
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import from_angles
from brdfkit.core.geometry.quadrature import TOLERANCE, directional_albedo
from brdfkit.core.jit import double_precision
from brdfkit.model.evaluation import compute_fixed_values, compute_lobe_values
from brdfkit.regression.problem.not_finite import require_finite_lobes, require_finite_slopes


@check_of(MODELS)
def check_reciprocity(subject: Subject) -> tuple[bool, str]:
    """Check that the BRDF is reciprocal, f(wi, wo) = f(wo, wi), at 10,000 pairs of directions.

    A BSDF of Mitsuba may declare by its flags that its reflection is not symmetric.
    """
    if subject.is_single_precision and declares_asymmetry(subject.bsdf):
        return True, "nothing to check: the BSDF declares that it is not symmetric"
    wi, wo = draw_direction_pairs(10_000, seed=4)
    forth, back = subject.material.eval(wi, wo), subject.material.eval(wo, wi)
    difference = np.max(np.abs(forth - back) / np.maximum(np.abs(forth), 1e-12))
    tolerance = 1e-3 if subject.is_single_precision else 1e-10
    return bool(difference < tolerance), f"relative difference at most {difference:.1e}"


def declares_asymmetry(bsdf: MitsubaObject) -> bool:
    """Return whether a component of a BSDF that reflects has Mitsuba's flag `NonSymmetric`."""
    import mitsuba as mi

    kinds = [bsdf.flags(k) for k in range(bsdf.component_count())]
    asymmetric, transmits = mi.BSDFFlags.NonSymmetric, mi.BSDFFlags.Transmission
    return any(mi.has_flag(k, asymmetric) and not mi.has_flag(k, transmits) for k in kinds)


@check_of(MODELS)
def check_finite(subject: Subject) -> tuple[bool, str]:
    """Check that the BRDF is finite and not negative above the horizon, and 0 below it.

    The values come from the Mitsuba BSDF, in single precision.
    """
    heights = np.array([-1, -1e-3, 0, 1e-8, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 1.0])
    phi = np.linspace(0, 2 * np.pi, 13)
    z_i, z_o, phi = (a.ravel() for a in np.meshgrid(heights, heights, phi))
    value = subject.eval_plugin(from_angles(np.arccos(z_i), 0.1), from_angles(np.arccos(z_o), phi))
    below = (z_i <= 0) | (z_o <= 0)
    problems = {
        "not finite": (~np.isfinite(value)).sum(),
        "negative": (value < 0).sum(),
        "not black below the horizon": (value[below] != 0).sum(),
    }
    figure = "; ".join(f"{count} {problem}" for problem, count in problems.items() if count)
    return not figure, figure or f"{value.size:,} values up to the horizon are finite"


@check_of(MODELS)
def check_defined(subject: Subject) -> tuple[bool, str]:
    """Check that the formula and its derivatives are finite at mirror and at equal directions.

    These pairs of directions, up to 89.9° from the normal, may occur in a fit. There a formula may
    divide by 0, because the half vector or the difference vector is the normal.
    """
    model = subject.model
    if model is None:
        return True, "nothing to check: no formula"
    theta = np.linspace(0, np.radians(89.9), 2_000)
    wi = from_angles(theta, AZIMUTH)
    wi, wo = np.concatenate([wi, wi]), np.concatenate([wi * [-1, -1, 1], wi])
    shapes = {name: getattr(model, name) for name in model.shapes(anisotropic=True)}
    directions = double_precision.to_vector(wi), double_precision.to_vector(wo)
    plain, _ = compute_lobe_values(model, wi, wo)
    if not np.isfinite(compute_fixed_values(model, wi, wo)).all():
        return False, "the sum of the lobes without a weight is not finite"
    try:
        require_finite_lobes(model, plain.T, *directions)
        require_finite_slopes(model, shapes, shapes, *directions)
    except BrdfkitError as error:
        # Keep only the reason, without the model's name before it and the remedy after it
        return False, str(error).partition(": ")[2].partition(";")[0]
    return True, f"formula and derivatives are finite at {len(wi):,} pairs"


@check_of(MODELS)
def check_energy(subject: Subject) -> tuple[bool, str]:
    """Check that energy is conserved: the albedo is at most 1 at angles of incidence up to 85°."""
    f = subject.eval_expected
    figures = {degrees: directional_albedo(f, wi).max() for degrees, wi in list_incidences()}
    degrees = max(figures, key=lambda d: figures[d])
    value = figures[degrees]
    return bool(value <= 1 + TOLERANCE), f"albedo at most {value:.4f}, at {degrees}°"
