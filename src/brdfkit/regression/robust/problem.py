"""A `Problem` whose samples are weighed by their residuals, over the scale of these."""

from dataclasses import dataclass

import numpy as np

from brdfkit.regression.problem.box_quadratic import minimise_in_box
from brdfkit.regression.problem.expansion import Expansion
from brdfkit.regression.problem.parameter_space import join, limits
from brdfkit.regression.robust.reweighting import (
    WEIGHTS,
    least_scale,
    leverages,
    require_more_samples,
    scale_of,
)

# One of so many samples, those with residuals next to the median, tell how it changes
NEXT = 200
# Step of the central difference in r for the derivative of a weight
SMALL = 1e-5


@dataclass(frozen=True, eq=False)
class Point:
    """Coordinates `u` (1, shapes), `weights` (1, channels, lobes), and the residuals there, an
    array (n,) by channel."""

    u: np.ndarray
    weights: np.ndarray
    residuals: list[np.ndarray]

    def join(self):
        """The point as a vector (k,)."""
        return join(self.u, self.weights)[0]


class RobustProblem:
    """A `Problem` with the weight `name` of samples, by their residuals.

    `u`, `weights`: the optimum where all samples count alike, (1, shapes) and (1, channels, lobes);
    `part`, `rows`: a problem on some of the samples and their numbers, which gives the Hessians; by
    default the problem itself. By channel, `scales` are those of the residuals, tuned.

    A residual is a difference times the root of how much its sample counts, and a sample is an
    outlier by the difference alone. So `levers` hold that root, beside √(1 - h).
    """

    def __init__(self, problem, u, weights, name, part=None, rows=slice(None)):
        self.problem, self.part, self.rows = problem, part or problem, rows
        self.function, self.tune, self.rho = WEIGHTS[name]
        self.rank = u.shape[1] + weights.shape[2]
        require_more_samples(len(problem.samples.wi), self.rank)
        # Neither leverages, least scales nor the metric of fitted values change from pass to pass
        self.metric = self.part.expand_here(u, weights).hessian[0]
        root = np.sqrt(problem.importance / problem.importance.mean())
        root[root == 0] = 1.0  # its residual is 0
        self.levers = [root * np.sqrt(1 - h) for h in self._leverages(u, weights)]
        black = problem.residuals(u, 0 * weights)
        self.least = [least_scale(target / root) for target in black]
        self.spread = np.sqrt(sum(len(t) * np.var(t) for t in black)) or 1.0
        self.low, self.high = limits(u.shape[1], problem.channels, problem.least)

    def _leverages(self, u, weights):
        """The leverages (n,) of the linear parameters, by channel: exact, or of a part's size."""
        if self.part is self.problem:
            blocks = [own for _, own in _by_weights(self.problem, u, weights)]
            return [leverages(np.concatenate(own, axis=1)) for own in zip(*blocks, strict=True)]
        # A part's columns, as many times as it is smaller than the whole
        blocks = [own for _, own in _by_weights(self.part, u, weights)]
        inverses = []
        for own in zip(*blocks, strict=True):
            gram = sum(columns @ columns.T for columns in own)
            inverses.append(np.linalg.pinv(gram, hermitian=True))
        found = [np.empty(len(self.problem.samples.wi)) for _ in inverses]
        for rows, by_channel in _by_weights(self.problem, u, weights):
            for h, inverse, columns in zip(found, inverses, by_channel, strict=True):
                h[rows] = np.minimum((columns * (inverse @ columns)).sum(axis=0), 0.9999)
        return found

    def forget_part(self):
        """From now on the Hessians are those of all samples."""
        self.part, self.rows = self.problem, slice(None)

    def at(self, u, weights):
        """The `Point` of coordinates and weights."""
        return Point(u, weights, self.problem.residuals(u, weights))

    def move(self, point, step):
        """The `Point` after a step (k,), within the bounds."""
        shapes = point.u.shape[1]
        moved = point.weights + step[shapes:].reshape(point.weights.shape)
        u = np.clip(point.u + step[:shapes], 0, 1)
        return self.at(u, np.maximum(moved, self.problem.least))

    def scales(self, point):
        """The scales at a point."""
        adjusted = [r / lever for r, lever in zip(point.residuals, self.levers, strict=True)]
        return [
            self.tune * scale_of(r, self.rank, least)
            for r, least in zip(adjusted, self.least, strict=True)
        ]

    def ratios(self, point, scales):
        """r of the weights: residuals over levers and scales, by channel."""
        both = zip(point.residuals, self.levers, scales, strict=True)
        return [residual / (lever * scale) for residual, lever, scale in both]

    def merit(self, point, scales):
        """What a pass makes small: Σ lever² ρ(r), in units of the squared residuals."""
        each = zip(self.ratios(point, scales), self.levers, scales, strict=True)
        return sum(scale**2 * (lever**2 * self.rho(r)).sum() for r, lever, scale in each)

    def say(self, u, weights):
        """By channel, the weights ω of the samples, and the derivatives of ω r by r."""
        point = self.at(u, weights)
        ratios = self.ratios(point, self.scales(point))
        return [self.function(r) for r in ratios], [self._slope(r) for r in ratios]

    def weigh(self, point, factors):
        """Gradient (k,) and Hessian (k, k) of E² with the samples weighted by `factors`."""
        own = self.part is self.problem
        here = self._expand(self.problem, point, factors, own)
        if not own:
            factors = [f[self.rows] for f in factors]
        hessian = here.hessian if own else self._expand(self.part, point, factors).hessian
        return here.gradient[0], hessian[0]

    def newton(self, point, ratios):
        """Newton's matrix (k, k), that knows how the weights of the samples change, at held
        scales."""
        slopes = [self._slope(r[self.rows]) for r in ratios]
        return self._expand(self.part, point, slopes).hessian[0]

    def by_scales(self, point, ratios, scales):
        """The derivatives ∂g/∂ln s (k, channels) of the gradient, and ∂ln s/∂z (channels, k)."""
        of_gradient, of_scale = [], []
        for c, (r, scale) in enumerate(zip(ratios, scales, strict=True)):
            r = r[self.rows]
            of_gradient.append(self._gradient(point, c, self.function(r) - self._slope(r)))
            of_scale.append(self._gradient(point, c, self._about_median(c, r, scale)))
        return np.array(of_gradient).T, np.array(of_scale)

    def best_step(self, hessian, gradient, point):
        """The step (k,) within the bounds that minimises the quadratic model."""
        z = point.join()
        return minimise_in_box(hessian[None], gradient[None], self.low - z, self.high - z)[0]

    def _gradient(self, point, channel, factors):
        """The gradient (k,) of the part's E² in one channel, its samples weighted by `factors`."""
        every = [0 * factors for _ in self.levers]
        every[channel] = factors
        return self._expand(self.part, point, every, curvature=False).gradient[0]

    def _about_median(self, channel, r, scale):
        """Weights of the part's samples by which the gradient is that of ln s: of those whose
        residuals, of the ratios `r`, are next to the median, which s is of."""
        found = np.zeros(len(r))
        if scale <= self.tune * self.least[channel] * (1 + 1e-9):
            return found
        median, count = 0.6745 / self.tune, max(len(r) // NEXT, 2)
        near = np.argpartition(np.abs(np.abs(r) - median), count - 1)[:count]
        levers = self.levers[channel]
        size = np.abs(r[near]) * median * (scale * levers[self.rows][near]) ** 2
        found[near] = 1 / (size * count * (len(levers) / len(r)))
        return found

    def _expand(self, problem, point, factors, curvature=True):
        """The `Expansion` of E² with the samples weighted by `factors`."""
        problem.factors = factors
        try:
            sums = problem.sums(point.u, point.weights, curvature)
        finally:  # Ctrl-C may come here
            problem.factors = None
        return Expansion.of(problem.columns, problem.space, sums, point.u, point.weights)

    def _slope(self, r):
        """The derivative of weight times r."""
        ends = [self.function(r + step) * (r + step) for step in (-SMALL, SMALL)]
        return (ends[1] - ends[0]) / (2 * SMALL)


def _by_weights(problem, u, weights):
    """The rows of each block, and by channel the residuals' derivatives (lobes, n) by weights."""
    for rows, _, jacobians in problem.jacobian_blocks(u, weights):
        yield rows, [jacobian[u.shape[1] :] for jacobian in jacobians]
