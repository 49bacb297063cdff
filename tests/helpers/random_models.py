"""Models with random values within their bounds, not too narrow for a statistical test."""

import numpy as np

# By the end of a parameter's name: those of a mixture have the model's before it
NARROWEST = {"alpha": 0.05, "alpha_u": 0.05, "alpha_v": 0.05}
SHARPEST = {"exponent": 500.0}


def random_model(model, seed, channels=3, full_bounds=False):
    """`model` with seeded values: weights of a material that reflects less than it receives;
    `full_bounds`: any width and sharpness, and weights from 0 to 1, or from -1 where they may be
    negative.
    """
    rng = np.random.default_rng(seed)
    values = {}
    brightest = max(p.default for p in model.parameters.values() if p.linear)
    for name, parameter in model.parameters.items():
        if parameter.linear and parameter.bounds[0] < 0:
            # 0.05: small enough that the sum is positive
            noise = 1.0 if full_bounds else 0.05 * brightest
            values[name] = parameter.default + rng.uniform(-noise, noise, channels)
            continue
        if parameter.linear:
            low, high = (0.0, 1.0) if full_bounds else (0.02, 0.2)
            values[name] = rng.uniform(low, high, channels)
            continue
        if full_bounds:
            low, high = parameter.bounds
            values[name] = at(rng.uniform(), low, high, parameter.log)
            continue
        low = max([parameter.bounds[0], *(v for n, v in NARROWEST.items() if name.endswith(n))])
        high = min([parameter.bounds[1], *(v for n, v in SHARPEST.items() if name.endswith(n))])
        values[name] = at(rng.uniform(), low, high, parameter.log)
    return model(**values)


def at(u, low, high, log):
    """The value a share `u` of the way between the bounds."""
    return low * (high / low) ** u if log else low + u * (high - low)
