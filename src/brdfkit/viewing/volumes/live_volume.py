"""`LiveVolume`: a volume as the scenes of a view look it up, its values as shares of their range.

All scenes of all views of a volume share one grid of Mitsuba. Its values go from 0 to 1, so that
tables of `VALUE_ROWS` even steps suit every volume. The labels of a volume of labels become even
steps, because labels that are thousands apart would otherwise share rows of the table.
"""

from __future__ import annotations

from functools import cached_property
from typing import Any
from weakref import WeakValueDictionary

import numpy as np
from numpy.typing import ArrayLike

from brdfkit.core.array_types import FloatArray
from brdfkit.core.jit.llvm import use_variant
from brdfkit.volumes import TransferFunction, Volume
from brdfkit.volumes.transfer.lookup import MIN_STEPS
from brdfkit.volumes.transfer.windows import find_upper_percentile

VALUE_ROWS = MIN_STEPS + 1  # rows of a table over values
GRADIENT_ROWS = 64  # rows of a table over gradient magnitudes
STEEPEST_PERCENTILE = 99.9  # of the gradient magnitudes, up to which tables go


class LiveVolume:
    """A volume, its range of values, and the grids that all scenes of it share.

    `labels` are the labels that occur, rising, or None. `low` and `high` are the ends of the range
    of values, which differ even if there is only one value. `steepest` is the gradient magnitude
    at the upper end of tables over gradient magnitudes.
    """

    def __init__(self, volume: Volume) -> None:
        self.volume = volume
        self.labels = np.unique(volume.values) if volume.labels else None
        self.low, high = volume.range
        self.high = high if high > self.low else self.low + max(1.0, 1e-6 * abs(self.low))
        gradients = volume.gradient_magnitude
        steepest = find_upper_percentile(gradients, STEEPEST_PERCENTILE)
        self.steepest = steepest or float(gradients.max()) or 1.0
        self.grids: dict[int, Any] = {}  # those of Mitsuba, by their number of channels

    def to_shares(self, values: ArrayLike) -> FloatArray:
        """Convert values of the volume to the values of the grid, 0 to 1 over the range."""
        values = np.asarray(values, float)
        if self.labels is None:
            return np.clip((values - self.low) / (self.high - self.low), 0, 1)
        steps = max(len(self.labels) - 1, 1)
        return np.interp(values, self.labels, np.arange(len(self.labels)) / steps)

    @cached_property
    def row_values(self) -> FloatArray:
        """The volume's value at each row of a table (VALUE_ROWS,); the nearest label of labels."""
        if self.labels is None:
            return np.linspace(self.low, self.high, VALUE_ROWS)
        nearest = np.rint(np.linspace(0, len(self.labels) - 1, VALUE_ROWS))
        return self.labels[nearest.astype(int)].astype(float)

    @cached_property
    def row_gradients(self) -> FloatArray:
        """The gradient magnitude at each row of a table over gradient magnitudes."""
        return np.linspace(0, self.steepest, GRADIENT_ROWS)

    def describe(self, by_gradients: bool, colour: str) -> dict[str, Any]:
        """Return the dictionary of a `transfer_function` over the volume, for any table.

        Its own table is only a placeholder of the right size.
        """
        import mitsuba as mi

        function = make_placeholder(colour, self.row_gradients if by_gradients else None)
        return {
            "type": "transfer_function",
            "values": self._get_grid(2 if by_gradients else 1),
            "transfer": function.to_json(),
            "to_world": mi.ScalarTransform4f(self.volume.cube_to_world.tolist()),
        }

    def _get_grid(self, channels: int) -> Any:
        """Return Mitsuba's grid of the shares, and of gradient magnitudes if `channels` is 2."""
        import mitsuba as mi

        use_variant()
        if channels not in self.grids:
            voxels = np.empty((*self.volume.values.shape, channels), np.float32)
            for slab, values in zip(voxels, self.volume.values, strict=True):
                slab[..., 0] = self.to_shares(values)
            if channels == 2:
                voxels[..., 1] = self.volume.gradient_magnitude
            described = {
                "type": "gridvolume",
                "grid": mi.VolumeGrid(voxels),  # "data" takes no two channels
                "raw": True,
                "filter_type": "nearest" if self.volume.labels else "trilinear",
                "to_world": mi.ScalarTransform4f(self.volume.cube_to_world.tolist()),
            }
            self.grids[channels] = mi.load_dict(described)
        return self.grids[channels]


# Without the volumes that no view shows any more
_shared: WeakValueDictionary[int, LiveVolume] = WeakValueDictionary()


def get_live_volume(volume: Volume) -> LiveVolume:
    """Return the `LiveVolume` of a volume, the same one for all pages that show it."""
    live = _shared.get(id(volume))
    if live is None:
        live = _shared[id(volume)] = LiveVolume(volume)
    return live


def make_placeholder(colour: str, gradients: FloatArray | None) -> TransferFunction:
    """Return a function over shares with a table of `VALUE_ROWS` rows.

    It has a narrow peak, so that emission and absorption average the function along rays, as any
    function needs that the user may draw later.
    """
    if gradients is not None:
        return TransferFunction([0, 1], np.ones((len(gradients), 2, 4)), 1.0, colour, gradients)
    step = 1 / (VALUE_ROWS - 1)
    rgba = np.zeros((5, 4))
    rgba[2] = 1.0
    return TransferFunction([0, 0.5 - step, 0.5, 0.5 + step, 1], rgba, 1.0, colour)
