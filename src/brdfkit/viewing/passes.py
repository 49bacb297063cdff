"""`Pass`: a pass of a session's picture when it begins, and the samples that passes add up to."""

from __future__ import annotations

from dataclasses import dataclass

from brdfkit.core.array_types import AnyArray
from brdfkit.images.errors.noise import Accumulated
from brdfkit.viewing.controls import State


@dataclass(frozen=True, eq=False)
class Pass:
    """A pass when it begins: what it shows, and the samples by side to which it adds its own.

    `number` is that of the passes before it. With `anew` no sample is missing, and the picture is
    only developed anew. `opened` is how often the session had opened something.
    """

    state: State
    moving: bool
    size: tuple[int, int]
    number: int
    samples: dict[int, Accumulated]
    anew: bool
    opened: int


def add_passes(
    samples: dict[int, Accumulated], passes: dict[int, AnyArray]
) -> dict[int, Accumulated]:
    """Return the samples of each side with a further pass of each, if there is one."""
    added = {
        side: samples.get(side, Accumulated()).add_pass(picture, 1)
        for side, picture in passes.items()
    }
    return samples | added
