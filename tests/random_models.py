"""Models with random values within their bounds, not too narrow for a statistical test."""

import numpy as np

NARROWEST = {"alpha": 0.05, "alpha_u": 0.05, "alpha_v": 0.05}
SHARPEST = {"exponent": 500.0}


def random_model(model, seed, channels=3):
    """`model` with seeded values: weights of a material that reflects less than it receives."""
    rng = np.random.default_rng(seed)
    values = {}
    for name, parameter in model.parameters.items():
        if parameter.linear:
            values[name] = rng.uniform(0.02, 0.2, channels)
            continue
        low = max(parameter.bounds[0], NARROWEST.get(name, -np.inf))
        high = min(parameter.bounds[1], SHARPEST.get(name, np.inf))
        u = rng.uniform()
        values[name] = low * (high / low) ** u if parameter.log else low + u * (high - low)
    return model(**values)
