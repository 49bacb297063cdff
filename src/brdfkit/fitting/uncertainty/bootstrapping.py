"""`bootstrap`: standard errors and intervals of a fit, from fits to resampled measurements."""

from __future__ import annotations

from dataclasses import dataclass, replace
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.documents import Document, Paragraph, Shown, Table
from brdfkit.core.documents.parts import SOFT
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.core.progress_bar import Progress
from brdfkit.fitting.settings import prepare_refit
from brdfkit.materials.resolve import MaterialLike
from brdfkit.regression import Fit


@dataclass(frozen=True, repr=False, eq=False)
class Bootstrap(Shown):
    """Estimates of the parameters from fits to resampled measurements; prints as a table.

    Attributes
    ----------
    fit : Fit
        The fit whose uncertainty is estimated.
    estimates : dict of str to ndarray
        Values of each parameter in all fits, by name: (draws,), or (draws, channels) for a weight.
    """

    fit: Fit
    estimates: dict[str, NDArray[np.float64]]

    @property
    def standard_errors(self) -> dict[str, NDArray[np.float64]]:
        """The standard deviation of each parameter's estimates, a number or one per channel."""
        return {name: values.std(axis=0, ddof=1) for name, values in self.estimates.items()}

    def intervals(self, level: float = 0.95) -> dict[str, NDArray[np.float64]]:
        """Return the percentiles (low, high) that enclose the share `level` of the estimates.

        >>> bootstrap(fit("plaster", "ward"), "plaster").intervals(0.9)    # doctest: +SKIP
        """
        if not isinstance(level, Real) or not 0 < level < 1:
            raise BrdfkitError(f"level = {level!r} should be a share, between 0 and 1.")
        ends = [(1 - level) / 2, (1 + level) / 2]
        return {
            name: np.quantile(values, ends, axis=0).T for name, values in self.estimates.items()
        }

    def document(self) -> Document:
        """Return the table of the parameters' values, with standard errors and intervals."""
        rows = []
        intervals, errors = self.intervals(), self.standard_errors
        for name, value in self.fit.values.items():
            texts = [
                f"{v:.6g} ± {e:.2g} ({low:.5g} to {high:.5g})"
                for v, e, (low, high) in zip(
                    np.atleast_1d(value),
                    np.atleast_1d(errors[name]),
                    np.reshape(intervals[name], (-1, 2)),
                    strict=True,
                )
            ]
            rows.append((name, "  ".join(texts)))
        count = len(next(iter(self.estimates.values())))
        title = f"{self.fit.name} fitted to {self.fit.data}: standard errors and 95 % intervals"
        return Document(
            title, (Table(tuple(rows)), Paragraph(f"of {count} fits to samples drawn anew", SOFT))
        )


@in_turn
def bootstrap(
    fit: Fit,
    material: MaterialLike,
    *,
    draws: int = 200,
    seed: int = 0,
    progress: Progress | None = None,
) -> Bootstrap:
    """Estimate standard errors and intervals of a fit's parameters by the bootstrap.

    For each draw, samples are taken at random and with replacement, as many as were fitted, and the
    model is fitted to them again, from the values of the fit [Efron & Tibshirani 1993]. Like
    `Fit.standard_errors`, the bootstrap assumes that samples are independent; unlike them, it does
    not assume that the model is nearly linear.

    Parameters
    ----------
    fit : Fit
        The fit, without ``weights`` or standard errors of the measurement.
    material : Measured, str or Path
        The material that was fitted, or its name or path.
    draws : int, default 200
        Number of resampled measurements and of fits, at least 2.
    seed : int, default 0
        Seed of the random draws.
    progress : callable, optional
        Called with (fits done, fits in all).

    Returns
    -------
    Bootstrap
        The parameters' values in all fits; prints as a table.

    Raises
    ------
    BrdfkitError
        Where `material` was not measured or no sample is left, and for a fit that used standard
        errors of the measurement.

    Examples
    --------
    >>> print(bootstrap(fit("plaster", "ward"), "plaster"))    # doctest: +SKIP
    """
    draws, seed = to_whole_number("draws", draws, least=2), to_whole_number("seed", seed, least=0)
    again = prepare_refit(fit, material)
    problem, samples, rng = again.make_problem(), again.samples, np.random.default_rng(seed)
    refitted = []
    for number in range(1, draws + 1):
        times = np.bincount(rng.integers(len(samples.wi), size=len(samples.wi)))
        (rows,) = np.nonzero(times)
        drawn = samples.at(rows)
        drawn = replace(drawn, weight=drawn.weight * times[rows])
        part = problem.with_samples(drawn)
        shapes, weights, _ = again.search_from_start(part, fit.values, again.weights, rng)
        refitted.append(again.to_named_values(shapes, weights))
        if progress:
            progress(number, draws)
    return Bootstrap(fit, {name: np.array([f[name] for f in refitted]) for name in refitted[0]})
