"""Describes in sentences which parameters of a fit the data leave open or hardly distinguish.

Parameters "trade off" if a change of one is made up for by a change of another, so that the loss
stays the same: only a combination of them, such as their product, is determined.
"""

from collections.abc import Sequence

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.names import join_words
from brdfkit.regression.certainty_scores import ABSENT

# Notes mention two parameters whose correlation is larger than this
HIGH_CORRELATION = 0.99
# Notes mention parameters whose matrix of correlations has an eigenvalue below this
SMALL_EIGENVALUE = 1e-5


def describe_undetermined_parameters(
    names: Sequence[str], steps: FloatArray, at: FloatArray, vectors: FloatArray
) -> tuple[str, ...]:
    """Return a sentence on each set of parameters that can change without a change of the loss.

    `names`: the n parameters; `vectors` (n, m): m directions, each of length 1, along which the
    loss stays the same; `steps` (n, m): these directions in the units of the parameters; `at`
    (n,): values of the parameters.
    """
    sentences = {}
    # Changes of parameters along each direction, as shares of their values; huge for a value of 0
    shares = np.clip(steps, -1e5, 1e5) / np.where(at == 0, 1e-300, at)[:, None]
    for share_of, vector in zip(shares.T, vectors.T, strict=True):
        relative: dict[str, float] = {}
        for j in np.argsort(-np.abs(vector)):
            if abs(vector[j]) > ABSENT:
                relative.setdefault(_strip_channel(names[j]), share_of[j])
        if len(relative) == 1:
            sentences[f"the data do not determine {next(iter(relative))}"] = True
            continue
        several = sorted(relative, key=lambda name: list(map(_strip_channel, names)).index(name))
        share = relative[several[0]] / relative[several[1]] if len(several) == 2 else np.nan
        sentences[_describe_trade_off(several, share)] = True
    return tuple(sentences)


def describe_parameter_trade_offs(
    names: Sequence[str],
    inverse: FloatArray,
    scale: FloatArray,
    at: FloatArray,
    determined: BoolArray,
) -> tuple[str, ...]:
    """Return sentences on parameters that the data determine, but can hardly tell apart.

    `names`: the n parameters; `inverse` (n, n): inverse of the Hessian of the squared loss, in
    units of `scale` (n,); `at` (n,): values of the parameters; `determined` (n,): whether the data
    determine a parameter.
    """
    (rows,) = np.nonzero(determined)
    errors = np.sqrt(np.diagonal(inverse))[rows]
    correlation = inverse[np.ix_(rows, rows)] / np.outer(errors, errors)
    relative = errors * scale[rows] / np.maximum(np.abs(at[rows]), 1e-300)
    plain = [_strip_channel(names[int(row)]) for row in rows]
    pairs: dict[tuple[str, str], tuple[float, float]] = {}
    for i, j in zip(*np.nonzero(np.triu(np.abs(correlation) > HIGH_CORRELATION, 1)), strict=True):
        pair, size = (plain[i], plain[j]), correlation[i, j]
        if plain[i] != plain[j] and abs(size) > abs(pairs.get(pair, [0])[0]):
            pairs[pair] = size, relative[i] / relative[j]
    worst, sentences = sorted(pairs.items(), key=lambda item: -abs(item[1][0])), []
    for pair, (size, share) in worst[:3]:
        trade = _describe_trade_off(pair, np.copysign(share, size))
        sentences.append(f"{trade} (correlation {size:.4f})")
    if len(worst) > 3:
        sentences.append(f"so do {len(worst) - 3} more pairs of parameters")
    if not worst and len(rows):
        values, vectors = np.linalg.eigh(correlation)
        strong = np.abs(vectors[:, 0]) > 0.1 * np.abs(vectors[:, 0]).max()
        several = list(dict.fromkeys(n for n, is_in in zip(plain, strong, strict=True) if is_in))
        if values[0] < SMALL_EIGENVALUE and len(several) > 1:
            sentences.append(_describe_trade_off(several, np.nan))
    return tuple(sentences)


def _describe_trade_off(names: Sequence[str], ratio: float) -> str:
    """Return a sentence that says which combination of some parameters is determined.

    `ratio`: for two parameters, the relative change of the first over the relative change of the
    second along the direction in which the loss stays the same; NaN for more parameters.
    """
    what = "a combination of them"
    if 0.8 < abs(ratio) < 1.25:
        what = "their product" if ratio < 0 else "their ratio"
    if len(names) > 4:
        names = [*names[:3], f"{len(names) - 3} other parameters"]
    return f"{join_words(names)} trade off: only {what} is determined"


def _strip_channel(name: str) -> str:
    """Return the name of a parameter without its channel, as "weight" for "weight[0]"."""
    return name.partition("[")[0]
