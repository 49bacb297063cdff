"""Checks derivatives with respect to a model's parameters: of its formula, BSDF and samples."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import drjit as dr
import numpy as np

from brdfkit.checks.material_subject import Subject, draw_direction_pairs, list_incidences
from brdfkit.checks.registry import check_of, larger_or_nan
from brdfkit.checks.sampling import draw_uniform_numbers, sample_weights
from brdfkit.core.array_types import FloatArray, JitFloat, MitsubaModule, MitsubaObject
from brdfkit.core.discovery.plugin_files import MODELS
from brdfkit.core.jit import double_precision
from brdfkit.model import Model
from brdfkit.model.evaluation import (
    compute_fixed_values,
    compute_lobe_values,
    to_shape_scalars,
    to_weight_matrix,
)

NO_SHAPES = "nothing to check: no shape parameters"


@check_of(MODELS)
def check_plugin_is_formula(subject: Subject) -> tuple[bool, str]:
    """Check that Mitsuba's BSDF returns the values of the model's formula times the cosine.

    The BSDF computes in single precision, the formula in double precision.
    """
    wi, wo = draw_direction_pairs(20_000, seed=5, max_degrees=85)
    formula = subject.eval_expected(wi, wo) * wo[:, 2:]
    difference = np.abs(subject.eval_plugin(wi, wo) - formula)
    worst = float(np.max(difference / np.maximum(formula, 1e-3 * formula.max() + 1e-12)))
    return worst < 5e-3, f"relative difference at most {worst:.1e}"


@check_of(MODELS)
def check_gradient(subject: Subject) -> tuple[bool, str]:
    """Check the formula's derivatives for shape parameters against finite differences."""
    model = subject.model
    if model is None or not model.shapes():
        return True, NO_SHAPES
    if unused := [n for n in model.shapes(anisotropic=True) if not depends_on_parameter(model, n)]:
        return False, f"{unused[0]} has no effect that Dr.Jit can follow"
    wi, wo = draw_direction_pairs(2_000, seed=6, max_degrees=80)
    weights, worst = to_weight_matrix(model), 0.0
    largest = float(model.eval(wi, wo).max())
    for name in list_free_shapes(model):
        exact = compute_exact_derivative(model, weights, name, wi, wo)
        difference = np.abs(exact - compute_finite_difference(model, name, wi, wo))
        # Where the derivative is 0, as by an anisotropy of 0, the difference is not exactly so
        scale = np.abs(exact).max() or 10 * largest
        worst = larger_or_nan(worst, float(difference.max() / (scale + 1e-12)))
    return worst < 1e-5, f"relative difference at most {worst:.1e}"


@check_of(MODELS)
def check_plugin_gradient(subject: Subject) -> tuple[bool, str]:
    """Check that Mitsuba's BSDF has the formula's derivatives with respect to every parameter."""
    import mitsuba as mi

    model = subject.model
    if model is None:
        return True, "nothing to check: no parameters"
    wi, wo = draw_direction_pairs(2_000, seed=7, max_degrees=80)

    # Every parameter must be in `mitsuba.traverse`; colours that Mitsuba stores as spectra are
    # exempt from the comparison
    exposed = {key.split(".")[0] for key in mi.traverse(subject.bsdf).keys()}  # noqa: SIM118
    if missing := [name for name in model.free_values if name not in exposed]:
        return False, f"not in traverse: {', '.join(missing)}"
    names = [name for name in model.free_values if not _is_weight_spectrum(mi, model, name)]

    # Compare the derivatives of the sum over all directions and channels
    with _track_gradients(subject.bsdf, names) as values:
        image = subject.bsdf.eval(
            mi.BSDFContext(), subject.make_interaction(wi), mi.Vector3f(wo.astype(np.float32).T)
        )
        total = dr.sum(dr.sum(mi.unpolarized_spectrum(image)))  # over channels and directions
        dr.backward(total, dr.ADFlag.Default | dr.ADFlag.AllowNoGrad)
        gradients = [dr.grad(value) for value in values]
        dr.eval(gradients)  # one kernel compiles faster than one per parameter
        derivatives = [float(np.sum(np.array(gradient))) for gradient in gradients]
    worst = 0.0
    for name, derivative in zip(names, derivatives, strict=True):
        expected = compute_exact_derivative(model, subject.weights, name, wi, wo) * wo[:, 2:]
        difference = abs(derivative - float(expected.sum()))
        worst = larger_or_nan(worst, difference / max(float(np.abs(expected).sum()), 1e-6))

    left_out = len(model.free_values) - len(names)
    but = f"; not checked: {left_out} colours that are spectra in this variant" if left_out else ""
    return worst < 1e-3, f"relative difference at most {worst:.1e}{but}"


@check_of(MODELS)
def check_sampling_gradient(subject: Subject) -> tuple[bool, str]:
    """Check that the mean weight of samples has the same derivatives as the albedo.

    The derivatives of the albedo are estimated from cosine-weighted directions. A sampler fails if
    its directions depend on a parameter while its density does not.
    """
    import mitsuba as mi

    model = subject.model
    if model is None or not model.shapes():
        return True, NO_SHAPES
    n, wi = 200_000, list_incidences()[1][1]
    _, u = draw_uniform_numbers(n, seed=9)
    wo = np.array(mi.warp.square_to_cosine_hemisphere(u)).T.astype(float)
    worst = 0.0
    for name in list_free_shapes(model):
        # Derivatives of the weight of every sample by the parameter
        with _track_gradients(subject.bsdf, [name]) as [value]:
            weight = sample_weights(subject, wi, n, seed=8)
            dr.forward_from(value)
            own = np.array(dr.grad(mi.unpolarized_spectrum(weight)))
            own = np.broadcast_to(own.mean(axis=0, dtype=float), n)

        # Derivatives of the formula, divided by the density cos θ / π of cosine-weighted directions
        exact = compute_exact_derivative(model, subject.weights, name, np.tile(wi, (n, 1)), wo)
        cosine = np.pi * exact.mean(axis=1)
        error = np.hypot(own.std(), cosine.std()) / np.sqrt(n)
        worst = larger_or_nan(worst, abs(own.mean() - cosine.mean()) / max(error, 1e-9))
    return worst < 4.5, f"at most {worst:.1f} standard errors apart"


@contextmanager
def _track_gradients(bsdf: MitsubaObject, names: Sequence[str]) -> Iterator[list[JitFloat]]:
    """Track derivatives for parameters of a BSDF in the `with` block, and yield their values."""
    import mitsuba as mi

    parameters = mi.traverse(bsdf)
    keys = {key.split(".")[0]: key for key in parameters.keys()}  # noqa: SIM118
    values = {key: type(parameters[key])(parameters[key]) for key in map(keys.get, names)}
    dr.enable_grad(list(values.values()))
    parameters.update(values)
    try:
        yield list(values.values())
    finally:
        parameters.update({key: dr.detach(value) for key, value in values.items()})


def _is_weight_spectrum(mi: MitsubaModule, model: Model, name: str) -> bool:
    """Return whether Mitsuba stores a weight, a colour, as the coefficients of a spectrum."""
    return mi.is_spectral and len(np.unique(getattr(model, name))) > 1


def list_free_shapes(model: Model) -> list[str]:
    """Return the shape parameters' names, without those that follow another and equal it."""
    return [name for name in model.free_values if not model.parameters[name].linear]


def depends_on_parameter(model: Model, name: str) -> bool:
    """Return whether the parameter changes some lobe in a way that Dr.Jit can differentiate."""
    values = {
        n: double_precision.to_scalar(getattr(model, n)) for n in model.shapes(anisotropic=True)
    }
    dr.enable_grad(values[name])
    wi, wo = (double_precision.to_vector(w) for w in draw_direction_pairs(2, seed=6))
    bound = model.bind(values)
    lobes = [lobe for _, lobe in bound.terms()]
    terms = [lobe.eval(wi, wo) for lobe in (*lobes, *bound.fixed_lobes())]
    terms += [lobe.quadratic(wi, wo) for lobe in lobes if lobe.quadratic]
    return any(dr.grad_enabled(term) for term in terms)


def compute_exact_derivative(
    model: Model, weights: FloatArray, name: str, wi: FloatArray, wo: FloatArray
) -> FloatArray:
    """Return the exact derivative (n, channels) of the BRDF by the parameter called `name`.

    `weights` (lobes, channels) are those of the model. A weight changes by the same amount in all
    channels; parameters that follow the parameter change with it. Where a negative BRDF is clamped
    at 0, the derivative is 0.
    """
    plain, squared = compute_lobe_values(model, wi, wo)
    if model.parameters[name].linear:
        lobe = model.weights().index(name)
        derivative = plain[:, [lobe]] + 2 * squared[:, [lobe]] * weights[lobe]
    else:
        plain_slopes, squared_slopes, fixed_slopes = _differentiate_lobes(model, name, wi, wo)
        derivative = plain_slopes @ weights + squared_slopes @ weights**2
        derivative += fixed_slopes.sum(axis=1, keepdims=True)
    if not model.has_signed_weights():
        return derivative
    values = plain @ weights + squared @ weights**2 + compute_fixed_values(model, wi, wo)
    return np.where(values > 0, derivative, 0)


def _differentiate_lobes(
    model: Model, name: str, wi: FloatArray, wo: FloatArray
) -> list[FloatArray]:
    """Return all lobes' derivatives with respect to a shape parameter, by Dr.Jit's forward mode.

    A lobe's value is a term times its weight, and in a few models another one times the weight's
    square; a few lobes have no weight. Returns the derivatives of the terms, then those of the
    others, each (n, lobes), then those of the lobes without a weight.
    """
    values = to_shape_scalars(model)
    dr.enable_grad(values[name])
    directions = double_precision.to_vector(wi), double_precision.to_vector(wo)
    Float64 = double_precision.choose_float_type()
    bound = model.bind(values)
    terms = bound.terms()
    plain = [Float64(lobe.eval(*directions)) for _, lobe in terms]
    fixed = [Float64(lobe.eval(*directions)) for lobe in bound.fixed_lobes()] or [Float64(0)]
    squared = [Float64(lobe.quadratic(*directions) if lobe.quadratic else 0) for _, lobe in terms]
    dr.forward_from(values[name])
    return [
        np.stack([np.broadcast_to(np.array(dr.grad(c)), len(wi)) for c in columns], axis=1)
        for columns in (plain, squared, fixed)
    ]


def compute_finite_difference(
    model: Model, name: str, wi: FloatArray, wo: FloatArray
) -> FloatArray:
    """Approximate the derivative (n, channels) of the BRDF by a parameter, by finite differences.

    The differences are central, or one-sided near a bound of the parameter; both are of second
    order.
    """
    value = getattr(model, name)
    low, high = model.parameters[name].bounds
    h = 1e-5 * max(abs(value), 1e-2)
    if value + h > high or value - h < low:
        h = -h if value + 2 * h > high else h
        steps, factors = [0, h, 2 * h], [-1.5, 2, -0.5]
    else:
        steps, factors = [-h, h], [-0.5, 0.5]
    values = [model.changed(**{name: value + step}).eval(wi, wo) for step in steps]
    return sum(factor * f for factor, f in zip(factors, values, strict=True)) / h
