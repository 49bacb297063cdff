"""Checks of what differentiable fitting and rendering rest on."""

from contextlib import contextmanager

import drjit as dr
import numpy as np

from brdfkit.checks.registry import checked
from brdfkit.checks.sampling import own_weights, uniform
from brdfkit.checks.subject import incidences, random_pairs
from brdfkit.model import double_precision
from brdfkit.model.evaluation import lobe_values, weight_matrix
from brdfkit.plugins.discovery import MODELS


@checked(MODELS)
def plugin_is_formula(subject):
    """The Mitsuba BSDF (float32) = the formula in double precision, times the cosine."""
    wi, wo = random_pairs(20_000, seed=5, max_degrees=85)
    formula = subject.values(wi, wo) * wo[:, 2:]
    difference = np.abs(subject.plugin_eval(wi, wo) - formula)
    worst = float(np.max(difference / np.maximum(formula, 1e-3 * formula.max() + 1e-12)))
    return worst < 5e-3, f"relative difference at most {worst:.1e}"


@checked(MODELS)
def gradient(subject):
    """Derivatives by every shape parameter = central finite differences, in double precision."""
    model = subject.model
    if model is None or not model.shapes():
        return True, "no shape parameters"
    if unused := [n for n in model.shapes(anisotropic=True) if not _has_effect(model, n)]:
        return False, f"{unused[0]} has no effect that Dr.Jit can follow"
    wi, wo = random_pairs(2_000, seed=6, max_degrees=80)
    weights, worst = weight_matrix(model), 0.0
    for name in _free_shapes(model):
        exact = _derivative(model, weights, name, wi, wo)
        difference = np.abs(exact - _difference(model, name, wi, wo))
        worst = max(worst, float(difference.max() / (np.abs(exact).max() + 1e-12)))
    return worst < 1e-5, f"relative difference at most {worst:.1e}"


@checked(MODELS)
def plugin_gradient(subject):
    """Derivatives of the Mitsuba BSDF by every parameter = those of the formula."""
    import mitsuba as mi

    model = subject.model
    if model is None:
        return True, "no parameters"
    wi, wo = random_pairs(2_000, seed=7, max_degrees=80)
    exposed = {key.split(".")[0] for key in mi.traverse(subject.bsdf).keys()}  # noqa: SIM118
    if missing := [name for name in model.free_values if name not in exposed]:
        return False, f"not in traverse: {', '.join(missing)}"
    names = [name for name in model.free_values if not _is_spectrum(mi, model, name)]
    worst = 0.0
    for name in names:
        with _differentiated(subject.bsdf, name) as value:
            image = subject.bsdf.eval(
                mi.BSDFContext(), subject.interaction(wi), mi.Vector3f(wo.astype(np.float32).T)
            )
            dr.backward(_total(mi, image), dr.ADFlag.Default | dr.ADFlag.AllowNoGrad)
            found = float(np.sum(np.array(dr.grad(value))))
        expected = _derivative(model, subject.weights, name, wi, wo) * wo[:, 2:]
        difference = abs(found - float(expected.sum()))
        worst = max(worst, difference / max(float(np.abs(expected).sum()), 1e-6))
    left_out = len(model.free_values) - len(names)
    but = f", but for {left_out} colours that are spectra here" if left_out else ""
    return worst < 1e-3, f"relative difference at most {worst:.1e}{but}"


@checked(MODELS)
def sampling_gradient(subject):
    """Derivatives of a picture by sampling = those of the albedo by cosine samples.

    A sampler that lets its directions, but not its density, depend on a parameter fails.
    """
    import mitsuba as mi

    model = subject.model
    if model is None or not model.shapes():
        return True, "no shape parameters"
    n, wi = 200_000, incidences()[1][1]
    _, u = uniform(n, seed=9)
    wo = np.array(mi.warp.square_to_cosine_hemisphere(u)).T.astype(float)
    worst = 0.0
    for name in _free_shapes(model):
        with _differentiated(subject.bsdf, name) as value:
            weight = own_weights(subject, wi, n, seed=8)
            dr.forward_from(value)
            own = np.array(dr.grad(mi.unpolarized_spectrum(weight)))
            own = np.broadcast_to(own.mean(axis=0, dtype=float), n)
        exact = _derivative(model, subject.weights, name, np.tile(wi, (n, 1)), wo)
        cosine = np.pi * exact.mean(axis=1)
        error = np.hypot(own.std(), cosine.std()) / np.sqrt(n)
        worst = max(worst, abs(own.mean() - cosine.mean()) / max(error, 1e-9))
    return worst < 4.5, f"at most {worst:.1f} standard errors apart"


@contextmanager
def _differentiated(bsdf, name):
    """The value of a BSDF's parameter, with derivatives within the block."""
    import mitsuba as mi

    parameters = mi.traverse(bsdf)
    key = next(k for k in parameters.keys() if k.split(".")[0] == name)  # noqa: SIM118
    value = type(parameters[key])(parameters[key])
    dr.enable_grad(value)
    parameters[key] = value
    parameters.update()
    try:
        yield value
    finally:
        parameters[key] = dr.detach(value)
        parameters.update()


def _has_effect(model, name):
    """Whether a lobe is computed from the parameter."""
    values = {n: double_precision.scalar(getattr(model, n)) for n in model.shapes(anisotropic=True)}
    dr.enable_grad(values[name])
    wi, wo = (double_precision.vector(w) for w in random_pairs(2, seed=6))
    lobes = [lobe for _, lobe in model.bind(values).terms()]
    terms = [lobe.eval(wi, wo) for lobe in lobes]
    terms += [lobe.quadratic(wi, wo) for lobe in lobes if lobe.quadratic]
    return any(dr.grad_enabled(term) for term in terms)


def _total(mi, image):
    """Sum of a spectrum over directions and channels, without its polarisation."""
    return dr.sum(dr.sum(mi.unpolarized_spectrum(image)))


def _is_spectrum(mi, model, name):
    """Whether a weight is a colour where Mitsuba's texture holds the coefficients of a spectrum."""
    return mi.is_spectral and len(np.unique(getattr(model, name))) > 1


def _derivative(model, weights, name, wi, wo):
    """Exact d f / d parameter (n, channels), of a weight that all channels have in common.

    `weights` (lobes, channels); a parameter that follows `name` moves with it. 0 where a sum of
    signed weights is clamped.
    """
    plain, squared = lobe_values(model, wi, wo)
    if model.parameters[name].linear:
        lobe = model.weights().index(name)
        derivative = plain[:, [lobe]] + 2 * squared[:, [lobe]] * weights[lobe]
    else:
        plain_slopes, squared_slopes = _lobe_slopes(model, name, wi, wo)
        derivative = plain_slopes @ weights + squared_slopes @ weights**2
    if not model.signed():
        return derivative
    return np.where(plain @ weights + squared @ weights**2 > 0, derivative, 0)


def _lobe_slopes(model, name, wi, wo):
    """Exact derivatives by a shape parameter of the lobes (n, lobes), and of those of the weights'
    squares, by Dr.Jit's forward mode."""
    values = double_precision.shapes(model)
    dr.enable_grad(values[name])
    directions = double_precision.vector(wi), double_precision.vector(wo)
    Float64 = double_precision.float64()
    terms = model.bind(values).terms()
    plain = [Float64(lobe.eval(*directions)) for _, lobe in terms]
    squared = [Float64(lobe.quadratic(*directions) if lobe.quadratic else 0) for _, lobe in terms]
    dr.forward_from(values[name])
    return [
        np.stack([np.broadcast_to(np.array(dr.grad(c)), len(wi)) for c in columns], axis=1)
        for columns in (plain, squared)
    ]


def _difference(model, name, wi, wo):
    """d f / d parameter, (n, channels), by second-order differences that stay within the bounds."""
    value = getattr(model, name)
    low, high = model.parameters[name].bounds
    h = 1e-5 * max(abs(value), 1e-2)
    if value + h > high or value - h < low:  # one-sided
        h = -h if value + 2 * h > high else h
        steps, factors = (0, h, 2 * h), (-1.5, 2, -0.5)
    else:
        steps, factors = (-h, h), (-0.5, 0.5)
    at = [model.changed(**{name: value + step}).eval(wi, wo) for step in steps]
    return sum(factor * f for factor, f in zip(factors, at, strict=True)) / h


def _free_shapes(model):
    return [name for name in model.free_values if not model.parameters[name].linear]
