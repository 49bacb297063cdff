"""Checks of derivatives: of the formula, of the Mitsuba BSDF, and through its sampling."""

from contextlib import contextmanager

import drjit as dr
import numpy as np

from brdfkit.checks.material_subject import incidences, random_pairs
from brdfkit.checks.model_derivatives import (
    exact_derivative,
    finite_difference,
    free_shapes,
    has_effect,
)
from brdfkit.checks.registry import check_of, larger
from brdfkit.checks.sampling import sample_weights, uniform
from brdfkit.core.discovery.plugin_files import MODELS
from brdfkit.model.evaluation import weight_matrix

NO_SHAPES = "nothing to check: no shape parameters"


@check_of(MODELS)
def plugin_is_formula(subject):
    """The Mitsuba BSDF (float32) = the formula in double precision, times the cosine."""
    wi, wo = random_pairs(20_000, seed=5, max_degrees=85)
    formula = subject.values(wi, wo) * wo[:, 2:]
    difference = np.abs(subject.plugin_eval(wi, wo) - formula)
    worst = float(np.max(difference / np.maximum(formula, 1e-3 * formula.max() + 1e-12)))
    return worst < 5e-3, f"relative difference at most {worst:.1e}"


@check_of(MODELS)
def gradient(subject):
    """Derivatives by every shape parameter = finite differences, in double precision."""
    model = subject.model
    if model is None or not model.shapes():
        return True, NO_SHAPES
    if unused := [n for n in model.shapes(anisotropic=True) if not has_effect(model, n)]:
        return False, f"{unused[0]} has no effect that Dr.Jit can follow"
    wi, wo = random_pairs(2_000, seed=6, max_degrees=80)
    weights, worst = weight_matrix(model), 0.0
    for name in free_shapes(model):
        exact = exact_derivative(model, weights, name, wi, wo)
        difference = np.abs(exact - finite_difference(model, name, wi, wo))
        worst = larger(worst, float(difference.max() / (np.abs(exact).max() + 1e-12)))
    return worst < 1e-5, f"relative difference at most {worst:.1e}"


@check_of(MODELS)
def plugin_gradient(subject):
    """Derivatives of the Mitsuba BSDF by every parameter = those of the formula."""
    import mitsuba as mi

    model = subject.model
    if model is None:
        return True, "nothing to check: no parameters"
    wi, wo = random_pairs(2_000, seed=7, max_degrees=80)

    # every parameter is in `mitsuba.traverse`; those whose texture is a spectrum are left out
    exposed = {key.split(".")[0] for key in mi.traverse(subject.bsdf).keys()}  # noqa: SIM118
    if missing := [name for name in model.free_values if name not in exposed]:
        return False, f"not in traverse: {', '.join(missing)}"
    names = [name for name in model.free_values if not _is_spectrum(mi, model, name)]

    # the derivatives of the sum over all directions and channels, against those of the formula
    with _track_gradients(subject.bsdf, names) as values:
        image = subject.bsdf.eval(
            mi.BSDFContext(), subject.interaction(wi), mi.Vector3f(wo.astype(np.float32).T)
        )
        dr.backward(_total(mi, image), dr.ADFlag.Default | dr.ADFlag.AllowNoGrad)
        gradients = [dr.grad(value) for value in values]
        dr.eval(gradients)  # in one kernel: a kernel for each takes that much longer to compile
        found = [float(np.sum(np.array(gradient))) for gradient in gradients]
    worst = 0.0
    for name, derivative in zip(names, found, strict=True):
        expected = exact_derivative(model, subject.weights, name, wi, wo) * wo[:, 2:]
        difference = abs(derivative - float(expected.sum()))
        worst = larger(worst, difference / max(float(np.abs(expected).sum()), 1e-6))

    left_out = len(model.free_values) - len(names)
    but = f"; not checked: {left_out} colours that are spectra in this variant" if left_out else ""
    return worst < 1e-3, f"relative difference at most {worst:.1e}{but}"


@check_of(MODELS)
def sampling_gradient(subject):
    """Derivatives of the mean weight of a sample = those of the albedo, by cosine samples.

    A sampler fails whose directions depend on a parameter while its density does not.
    """
    import mitsuba as mi

    model = subject.model
    if model is None or not model.shapes():
        return True, NO_SHAPES
    n, wi = 200_000, incidences()[1][1]
    _, u = uniform(n, seed=9)
    wo = np.array(mi.warp.square_to_cosine_hemisphere(u)).T.astype(float)
    worst = 0.0
    for name in free_shapes(model):
        # derivatives of the weights, sample by sample
        with _track_gradients(subject.bsdf, [name]) as [value]:
            weight = sample_weights(subject, wi, n, seed=8)
            dr.forward_from(value)
            own = np.array(dr.grad(mi.unpolarized_spectrum(weight)))
            own = np.broadcast_to(own.mean(axis=0, dtype=float), n)

        # derivatives of the formula over the density cos θ / π of cosine samples
        exact = exact_derivative(model, subject.weights, name, np.tile(wi, (n, 1)), wo)
        cosine = np.pi * exact.mean(axis=1)
        error = np.hypot(own.std(), cosine.std()) / np.sqrt(n)
        worst = larger(worst, abs(own.mean() - cosine.mean()) / max(error, 1e-9))
    return worst < 4.5, f"at most {worst:.1f} standard errors apart"


@contextmanager
def _track_gradients(bsdf, names):
    """Within the block Dr.Jit tracks derivatives by parameters of the BSDF; gives their values."""
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


def _total(mi, image):
    """The sum of a spectrum over directions and channels, without its polarisation."""
    return dr.sum(dr.sum(mi.unpolarized_spectrum(image)))


def _is_spectrum(mi, model, name):
    """Whether a weight is a colour that Mitsuba's texture holds as coefficients of a spectrum."""
    return mi.is_spectral and len(np.unique(getattr(model, name))) > 1
