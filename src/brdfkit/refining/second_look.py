"""A second look at the end of a search, with samples that it has not seen: whether it is worse than
the scene's own values, and where twice the samples move the numbers."""

from dataclasses import dataclass, replace

import numpy as np

from brdfkit.refining.equations import SHARE, SURE, Equations, Residuals
from brdfkit.refining.gauss_newton import Search, few_samples, step_in_bounds

TWICE = 2  # times the samples of the search's end
FAR = 4  # standard errors, farther than which other samples move no number by chance
CARRIED = 0.5  # of the power of a number's derivatives, what two renderings should agree on
SEED = 7_000  # beyond the search's own


@dataclass(frozen=True)
class SecondLook:
    """What twice the samples say of the end of a search: the `step` that they would take from there,
    {name: in the values}; how far E² is `apart`, in standard deviations; of the power of the
    derivatives, {name: the `share`} that two renderings agree on."""

    step: dict[str, float]
    apart: float
    share: dict[str, float]

    def moves(self, certainty):
        """{name: how far it would move, in standard errors of a `Certainty`}."""
        errors = certainty.standard_errors().items()
        return {name: abs(self.step[name]) / max(error, 1e-300) for name, error in errors}

    def mean(self, views, x, certainty):
        """The coordinates (n,) of both, each by its samples; `x`, those of the search, for what is
        not certain, and where both differ by more than chance."""
        moves = self.moves(certainty)
        if max(moves.values(), default=0) > FAR:
            return x
        step = np.array([self.step[name] if name in moves else 0 for name in views.names])
        moved = x + TWICE / (1 + TWICE) * step / views.slopes(x)
        return np.clip(moved, views.least, views.most)

    def notes(self, certainty):
        """What one should know: numbers that move, an E² that differs, and derivatives that few
        paths carry."""
        moves = self.moves(certainty)
        said = [f"{name} moves by {far:.2g} standard errors" for name, far in moves.items() if far > FAR]
        if self.apart > FAR:
            said.append(f"what is left differs by {self.apart:.2g} standard deviations")
        few = [name for name in moves if self.share[name] < CARRIED]
        if few:
            said.append(f"few paths tell of {', '.join(few)}")
        how = "at twice the samples, {}: take more samples, or other starts"
        return (how.format("; ".join(said)),) if said else ()


def look_again(views, found, again, seed):
    """(`found` or, where it is worse than the scene's own values, the `Search` of `again()`, which
    begins there, if it is not None, with pictures and equations of twice the samples; its
    `SecondLook`). Where that is worse, too, the scene's own values, not converged, and None."""
    spp = 2 * TWICE * found.here.spp
    for search in filter(None, (lambda: found, again)):
        found = search()
        there = Residuals.at(views, found.here.x, spp, seed + SEED)
        if not _is_worse(views, there, seed):
            return _compare(views, found, there, seed)
    own = Residuals.at(views, views.start, spp, seed + SEED)
    return Search(own, None, found.steps, found.history, worse=True), None


def _compare(views, found, there, seed):
    """(the `Search` with the `Residuals` of other samples at its end; its `SecondLook`)."""
    about = Equations.at(views, there, seed + SEED, SHARE / TWICE)
    end = replace(found, here=there, about=about)
    step = views.slopes(there.x) * step_in_bounds(views, end, damping=0)
    deviation = np.hypot(there.deviation, found.here.deviation)
    apart = abs(there.error - found.here.error) / max(deviation, 1e-300)
    share = np.diagonal(about.hessian) / np.maximum(about.power, 1e-300)
    by_name = (dict(zip(views.names, row.tolist(), strict=True)) for row in (step, share))
    return end, SecondLook(next(by_name), float(apart), next(by_name))


def _is_worse(views, there, seed):
    """Whether E² is larger than at the scene's own values, for sure."""
    for spp in (few_samples(views), 2 * there.spp):
        own = Residuals.at(views, views.start, spp, seed + SEED)
        if own.error == np.inf or own.error - SURE * own.deviation > there.bound:
            return False
    return there.bound > own.bound + SURE * own.deviation
