"""Checks of what differentiable fitting and rendering rest on."""

import numpy as np

from brdfkit.checks.subject import checked, random_pairs


@checked
def plugin_is_formula(subject):
    """The Mitsuba BSDF (float32) = the formula in double precision, times the cosine."""
    wi, wo = random_pairs(20_000, seed=5, max_degrees=85)
    formula = subject.thing.eval(wi, wo) * wo[:, 2:]
    difference = np.abs(subject.plugin_eval(wi, wo) - formula)
    worst = float(np.max(difference / np.maximum(formula, 1e-3 * formula.max())))
    return worst < 5e-3, f"relative difference at most {worst:.1e}"


@checked
def gradient(subject):
    """Derivatives by every shape parameter = central finite differences, in double precision."""
    model = subject.model
    if model is None or not model.shapes():
        return True, "no shape parameters"
    wi, wo = random_pairs(2_000, seed=6, max_degrees=80)
    worst = 0.0
    for name, parameter in model.parameters.items():
        if parameter.linear:
            continue
        exact = _derivative(model, name, wi, wo)
        approximate = _difference(model, name, wi, wo)
        scale = np.abs(exact).max() + 1e-12
        worst = max(worst, float(np.abs(exact - approximate).max() / scale))
    return worst < 1e-5, f"relative difference at most {worst:.1e}"


@checked
def plugin_gradient(subject):
    """Derivatives of the Mitsuba BSDF by every parameter = those of the formula."""
    import drjit as dr
    import mitsuba as mi

    model = subject.model
    if model is None:
        return True, "no parameters"
    wi, wo = random_pairs(2_000, seed=7, max_degrees=80)
    cosines = wo[:, 2:]
    parameters = mi.traverse(subject.bsdf)
    worst, missing = 0.0, []
    for name, parameter in model.parameters.items():
        if parameter.follows and getattr(model, name) == getattr(model, parameter.follows):
            continue
        key = next((k for k in parameters.keys() if k.split(".")[0] == name), None)  # noqa: SIM118
        if key is None:
            missing.append(name)
            continue
        value = type(parameters[key])(parameters[key])
        dr.enable_grad(value)
        parameters[key] = value
        parameters.update()
        image = subject.bsdf.eval(
            mi.BSDFContext(), subject.interaction(wi), mi.Vector3f(wo.astype(np.float32).T)
        )
        dr.backward(dr.sum(dr.sum(image)))
        found = float(np.sum(np.array(dr.grad(value))))
        parameters[key] = dr.detach(value)
        parameters.update()
        expected = float((_total_derivative(model, name, wi, wo) * cosines).sum())
        worst = max(worst, abs(found - expected) / max(abs(expected), 1e-6))
    if missing:
        return False, f"not in traverse: {', '.join(missing)}"
    return worst < 1e-3, f"relative difference at most {worst:.1e}"


def _total_derivative(model, name, wi, wo):
    """Derivative (n, 3) of the RGB BRDF, by a weight of all channels or a shape parameter."""
    if not model.parameters[name].linear:
        channels = _derivative(model, name, wi, wo)
        return channels * (3 if channels.shape[1] == 1 else 1)
    from brdfkit.evaluating import lobe_values

    lobe = model.weights().index(name)
    return 3 * lobe_values(model, wi, wo)[:, [lobe]]


def _derivative(model, name, wi, wo):
    """Exact d f / d parameter, (n, channels), by Dr.Jit's forward mode.

    A parameter that follows `name` moves with it.
    """
    import drjit as dr

    from brdfkit import backend

    bound = {
        n: backend.scalar(getattr(model, n))
        for n in model.parameters
        if not model.parameters[n].linear
    }
    for other, parameter in model.parameters.items():
        if parameter.follows == name and getattr(model, other) == getattr(model, name):
            bound[other] = bound[name]
    dr.enable_grad(bound[name])
    directions = backend.vector(wi), backend.vector(wo)
    lobes = [backend.float64()(lobe.eval(*directions)) for lobe in model.bind(bound).lobes()]
    dr.forward_from(bound[name])
    columns = [np.broadcast_to(np.array(dr.grad(lobe)), len(wi)) for lobe in lobes]
    return np.stack(columns, axis=1) @ _weights(model)


def _difference(model, name, wi, wo):
    value = getattr(model, name)
    low, high = model.parameters[name].bounds
    h = 1e-5 * max(abs(value), 1e-2)
    below, above = max(value - h, low), min(value + h, high)
    ends = []
    for v in (below, above):
        values = {**model.values, name: v}
        for other, parameter in model.parameters.items():
            if parameter.follows == name and getattr(model, other) == value:
                values[other] = v
        ends.append(type(model)(**values).eval(wi, wo))
    return (ends[1] - ends[0]) / (above - below)


def _weights(model):
    """Weights (lobes, channels)."""
    weights = [np.atleast_1d(getattr(model, name)) for name in model.weights()]
    channels = max(len(w) for w in weights)
    return np.array([np.broadcast_to(w, channels) for w in weights])
