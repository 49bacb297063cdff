"""A second look at the end of a search, with samples that it has not seen: whether it is worse than
the scene's own values, and where twice the samples move the numbers."""

from dataclasses import dataclass, replace

import numpy as np

from brdfkit.inverse.scenes.result.conclusions import certify
from brdfkit.inverse.scenes.result.residual_noise import Rest
from brdfkit.inverse.scenes.search.gauss_newton import Search, few_samples, step_in_bounds
from brdfkit.inverse.scenes.search.normal_equations import SHARE, SURE, Equations, Residuals

TWICE = 2  # times the samples of the search's end
FAR = 4  # standard errors, farther than which other samples move no number by chance
CARRIED = 0.5  # of the power of a number's derivatives, what two renderings should agree on
SEED = 7_000  # beyond the search's own


@dataclass(frozen=True)
class SecondLook:
    """What twice the samples say of the end of a search.

    step : where they would go from there, in coordinates (n,); 0 for what is not certain.
    moves : by name, how far that moves a number, in standard errors.
    apart : how far E² is from that of the search, in standard deviations.
    few : the numbers whose derivatives few paths carry.
    """

    step: np.ndarray
    moves: dict[str, float]
    apart: float
    few: tuple[str, ...]

    def mean(self, views, x):
        """The coordinates (n,) of both, each by its samples; `x`, those of the search, where they
        differ by more than chance."""
        if max(self.moves.values(), default=0) > FAR:
            return x
        return np.clip(x + TWICE / (1 + TWICE) * self.step, views.least, views.most)

    def notes(self):
        """What one should know: numbers that move, an E² that differs, and derivatives that few
        paths carry; nothing where twice the samples say the same."""
        said = [
            f"{name} moves by {far:.2g} standard errors"
            for name, far in self.moves.items()
            if far > FAR
        ]
        if self.apart > FAR:
            said.append(f"what is left differs by {self.apart:.2g} standard deviations")
        if self.few:
            said.append(f"few paths tell of {', '.join(self.few)}")
        how = "at twice the samples, {}: take more samples, or other starts"
        return (how.format("; ".join(said)),) if said else ()


def look_again(views, found, seed):
    """(`found`, a `Search`, with pictures and equations of twice the samples; its `SecondLook`).

    Where it is worse than the scene's own values: (a `Search` at these, not converged; None).
    """
    spp = 2 * TWICE * found.here.spp
    there = Residuals.at(views, found.here.x, spp, seed + SEED)
    if _is_worse(views, there, seed):
        own = Residuals.at(views, views.start, spp, seed + SEED)
        return Search(own, None, found.steps, found.history, worse=True), None
    about = Equations.at(views, there, seed + SEED, SHARE / TWICE)
    end = replace(found, here=there, about=about)
    return end, _compare(views, found, end)


def _compare(views, found, end):
    """The `SecondLook` of two `Search`es with one end, `found` and of other samples."""
    errors = certify(views, end, Rest.of(views, end.here)).standard_errors()
    certain = np.array([name in errors for name in views.names])
    step = step_in_bounds(views, end, damping=0)
    moved = dict(zip(views.names, np.abs(views.slopes(end.here.x) * step), strict=True))
    # the search's E² is the least of its own samples: what the step gains is no difference
    apart = abs(end.here.error - found.here.error) - max(end.about.gain(step), 0)
    deviation = np.hypot(end.here.deviation, found.here.deviation)
    share = np.diagonal(end.about.hessian) / np.maximum(end.about.power, 1e-300)
    few = [name for name, part in zip(views.names, share, strict=True) if part < CARRIED]
    return SecondLook(
        np.where(certain, step, 0),
        {name: float(moved[name] / max(error, 1e-300)) for name, error in errors.items()},
        float(apart / max(deviation, 1e-300)),
        tuple(name for name in few if name in errors),
    )


def _is_worse(views, there, seed):
    """Whether E² is larger than at the scene's own values, for sure."""
    for spp in (few_samples(views), 2 * there.spp):
        own = Residuals.at(views, views.start, spp, seed + SEED)
        if own.error == np.inf or own.error - SURE * own.deviation > there.bound:
            return False
    return there.bound > own.bound + SURE * own.deviation
