"""A robust fit: weights of the samples and parameters of the model that give each other back.

A pass weighs the samples by their residuals, then takes one step towards the best parameters for
these weights. Far from the end it is the step of MATLAB's robustfit, which solves for the
parameters with the weights held. That step creeps where much of a highlight is an outlier; near the
end it is replaced by Newton's, which knows how the weights change with the parameters. The end is
the same: there, recomputed weights give the solution back.
"""

from dataclasses import dataclass

import numpy as np

from brdfkit.errors import Interrupted
from brdfkit.fitting.acceleration import make_convex
from brdfkit.fitting.box_quadratic import minimise_in_box
from brdfkit.fitting.expansion import Expansion
from brdfkit.fitting.part import draw_part
from brdfkit.fitting.robust import WEIGHTS, least_scale, leverages, require_more_samples, scale_of

PASSES = 150
# So many samples settle on half as many first
MANY = 80_000
# Settled: the next pass would change the fitted values by this share of their spread (rms)
SETTLED = 3e-7
# Few samples settle to this share
EXACTLY = 1e-11
# The same for a part, whose end is only a start
LOOSE = 1e-5
# Where a pass changes them by less than this share, steps are mixed
NEAR = 1e-3
# So many passes of few samples are ordinary ones first, that the end is MATLAB's
ORDINARY = 60
# One of so many samples, those with residuals next to the median, tell how it changes
NEXT = 200
# Step of the central difference in r for the derivative of a weight
SMALL = 1e-4


@dataclass(eq=False)
class Settled:
    """Where the passes ended: coordinates `u` (shapes,), `weights` (channels, lobes), the share of
    samples that are `light`, the number of `passes`, and the change of the last one, as a share of
    the spread."""

    u: np.ndarray
    weights: np.ndarray
    light: float
    passes: int
    change: float

    @property
    def converged(self):
        return self.change <= SETTLED  # of few samples, too: some go round in small circles


class Robust:
    """The passes of a robust fit of a `Problem` by the weight `name`.

    `u`, `weights`: the optimum where all samples count alike, (1, shapes) and (1, channels, lobes);
    `part`, `rows`: a problem on some of the samples and their numbers, which gives the Hessians; by
    default the problem itself.
    """

    def __init__(self, problem, u, weights, name, part=None, rows=slice(None)):
        self.problem, self.part, self.rows = problem, part or problem, rows
        self.function, self.tune, self.rho = WEIGHTS[name]
        self.rank = u.shape[1] + weights.shape[2]
        require_more_samples(len(problem.samples.wi), self.rank)
        # Neither leverages, least scales nor the metric of fitted values change from pass to pass
        self.metric = self.part.expand_here(u, weights).hessian[0]
        self.levers = [np.sqrt(1 - h) for h in self._leverages(u, weights)]
        black = problem.residuals(u, 0 * weights)
        self.least = [least_scale(target) for target in black]
        self.spread = np.sqrt(sum(len(t) * np.var(t) for t in black))

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

    def scale(self, residuals):
        """The tuned scale of the residuals over levers, by channel."""
        adjusted = [r / lever for r, lever in zip(residuals, self.levers, strict=True)]
        return [
            self.tune * scale_of(r, self.rank, least)
            for r, least in zip(adjusted, self.least, strict=True)
        ]

    def ratios(self, residuals, scales):
        """r of the weights: residuals over levers and scales, by channel."""
        both = zip(residuals, self.levers, scales, strict=True)
        return [residual / (lever * scale) for residual, lever, scale in both]

    def say(self, u, weights):
        """By channel, the weights ω of the samples, and the derivatives of ω r by r."""
        residuals = self.problem.residuals(u, weights)
        ratios = self.ratios(residuals, self.scale(residuals))
        return [self.function(r) for r in ratios], [_slope(self.function, r) for r in ratios]

    def merit(self, residuals, scales):
        """What a pass makes small: Σ ρ(r), in units of the squared residuals."""
        both = zip(self.ratios(residuals, scales), scales, strict=True)
        return sum(scale**2 * self.rho(r).sum() for r, scale in both)

    def settle(self, u, weights, report, tolerance=SETTLED, patience=ORDINARY):
        """The `Settled` end of the passes from `u` and `weights`: the next would change the fitted
        values by less than the `tolerance`, or there were too many. The first `patience` passes are
        ordinary ones. On Ctrl-C `Interrupted` has the best end so far."""
        self.best = None
        try:
            return self._pass(u, weights, report, tolerance, patience)
        except KeyboardInterrupt:
            if self.best is None:
                raise
            raise Interrupted(self.best) from None

    def _pass(self, u, weights, report, tolerance, patience):
        """As `settle`."""
        near, rooted = NEAR, False
        residuals = self.problem.residuals(u, weights)
        for number in range(1, PASSES + 1):
            report(number, PASSES)
            scales = self.scale(residuals)
            ratios = self.ratios(residuals, scales)
            factors = [self.function(r) for r in ratios]
            # The step of an ordinary pass, and the change of fitted values that it brings
            gradient, hessian = self._weigh(u, weights, factors)
            ordinary = self._step(hessian, gradient, u, weights)
            change = np.sqrt(max(ordinary @ self.metric @ ordinary, 0)) / (self.spread or 1.0)
            astray = rooted and change > self.best.change
            if self.best is None or change < self.best.change:
                light = float(np.mean([f < 0.5 for f in factors]))
                self.best = Settled(u[0], weights[0], light, number, change)
            if change <= tolerance:
                break
            rooted = False
            if astray:  # back, and nearer to the end by smaller merits first
                u, weights, near = self.best.u[None], self.best.weights[None], self.best.change / 3
                self.part, self.rows = self.problem, slice(None)  # a part's Hessian is too rough
                residuals = self.problem.residuals(u, weights)
                continue
            if number <= patience:
                steps, further = (ordinary,), None
            else:
                newton = self._newton(u, weights, ratios)
                convex, concave = make_convex(newton, hessian)
                step = self._step(convex, gradient, u, weights)
                steps, further = (step, ordinary), None if concave is None else concave @ step
                rooted = change < near
            if rooted:
                # The merit, in which the scales are held, does not decide any more
                step = self._solve(u, weights, residuals, scales, newton, gradient, step)
                u, weights = self._move(u, weights, step)
                residuals = self.problem.residuals(u, weights)
            else:
                u, weights, residuals = self._descend(u, weights, residuals, scales, steps, further)
        self.best.passes = number
        return self.best

    def _newton(self, u, weights, ratios):
        """Newton's matrix, that knows how the weights of the samples change, at held scales."""
        slopes = [_slope(self.function, r[self.rows]) for r in ratios]
        return self._curvature(u, weights, slopes)[0]

    def _solve(self, u, weights, residuals, scales, newton, gradient, step):
        """Newton's step v to where an ordinary pass changes nothing, with the change of the scales;
        what a `step` brings to a bound stays there.

        g + H v + A (B v) = 0, with the columns ∂g/∂ln s of A and the rows ∂ln s/∂z of B.
        """
        by_scale, of_scale = [], []
        for c, r in enumerate(self.ratios(residuals, scales)):
            r = r[self.rows]
            factors = self.function(r) - _slope(self.function, r)
            by_scale.append(self._gradient(u, weights, c, factors))
            of_scale.append(self._gradient(u, weights, c, self._about_median(c, r, scales[c])))
        moved = _join(*self._move(u, weights, step))
        free = np.isclose(moved, _join(u, weights) + step, rtol=0, atol=1e-14)
        A, B = np.array(by_scale).T[free], np.array(of_scale)[:, free]
        found = step.copy()
        found[free] = np.linalg.lstsq(newton[np.ix_(free, free)] + A @ B, -gradient[free])[0]
        return found

    def _gradient(self, u, weights, channel, factors):
        """The gradient (n,) of the part's E² in one channel, its samples weighted by `factors`."""
        every = [0 * factors for _ in weights[0]]
        every[channel] = factors
        return self._expand(self.part, u, weights, every, curvature=False).gradient[0]

    def _about_median(self, channel, r, scale):
        """Weights of the part's samples by which the gradient is that of ln s: of those whose
        residuals, of the ratios `r`, are near the median, which s is of."""
        found = np.zeros(len(r))
        if scale <= self.tune * self.least[channel] * (1 + 1e-9):
            return found
        median, count = 0.6745 / self.tune, max(len(r) // NEXT, 2)
        next_ = np.argpartition(np.abs(np.abs(r) - median), count - 1)[:count]
        levers = self.levers[channel]
        size = np.abs(r[next_]) * median * (scale * levers[self.rows][next_]) ** 2
        found[next_] = 1 / (size * count * (len(levers) / len(r)))
        return found

    def _descend(self, u, weights, residuals, scales, steps, further):
        """The point after the first of the `steps`, or shorter ones, by which the merit at held
        `scales` is smaller, and its residuals; `further`: the part of a step, or None, along which
        the merit bends down: it is repeated, and doubled, while the merit falls."""
        before = self.merit(residuals, scales)
        for tried in (step / share for step in steps for share in (1, 2, 8)):
            found = self._try(u, weights, tried, scales)
            if found[-1] <= before:
                break
        while further is not None and np.any(further):
            tried, further = tried + further, 2 * further
            longer = self._try(u, weights, tried, scales)
            if longer[-1] >= found[-1]:
                break
            found = longer
        return found[:-1]

    def _try(self, u, weights, step, scales):
        """The point after a step, its residuals and its merit."""
        u, weights = self._move(u, weights, step)
        residuals = self.problem.residuals(u, weights)
        return u, weights, residuals, self.merit(residuals, scales)

    def _weigh(self, u, weights, factors):
        """Gradient (n,) and Hessian (n, n) of E² with the samples weighted by `factors`."""
        own = self.part is self.problem
        here = self._expand(self.problem, u, weights, factors, own)
        if own:
            return here.gradient[0], here.hessian[0]
        return here.gradient[0], self._curvature(u, weights, [f[self.rows] for f in factors])[0]

    def _expand(self, problem, u, weights, factors, curvature=True):
        """The `Expansion` of E² with the samples weighted by `factors`."""
        problem.factors = factors
        try:
            sums = problem.sums(u, weights, curvature)
        finally:  # Ctrl-C may come here
            problem.factors = None
        return Expansion.of(problem.columns, problem.space, sums, u, weights)

    def _curvature(self, u, weights, factors):
        """The Hessians (1, n, n) of the part with its samples weighted by `factors`."""
        return self._expand(self.part, u, weights, factors).hessian

    def _step(self, hessian, gradient, u, weights):
        """The step (n,) within the bounds that minimises the quadratic model."""
        z = np.concatenate([u[0], weights[0].ravel()])
        low = np.concatenate([np.zeros(u.shape[1]), np.tile(self.problem.least, weights.shape[1])])
        high = np.concatenate([np.ones(u.shape[1]), np.full(weights[0].size, np.inf)])
        return minimise_in_box(hessian[None], gradient[None], low - z, high - z)[0]

    def _move(self, u, weights, step):
        """The point after a step."""
        shapes = u.shape[1]
        moved = weights + step[shapes:].reshape(weights.shape)
        return np.clip(u + step[:shapes], 0, 1), np.maximum(moved, self.problem.least)


def _by_weights(problem, u, weights):
    """The rows of each block, and by channel the residuals' derivatives (lobes, n) by weights."""
    for rows, _, jacobians in problem.jacobian_blocks(u, weights):
        yield rows, [jacobian[u.shape[1] :] for jacobian in jacobians]


def _join(u, weights):
    return np.concatenate([u[0], weights[0].ravel()])


def _slope(function, r):
    """The derivative of weight times r."""
    ends = [function(r + step) * (r + step) for step in (-SMALL, SMALL)]
    return (ends[1] - ends[0]) / (2 * SMALL)


def settle(problem, u, weights, name, rng, report):
    """The end (u, weights) of a robust fit from the optimum where all samples count alike, a
    message, notes, and what each sample has to say, as `Robust.say`.

    Many samples settle on a part of them first, drawn by the generator `rng`.
    """
    samples = problem.samples
    many = len(samples.wi) > MANY
    if many:
        samples, rows = draw_part(samples, np.ones(len(samples.wi)), MANY // 2, rng)
        part = problem.on(samples)
        found = Robust(part, u, weights, name).settle(u, weights, report, LOOSE, patience=0)
        passes = Robust(problem, u, weights, name, part, rows)
        u, weights = found.u[None], found.weights[None]
    else:
        passes = Robust(problem, u, weights, name)
    how = (SETTLED, 0) if many else (EXACTLY, ORDINARY)
    found = passes.settle(u, weights, report, *how)
    note = f"{name}: {found.light:.1%} of the samples count less than half; the loss is of all"
    message = f"settled in {found.passes} passes"
    if not found.converged:
        message = (
            f"did not settle in {found.passes} passes: the next would change the fitted values by "
            f"{found.change:.1g} of their spread"
        )
    u, weights = found.u[None], found.weights[None]
    return u, weights, message, (note,), passes.say(u, weights)
