"""`Pass`: a pass of a session's picture when it begins, and the samples that passes add up to."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

from brdfkit.core.array_types import AnyArray
from brdfkit.images.errors.noise import Accumulated
from brdfkit.viewing.application import Application
from brdfkit.viewing.controls import State

CALM = 0.03  # noise that nobody minds: the mean standard error of the pixels over their mean


class Kind(Enum):
    """What a pass is: a picture while something moves, the same samples developed anew, a picture
    without noise at rest, or a further sample at rest.
    """

    MOVE, DEVELOP, PREVIEW, SAMPLE = range(4)


@dataclass(frozen=True, eq=False)
class Pass:
    """A pass when it begins: what it shows, and the samples by side to which it adds its own.

    `number` is that of the samples before it. `previews` are the pictures without noise by side, if
    there are any. `opened` is how often the session had opened something.
    """

    application: Application
    kind: Kind
    state: State
    size: tuple[int, int]
    number: int
    samples: dict[int, Accumulated]
    previews: dict[int, AnyArray]
    opened: int

    @property
    def moving(self) -> bool:
        """Whether it shows the state while something moves."""
        return self.kind == Kind.MOVE

    def add(self, rendered: dict[int, AnyArray]) -> Pass:
        """Return the pass with what it has rendered for each side."""
        if self.kind == Kind.PREVIEW:
            return replace(self, samples=dict(self.samples), previews=rendered)
        added = {} if self.moving else add_passes(self.samples, rendered)
        return replace(self, samples=added)


def add_passes(
    samples: dict[int, Accumulated], passes: dict[int, AnyArray]
) -> dict[int, Accumulated]:
    """Return the samples of each side with a further pass of each, if there is one."""
    added = {
        side: samples.get(side, Accumulated()).add_pass(picture, 1)
        for side, picture in passes.items()
    }
    return samples | added


def mix_pictures(
    samples: dict[int, Accumulated], previews: dict[int, AnyArray]
) -> dict[int, AnyArray]:
    """Return the pictures by side, linear: those without noise, until the samples have little.

    The share of the samples is as large as it can be with noise below `CALM`, and the same for all
    sides, so that they can be compared. So the picture changes slowly to the true one.
    """
    pictures = {side: total.picture for side, total in samples.items() if total.passes}
    if not previews:
        return pictures
    noises = [total.noise for total in samples.values()]
    if not noises or None in noises:
        return previews
    share = min(1.0, CALM / max(noise for noise in [*noises, CALM] if noise is not None))
    return {side: share * own + (1 - share) * previews[side] for side, own in pictures.items()}
