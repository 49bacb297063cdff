"""`PlotSettings`: the settings that all plots of a page share, from its state."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.colours import luminance
from brdfkit.viewing.controls import State

PREFIX = "plots."  # of all names in the state
CHANNELS = {"R": 0, "G": 1, "B": 2}  # index by the name of the choice


@dataclass(frozen=True)
class PlotSettings:
    """What a plot shows, apart from the materials.

    `theta_i`, `phi_i`: polar angle and azimuth of the incident light [degrees]. `phi_o`: angle
    between the plane of the views and the plane of incidence [degrees]. `phi_d`: azimuth of the
    difference vector in slices [degrees]. `channel`: "luminance", "R", "G", "B", or "each".
    `cosine`: whether values are multiplied by cosθo. `sampler`: whether the densities of the
    renderer's samples are shown. `selection`: ranges (name, low, high), as of `selection.py`.
    """

    theta_i: float = 45.0
    phi_i: float = 0.0
    phi_o: float = 0.0
    phi_d: float = 90.0
    channel: str = "luminance"
    cosine: bool = False
    sampler: bool = False
    selection: tuple[tuple[str, float, float], ...] = ()

    @classmethod
    def from_state(cls, state: State) -> PlotSettings:
        """Return the settings of a state."""
        values = {name: state[PREFIX + name] for name in cls.__dataclass_fields__}
        return cls(**values | {"selection": tuple(map(tuple, values["selection"]))})

    @property
    def weighted(self) -> bool:
        """Whether lobes are multiplied by cosθo: a sampler's density can only be compared so."""
        return self.cosine or self.sampler

    def pick(self, values: FloatArray) -> FloatArray:
        """Return the channel of values (..., channels) that is shown: (..., 1), or (..., 3)."""
        if self.channel == "each":
            return values
        if self.channel in CHANNELS:
            return values[..., [min(CHANNELS[self.channel], values.shape[-1] - 1)]]
        return luminance(values)[..., None]

    def pick_one(self, values: FloatArray) -> FloatArray:
        """Return the channel of values (..., channels) that is shown where one can be: (...)."""
        picked = self.pick(values)
        return luminance(picked) if picked.shape[-1] > 1 else picked[..., 0]


def make_grid_around(centre: float, low: float, high: float) -> FloatArray:
    """Return rising angles from `low` to `high` [degrees], tenfold as dense near `centre`."""
    coarse = np.arange(low, high + 1e-9, 1.0)
    fine = np.arange(max(low, centre - 4), min(high, centre + 4) + 1e-9, 0.1)
    return np.unique(np.concatenate([coarse, fine]).round(6))
