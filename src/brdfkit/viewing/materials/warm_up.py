"""Loads what the first picture of a material needs, while the user still chooses a file."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from brdfkit.core.jit.threads import in_turn
from brdfkit.materials.loading import load
from brdfkit.materials.measured import Measured
from brdfkit.materials.resolve import to_measured
from brdfkit.viewing.application import Message
from brdfkit.viewing.materials.live_bsdf import LiveBsdf
from brdfkit.viewing.materials.live_light import LiveLights

LIGHT, MATERIAL = "studio", "red_plastic"  # the first light, and a small material
FEW = 60  # samples


def warm_up() -> Iterator[list[Message]]:
    """Import and load what all materials share, as a task of a session; yields no messages."""
    for load_part in (_load_table, _load_samples, _load_light):
        load_part()
        yield []


@in_turn
def _load_table() -> None:
    """Load a table as Mitsuba's material; what this imports stays, as in the other parts."""
    LiveBsdf(load(MATERIAL))


@in_turn
def _load_samples() -> None:
    """Interpolate a few samples."""
    samples = to_measured(MATERIAL).samples
    few = np.flatnonzero(samples.valid)[:: len(samples.wi) // FEW]
    wi, wo = samples.wi[few], samples.wo[few]
    Measured.from_samples(wi, wo, samples.values[few]).eval(wi, wo)


@in_turn
def _load_light() -> None:
    """Load the first light."""
    LiveLights().get(LIGHT)
