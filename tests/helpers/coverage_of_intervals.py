"""How often 95 % intervals hold the truth: 400 noisy measurements of each model, and of each loss.

    python tests/helpers/coverage_of_intervals.py [MODEL ...] [--loss L] [--noise N] [--robust NAME]

Noise is proportional to the value (3 %), of one size (2 % of the median), or of one size in the
loss's own differences; the first two have the value that was measured as their median. Fits begin
at the truth. Under noise that is not even in the loss's differences a nonlinear loss estimates, of
ever more samples, another value than the truth: noise is therefore small. What ends on a
bound, and what the data do not determine, is left out. A line has all parameters together, and in
brackets the one that is furthest from 95 %.
"""

import argparse
from dataclasses import replace

import numpy as np
from random_models import random_model
from scipy.special import stdtrit

import brdfkit as bk
from brdfkit.checks.material_subject import draw_direction_pairs
from brdfkit.model import labels
from brdfkit.model.samples import Samples
from brdfkit.model.samples.measures import estimate_extents
from brdfkit.regression.certainty import compute_certainty
from brdfkit.regression.losses.named_losses import OFFSET
from brdfkit.regression.problem.parameter_space import Space
from brdfkit.regression.problem.problem import Problem
from brdfkit.regression.robust.search import search_robust_solution
from brdfkit.regression.search.levenberg_marquardt import levenberg_marquardt


def multiply(rng, values, wi, wo, loss):
    return values * np.exp(0.03 * rng.normal(size=values.shape))


def add(rng, values, wi, wo, loss):
    return values + 0.02 * np.median(values) * rng.normal(size=values.shape)


def even(rng, values, wi, wo, loss):
    """Noise of one size in the loss's differences."""
    noise = rng.normal(size=values.shape)
    cos_i = wi[:, 2:]
    both = cos_i * wo[:, 2:]
    if loss == "log":
        return ((both * values + OFFSET) * np.exp(0.02 * noise) - OFFSET) / both
    if loss == "cbrt":
        root = np.cbrt(values * cos_i)
        return (root + 0.005 * root.mean() * noise) ** 3 / cos_i
    if loss == "cosine":
        return values + 0.02 * np.median(values) * noise / cos_i
    return values + 0.02 * np.median(values) * noise


NOISES = {"multiplied": multiply, "added": add, "even": even}


def directions(n, seed):
    """Pairs at random, half of them near the mirror direction."""
    rng = np.random.default_rng(seed)
    wi, wo = draw_direction_pairs(n, seed=seed, max_degrees=75)
    near = wi * [-1, -1, 1] + rng.normal(0, 0.15, wi.shape)
    near /= np.linalg.norm(near, axis=1, keepdims=True)
    use = (np.arange(n) % 2 == 0) & (near[:, 2] > 0.26)
    return wi, np.where(use[:, None], near, wo)


def held(name, loss, noise, replicates, n=600, robust=None, seed=0):
    """Whether each interval held the truth, (replicates, parameters), NaN where there was none, and
    the names of the parameters."""
    model = labels.model(name)
    wi, wo = directions(n, seed)
    drawn = random_model(model, seed + 2, channels=3)
    own = {k: v for k, v in drawn.values.items() if not model.parameters[k].turns}
    sample = Samples.from_arrays(wi, wo, np.ones((n, 3)), None, "RGB", "directions")
    given = model.determine_parameters(sample)
    own |= given
    space = Space.for_model(model, {}, given, False)
    u = np.clip(space.to_coordinates(own), 0.15, 0.85)[None]  # inside the bounds
    own |= space.to_named_values(u[0])
    truth = model(**own)
    values = truth.eval(wi, wo)
    weights = np.array([truth.values[w] for w in model.weights()]).T[None]
    true = dict(zip(space.names, space.to_parameters(u)[0], strict=True))
    for c, own in enumerate(weights[0]):
        true |= {f"{w}[{c}]": v for w, v in zip(model.weights(), own, strict=True)}
    extents = estimate_extents(wi, wo, False, 80.0)
    found = np.full((replicates, len(true)), np.nan)
    for k in range(replicates):
        rng = np.random.default_rng([seed, k])
        noisy = NOISES[noise](rng, values, wi, wo, loss)
        samples = replace(Samples.from_arrays(wi, wo, noisy, None, "RGB", "noisy"), extents=extents)
        problem = Problem(model, samples, bk.losses.named[loss], space)
        ends = levenberg_marquardt(
            problem.expand_loss, u, weights, problem.weight_limits, 50, 1e-10, 1e-4
        ).ends
        point, passes = (ends.u, ends.weights), None
        if robust:
            *point, _, _, passes = search_robust_solution(
                problem, *point, robust, rng, lambda done, total: None
            )
        certainty = compute_certainty(problem, *point, passes)
        values_ = dict(zip(space.names, space.to_parameters(point[0])[0], strict=True))
        for c, own in enumerate(point[1][0]):
            values_ |= {f"{w}[{c}]": v for w, v in zip(model.weights(), own, strict=True)}
        errors = certainty.compute_standard_errors()
        freedom = dict(zip(certainty.names, certainty.freedom, strict=True))
        for j, key in enumerate(true):
            if key in errors:
                found[k, j] = (
                    abs(values_[key] - true[key]) <= stdtrit(freedom[key], 0.975) * errors[key]
                )
    return found, list(true)


def report(names, losses, noises, replicates, robust):
    for name in names:
        for loss in losses:
            cells = []
            for noise in noises:
                inside, own = held(name, loss, noise, replicates, robust=robust)
                known = np.isfinite(inside).mean(axis=0) > 0.9
                if not known.any():
                    cells.append("nothing")
                    continue
                rates = np.nanmean(inside[:, known], axis=0)
                worst = int(np.argmax(np.abs(rates - 0.95)))
                which = [n for n, k in zip(own, known, strict=True) if k][worst]
                cells.append(f"{rates.mean():6.1%} ({rates[worst]:6.1%} {which})")
            print(f"{name:18} {loss:7}", " | ".join(cells), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", nargs="*")
    parser.add_argument("--replicates", type=int, default=400)
    parser.add_argument("--loss", action="append")
    parser.add_argument("--noise", action="append", choices=NOISES)
    parser.add_argument("--robust")
    given = parser.parse_args()
    models = given.models or [name for name in bk.models() if name != "mixture"]
    report(
        models,
        given.loss or bk.losses.named.by_sample,
        given.noise or NOISES,
        given.replicates,
        given.robust,
    )
