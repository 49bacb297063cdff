"""`profile`: the least loss as a function of one parameter, and the parameter's interval."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from brdfkit.core.arguments import to_whole_number
from brdfkit.core.documents import Document, Picture, Shown
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.figures import Plot, to_png
from brdfkit.core.jit.threads import in_turn
from brdfkit.fitting.settings import prepare_refit
from brdfkit.materials.resolve import MaterialLike
from brdfkit.regression import Fit
from brdfkit.regression.profiling import estimate_profile_curvature, follow_profile


@dataclass(frozen=True, eq=False, repr=False)
class Profile(Shown):
    """The least loss as a function of one parameter, and its 95 % interval; prints as a line.

    Attributes
    ----------
    fit : Fit
        The fit whose uncertainty is estimated.
    parameter : str
        Name of the shape parameter.
    values : ndarray, shape (points,)
        Values of the parameter, including its value in the fit.
    losses : ndarray, shape (points,)
        The least error E at each of these values.
    level : float
        Values of the parameter belong to the 95 % interval if their E is at most this level.
    interval : tuple of float
        The values (low, high) where E crosses the level, or the parameter's bound where E stays
        below the level.
    """

    fit: Fit
    parameter: str
    values: NDArray[np.float64]
    losses: NDArray[np.float64]
    level: float
    interval: tuple[float, float]

    @property
    def value(self) -> float:
        """The parameter's value in the fit."""
        return float(np.ravel(self.fit.values[self.parameter])[0])

    def plot(self) -> Figure:
        """Draw the loss over the parameter, with the level and the 95 % interval."""
        figure = Plot(figsize=(5, 3.2), layout="constrained")
        axes = figure.add_subplot(xlabel=self.parameter, ylabel=f"{self.fit.loss_name} loss")
        axes.plot(self.values, self.losses, color="#0072b2")
        axes.axhline(self.level, color="0.45", linestyle="--", linewidth=1)
        axes.axvspan(*self.interval, color="#0072b2", alpha=0.15, linewidth=0)
        axes.axvline(self.value, color="black", linewidth=1)
        axes.set_title(f"{self.fit.name} fitted to {self.fit.data}: 95 % by the profile", size=10)
        return figure

    def document(self) -> Document:
        """Return the parameter's value with its interval, and the plot."""
        low, high = self.interval
        line = f"{self.parameter} = {self.value:.6g}, 95 %: {low:.6g} to {high:.6g}, by its profile"
        says = f"the {self.fit.loss_name} loss over {self.parameter}"
        return Document(line, (Picture(lambda: to_png(self.plot()), says, 500),))


@in_turn
def profile(fit: Fit, material: MaterialLike, *, parameter: str, points: int = 25) -> Profile:
    """Compute the profile of the loss over a shape parameter, and its 95 % interval.

    At each value of the parameter the loss is minimised over all other parameters. The interval
    contains the values whose E² stays below a level [Bates & Watts 1988]: the level that a parabola
    with the curvature of E² at the fit reaches at the ends of `Fit.intervals`. The assumptions
    about the noise are those of `Fit.intervals`, but the model need not be nearly linear.

    Parameters
    ----------
    fit : Fit
        The fit, without a robust weight, ``weights`` or standard errors of the measurement.
    material : Measured, str or Path
        The material that was fitted, or its name or path.
    parameter : str
        Name of a shape parameter that was searched, as ``"alpha_u"``.
    points : int, default 25
        Number of values of the parameter, at least 5.

    Returns
    -------
    Profile
        The losses and the interval; prints as a line, and plots.

    Raises
    ------
    BrdfkitError
        For a parameter that was not searched; for a robust fit, a fit that used standard errors of
        the measurement, or one that was corrected to keep the measured albedo; where `material` was
        not measured; and where there are no more measured numbers than parameters.

    Examples
    --------
    >>> profile(fit("plaster", "ward"), "plaster", parameter="alpha_u").interval    # doctest: +SKIP
    (0.23, 0.25)
    """
    from scipy.special import stdtrit

    points = to_whole_number("points", points, least=5)
    again = prepare_refit(fit, material)
    again.require_uncorrected_albedo()
    space = again.make_problem().space
    if parameter not in space.names:
        raise BrdfkitError(
            f"{fit.name}: {parameter} was not searched, so it has no profile; searched were "
            f"{', '.join(space.names) or 'none'}."
        )
    freedom = fit.degrees_of_freedom or 0
    if fit.settings.get("robust") or freedom < 1:
        why = "is robust, and minimises no loss" if freedom >= 1 else "has no number to spare"
        raise BrdfkitError(
            f"{fit.name}: the fit {why}, so it has no profile; try uncertainty.bootstrap."
        )
    middle: Any = fit.values[parameter]
    k = space.names.index(parameter)
    rise = estimate_profile_curvature(again, parameter, float(space.low[k]), float(space.high[k]))
    low, high = np.ravel(fit.intervals[parameter]).tolist()
    if rise is None:  # the fit is on a bound, where `Fit.intervals` gives no interval
        level = fit.loss * np.sqrt(1 + stdtrit(freedom, 0.975) ** 2 / freedom)
    else:
        level = np.sqrt(fit.loss**2 + rise * ((high - low) / 2) ** 2)
    (low, below), (high, above) = (
        follow_profile(again, parameter, middle, bound, level, points // 2)
        for bound in (float(space.low[k]), float(space.high[k]))
    )
    values, losses = np.array(sorted([*below, (middle, fit.loss), *above])).T
    return Profile(fit, parameter, values, losses, float(level), (low, high))
