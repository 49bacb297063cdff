"""Models with random values within their bounds, not too narrow for a statistical test."""

import numpy as np

NARROWEST = {"alpha": 0.05, "alpha_u": 0.05, "alpha_v": 0.05}
SHARPEST = {"exponent": 500.0}


def random_model(model, seed, channels=3, full_bounds=False):
    """`model` with seeded values: weights of a material that reflects less than it receives;
    `full_bounds`: any width and sharpness, and weights from 0 to 1.
    """
    rng = np.random.default_rng(seed)
    values = {}
    brightest = max(p.default for p in model.parameters.values() if p.linear)
    for name, parameter in model.parameters.items():
        if parameter.linear and parameter.bounds[0] < 0:  # small enough that the sum is positive
            noise = rng.uniform(-0.05, 0.05, channels) * brightest
            values[name] = parameter.default + noise
            continue
        if parameter.linear:
            low, high = (0.0, 1.0) if full_bounds else (0.02, 0.2)
            values[name] = rng.uniform(low, high, channels)
            continue
        if full_bounds:
            low, high = parameter.bounds
            values[name] = at(rng.uniform(), low, high, parameter.log)
            continue
        low = max(parameter.bounds[0], NARROWEST.get(name, -np.inf))
        high = min(parameter.bounds[1], SHARPEST.get(name, np.inf))
        values[name] = at(rng.uniform(), low, high, parameter.log)
    return model(**values)


def at(u, low, high, log):
    """The value a share `u` of the way between the bounds."""
    return low * (high / low) ** u if log else low + u * (high - low)
