"""How certain a fit's parameters are: their covariance, from the derivatives at its end.

The sandwich of Eicker, Huber and White, H⁻¹ (Σ g gᵀ) H⁻¹: H is the Hessian of Gauss and Newton, g
what a sample adds to the gradient of E², all its channels together, over the square root of 1 - its
leverage. [MacKinnon & White 1985]. It supposes that samples are independent, not that their noise
is equally large or that their channels are independent.
"""

from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.names import join_words
from brdfkit.regression.problem.parameter_space import join, of_channel
from brdfkit.regression.problem.subset import draw_part

# More samples are judged by a part of half as many
MANY = 40_000
# Eigenvalues of a Hessian of unit diagonal that are rounding; parts of its eigenvectors that are
SINGULAR, ABSENT = 1e-11, 1e-3
# A correlation, and an eigenvalue of correlations, that one should know of
CLOSE, NARROW = 0.99, 1e-5
# A parameter so near to its bound, as a share of the range, is on it
ON_BOUND = 1e-6


@dataclass(frozen=True)
class Certainty:
    """What the data say of the parameters, weights as "diffuse_reflectance[0]" by channel.

    `names`: parameters that they determine; `covariance`: of these, in rows; `freedom`: the degrees
    of freedom of their variances; `undetermined`: what they leave open, in sentences; what is on a
    bound or fixed is in neither. `trades`: what they hardly tell apart, in sentences. `numbers`:
    how many were measured, of samples that count; `parameters`: how many were searched.
    """

    names: tuple[str, ...]
    covariance: tuple[tuple[float, ...], ...]
    freedom: tuple[float, ...]
    undetermined: tuple[str, ...]
    trades: tuple[str, ...]
    numbers: int
    parameters: int

    def standard_errors(self):
        """The standard error of each of `names`."""
        variances = np.diagonal(self.matrix())
        return dict(zip(self.names, np.sqrt(variances).tolist(), strict=True))

    def half_widths(self):
        """Half of the 95 % interval of each of `names`, by Student's t."""
        from scipy.special import stdtrit

        quantiles = stdtrit(np.array(self.freedom), 0.975).tolist()
        errors = self.standard_errors().items()
        return {name: t * error for t, (name, error) in zip(quantiles, errors, strict=True)}

    def criterion(self, loss, price):
        """N ln(E²) + `price` k, of an error E, the `loss`, N numbers and k parameters."""
        with np.errstate(divide="ignore"):
            return float(self.numbers * 2 * np.log(loss) + price * self.parameters)

    def bic(self, loss):
        """The Bayesian criterion of an error E, the `loss`."""
        return self.criterion(loss, np.log(self.numbers))

    def matrix(self):
        """The covariance (n, n)."""
        return np.array(self.covariance).reshape(len(self.names), len(self.names))

    def without_errors(self, numbers):
        """The same without standard errors, for what has no independent noise, as pixels that show
        the same samples; `numbers`: how many were measured."""
        return replace(self, names=(), covariance=(), freedom=(), numbers=numbers)

    def correlation(self):
        """The correlation (n, n)."""
        root = np.sqrt(np.maximum(np.diagonal(self.matrix()), 1e-300))
        return self.matrix() / np.outer(root, root)


def intervals(values, half):
    """The intervals (low, high) of `values` by name, numbers or tuples, of these `half` widths."""
    found = {}
    for name, value in values.items():
        if isinstance(value, tuple):
            pairs = zip(value, half[name], strict=True)
            found[name] = tuple((v - h, v + h) for v, h in pairs)
        else:
            found[name] = (value - half[name], value + half[name])
    return found


def certify(problem, u, weights, passes=None, rng=None):
    """The `Certainty` of a solution of a `Problem`: `u` (1, shapes), `weights` (1, channels,
    lobes). `passes`: of a robust fit, by channel the factors ω of the samples and the derivatives
    of ω r by r; `rng`: a generator, by which a part of many samples is drawn."""
    names, free = _list_parameters(problem, u, weights)
    at = join(problem.space.table(u), weights)[0]
    counted = problem.importance > 0
    numbers = int(counted.sum()) * problem.channels
    nothing = Certainty((), (), (), (), (), numbers, len(names))
    if numbers <= len(names) or not free.any():
        return nothing
    shares = np.ones(len(counted))
    if len(counted) > MANY and rng is not None:
        part, rows = draw_part(problem.samples, problem.black, MANY // 2, rng)
        whole, problem = problem.importance[rows], problem.on(part)
        shares = whole / np.where(problem.importance > 0, problem.importance, 1)
        passes = passes and [[array[rows] for array in by_channel] for by_channel in passes]
    residuals, jacobians = problem.jacobians(u, weights)
    free |= _find_open_bounds(jacobians, free, u.shape[1])
    scores, hessian, scale = _sum(residuals, jacobians, free, u.shape[1], shares, passes)
    most = (numbers - len(names)) / problem.channels
    return conclude(names, free, at, scores, hessian, scale, numbers, most)


def conclude(names, free, at, scores, hessian, scale, numbers, most):
    """The `Certainty` of `names`, of which those that are `free` (n,) may move from where they are,
    `at` (n,). By the free ones, in units of `scale`: `scores` (free, samples), what each sample
    adds to the gradient of E², and the `hessian`. `numbers`: how many were measured; `most`: the
    degrees of freedom that a variance can have."""
    # Directions in which E² does not rise
    values, vectors = np.linalg.eigh(hessian)
    open_ = np.abs(values) <= SINGULAR * max(values.max(), 1)
    inner = vectors[:, ~open_] / np.abs(values[~open_]) @ vectors[:, ~open_].T
    spread = inner @ scores
    covariance = spread @ spread.T * np.outer(scale, scale)
    freedom = _count_freedom(spread, most)
    loose = (np.abs(vectors[:, open_]) > ABSENT).any(axis=1)
    own = [name for name, is_free in zip(names, free, strict=True) if is_free]
    return Certainty(
        tuple(name for name, is_loose in zip(own, loose, strict=True) if not is_loose),
        tuple(map(tuple, covariance[np.ix_(~loose, ~loose)].tolist())),
        tuple(freedom[~loose].tolist()),
        _describe_open(own, vectors[:, open_] * scale[:, None], at[free], vectors[:, open_]),
        _describe_trades(own, inner, scale, at[free], ~loose),
        numbers,
        len(names),
    )


def _count_freedom(spread, most):
    """The degrees of freedom (n,) of each variance, the sum of squares of `spread` (n, samples), by
    Satterthwaite, at most so many: few where a few samples decide a parameter."""
    squares = spread * spread
    total, fourth = squares.sum(axis=1), (squares * squares).sum(axis=1)
    # The fourth moment of Gaussian noise is 3 times the square of its second
    return np.clip(3 * total**2 / np.maximum(fourth, 1e-300), 1, most)


def _list_parameters(problem, u, weights):
    """The names of all searched parameters, and which are free to move: not on a bound."""
    names = list(problem.space.names)
    for c in range(problem.channels):
        names += [f"{name}[{c}]" for name in problem.model.weights()]
    inside = (u[0] > ON_BOUND) & (u[0] < 1 - ON_BOUND)
    return names, np.concatenate([inside, (weights[0] > problem.least).ravel()])


def _find_open_bounds(jacobians, free, shapes):
    """Return which parameters (n,) are shape parameters on a bound that E² does not determine.

    E² stays as it is when such a parameter moves together with others, so where a search ended
    along this direction, on the bound or off it, is due to rounding. `free` (n,): the parameters
    that are not on a bound; `jacobians`: derivatives (shapes + lobes, samples) by channel.
    """
    is_open = np.zeros(len(free), bool)
    moving = free.copy()
    # A derivative of 0, as of a lobe without weight, would make a parameter a direction by itself
    moving[:shapes] |= np.any([jacobian[:shapes].any(axis=1) for jacobian in jacobians], axis=0)
    if (moving != free).any():
        hessian, _, _, _ = _sum_hessian(jacobians, moving, shapes)
        values, vectors = np.linalg.eigh(hessian)
        null = vectors[:, np.abs(values) <= SINGULAR * max(values.max(), 1)]
        is_open[moving] = (np.abs(null) > ABSENT).any(axis=1)
    return is_open & ~free


def _sum_hessian(jacobians, free, shapes):
    """Return the Hessian (n, n) of the `free` parameters, in units that make its diagonal 1, these
    units (n,), and by channel the rows of its parameters and their derivatives."""
    where = np.cumsum(free) - 1
    rows, derivatives = [], []
    for c, jacobian in enumerate(jacobians):
        own = of_channel(c, shapes, len(jacobian) - shapes)
        rows.append(where[own[free[own]]])
        derivatives.append(jacobian[free[own]])
    hessian = np.zeros((free.sum(), free.sum()))
    for own, jacobian in zip(rows, derivatives, strict=True):
        hessian[np.ix_(own, own)] += jacobian @ jacobian.T
    scale = 1 / np.sqrt(np.maximum(np.diagonal(hessian), 1e-300))
    return hessian * np.outer(scale, scale), scale, rows, derivatives


def _sum(residuals, jacobians, free, shapes, shares, passes):
    """By free parameters, each in units of `scale`: scores (n, samples), over the root of 1 - the
    leverage, and the Hessian (n, n) with a diagonal of 1; and the `scale` (n,)."""
    hessian, scale, owns, jacobians = _sum_hessian(jacobians, free, shapes)
    inverse = np.linalg.pinv(hessian, rcond=SINGULAR, hermitian=True)
    scores = np.zeros((len(hessian), len(shares)))
    for c, (own, jacobian) in enumerate(zip(owns, jacobians, strict=True)):
        jacobian *= scale[own, None]
        lever = (jacobian * (inverse[np.ix_(own, own)] @ jacobian)).sum(axis=0) * shares
        factor = np.sqrt(shares / np.maximum(1 - lever, 1e-4))
        if passes:
            factor = factor * passes[0][c]
        scores[own] += jacobian * (residuals[c] * factor)
    if passes:
        hessian = np.zeros_like(hessian)
        for own, jacobian, slope in zip(owns, jacobians, passes[1], strict=True):
            hessian[np.ix_(own, own)] += (jacobian * slope) @ jacobian.T
    return scores, hessian, scale


def _describe_open(names, steps, at, vectors):
    """A sentence on each of the `vectors` (n, count) along which E² does not rise; `steps`: the
    same, in units of the parameters, which are `at` (n,)."""
    said = {}
    # Relative changes; of what is 0, as good as infinite ones
    shares = np.clip(steps, -1e5, 1e5) / np.where(at == 0, 1e-300, at)[:, None]
    for share_of, vector in zip(shares.T, vectors.T, strict=True):
        relative = {}
        for j in np.argsort(-np.abs(vector)):
            if abs(vector[j]) > ABSENT:
                relative.setdefault(_plain(names[j]), share_of[j])
        if len(relative) == 1:
            said[f"the data do not determine {next(iter(relative))}"] = True
            continue
        several = sorted(relative, key=lambda name: list(map(_plain, names)).index(name))
        share = relative[several[0]] / relative[several[1]] if len(several) == 2 else np.nan
        said[_describe_trade(several, share)] = True
    return tuple(said)


def _describe_trade(names, share):
    """The sentence on parameters that trade off; `share`: the change of the first of two, relative
    to its value, over that of the second."""
    what = "a combination of them"
    if 0.8 < abs(share) < 1.25:
        what = "their product" if share < 0 else "their ratio"
    if len(names) > 4:
        names = [*names[:3], f"{len(names) - 3} other parameters"]
    return f"{join_words(names)} trade off: only {what} is determined"


def _plain(name):
    """The name of a parameter without its channel."""
    return name.partition("[")[0]


def explain_end(certainty):
    """The message of a fit whose numbers say nothing of certainty, or None."""
    known, sought = certainty.numbers, certainty.parameters
    if known < sought:
        return f"underdetermined: the values are some of many that meet the {known} numbers"
    if known == sought:
        return f"as many numbers as parameters, {known}: nothing tells how certain the values are"
    if certainty.undetermined:
        return "ended, and not all values are determined"
    return None


def _describe_trades(names, inverse, scale, at, closed):
    """Sentences on the parameters that the Hessian, of this `inverse` (n, n) in units of `scale`,
    hardly tells apart: of the directions that were measured, whatever their noise. `at`: where they
    are; `closed`: those that are determined."""
    (rows,) = np.nonzero(closed)
    errors = np.sqrt(np.diagonal(inverse))[rows]
    correlation = inverse[np.ix_(rows, rows)] / np.outer(errors, errors)
    relative = errors * scale[rows] / np.maximum(np.abs(at[rows]), 1e-300)
    plain = [_plain(names[row]) for row in rows]
    pairs = {}
    for i, j in zip(*np.nonzero(np.triu(np.abs(correlation) > CLOSE, 1)), strict=True):
        pair, size = (plain[i], plain[j]), correlation[i, j]
        if plain[i] != plain[j] and abs(size) > abs(pairs.get(pair, [0])[0]):
            pairs[pair] = size, relative[i] / relative[j]
    worst, said = sorted(pairs.items(), key=lambda item: -abs(item[1][0])), []
    for pair, (size, share) in worst[:3]:
        trade = _describe_trade(pair, np.copysign(share, size))
        said.append(f"{trade} (correlation {size:.4f})")
    if len(worst) > 3:
        said.append(f"so do {len(worst) - 3} more pairs of parameters")
    if not worst and len(rows):
        values, vectors = np.linalg.eigh(correlation)
        strong = np.abs(vectors[:, 0]) > 0.1 * np.abs(vectors[:, 0]).max()
        several = list(dict.fromkeys(n for n, is_in in zip(plain, strong, strict=True) if is_in))
        if values[0] < NARROW and len(several) > 1:
            said.append(_describe_trade(several, np.nan))
    return tuple(said)
