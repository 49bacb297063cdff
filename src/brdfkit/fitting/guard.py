"""Guards a fit beyond the measured angles, by a completed table of the material.

A fit to a part of the hemisphere may run away where nothing was measured. So its albedo is compared
with that of the table that `complete` makes. If the fit reflects much more light than the table, or
more than arrives, the model is fitted to the table's cells instead, each weighted by how certain it
is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.colours import to_srgb
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.geometry.directions import to_half_difference
from brdfkit.images.ball import LIGHTS, Pixels, draw_pixels
from brdfkit.materials.completion import complete
from brdfkit.materials.completion.prior_cells import compute_cosine, to_logarithm
from brdfkit.materials.extrapolation import (
    LARGEST_FIT_SHARE,
    compute_share_beyond,
    describe_reach,
)
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.selection import select_samples
from brdfkit.model.samples import Samples
from brdfkit.regression.albedo import make_albedo_pixels

# Angles of incidence [degrees] at which the albedos of a fit and of the table are compared
ANGLES = tuple(float(angle) for angle in range(0, 86, 5))
# A fit leaves the table if one of its albedos is larger by more than this factor
LARGEST_FACTOR = 1.9
# A fit to the table is taken only if its pictures are nearer to the table's by so much [dB]
LEAST_GAIN = 1.0
# Largest angle [degrees] of the directions in these pictures, their number per pixel, and the seed
PICTURE_ANGLE, DIRECTIONS, SEED = 85.0, 16, 1
LEAST_ALBEDO = 1e-3  # smaller albedos count as equal

Brdf: TypeAlias = Callable[[Any, Any], Any]

_completed: WeakKeyDictionary[Measured, Measured | None] = WeakKeyDictionary()


@dataclass(frozen=True, eq=False)
class Guard:
    """The completed table of a material, by which fits to it are guarded.

    `completed`: the table. `max_angle`: the largest angle of the fit [degrees]. `reach`: the
    measured angles in words.
    """

    completed: Measured
    max_angle: float
    reach: str

    @classmethod
    def for_fit(cls, data: Measured, max_angle: float) -> Guard | None:
        """Return the guard of fits to `data` below `max_angle` [degrees], or None for none.

        There is none if the measurement covers the hemisphere, cannot be completed, or has another
        unit than 1/sr.
        """
        if compute_share_beyond(data, max_angle) <= LARGEST_FIT_SHARE:
            return None
        completed = complete_once(data)
        if completed is None or "dimmed" in completed.info:
            return None
        return cls(completed, max_angle, describe_reach(data))

    @cached_property
    def samples(self) -> Samples:
        """A quarter of the cells below `max_angle`, weighted by how certain they are."""
        cells = select_samples(self.completed, self.max_angle, errors=True)
        # Half of the table mirrors the other half, and every second cell of a half suffices
        _, _, phi_d = to_half_difference(cells.wi, cells.wo)
        return cells.at(np.flatnonzero(np.mod(phi_d, np.pi) < np.pi / 2)[::2])

    def find_excess(self, brdf: Brdf) -> tuple[float, float, float] | None:
        """Return where a BRDF reflects much more light than the table, or None if nowhere.

        The result is an angle of incidence [degrees], and the albedos of the BRDF and of the table
        at that angle, as means over the channels.
        """
        own, known = _compute_albedos(brdf), self._albedos
        row = int(np.argmax(own / known))
        if own[row] <= LARGEST_FACTOR * known[row]:
            return None
        return ANGLES[row], float(own[row]), float(known[row])

    def compute_largest_albedos(self, brdf: Brdf) -> FloatArray:
        """Return the largest albedo (channels,) of a BRDF up to 85°."""
        largest: FloatArray = make_albedo_pixels(ANGLES).evaluate(brdf).max(axis=0)
        return largest

    @cached_property
    def _albedos(self) -> FloatArray:
        """The albedos of the table at `ANGLES`."""
        return _compute_albedos(self.completed.eval)

    def is_nearer(self, brdf: Brdf, other: Brdf) -> bool:
        """Return whether pictures of a BRDF are clearly nearer to the table's than another's."""
        errors = [self._compute_picture_error(f) for f in (brdf, other)]
        return errors[0] < errors[1] * 10 ** (-LEAST_GAIN / 20)

    def _compute_picture_error(self, brdf: Brdf) -> float:
        """Return the RMS difference of a BRDF's pictures from the table's, in sRGB values."""
        apart = to_srgb(np.nan_to_num(self._pixels.evaluate(brdf))) - to_srgb(self._pixels.values)
        return float(np.sqrt(np.average((apart**2).mean(axis=1), weights=self._pixels.weights)))

    @cached_property
    def _pixels(self) -> Pixels:
        """Pixels of a ball with the table, under all lights."""
        brdf = self.completed.eval
        return draw_pixels(tuple(LIGHTS), brdf, PICTURE_ANGLE, SEED, directions=DIRECTIONS)

    def describe_table(self) -> str:
        """Return what the table was completed by, in words."""
        return f"a table completed by the prior of {self.completed.info['prior'].split(' (')[0]}"


def _compute_albedos(brdf: Brdf) -> FloatArray:
    """Return the albedos of a BRDF at `ANGLES`, as means over the channels."""
    return np.maximum(make_albedo_pixels(ANGLES).evaluate(brdf).mean(axis=1), LEAST_ALBEDO)


def compute_logarithm(values: FloatArray, wi: FloatArray, wo: FloatArray) -> FloatArray:
    """Return ln(f c + e) of BRDF `values` (n, channels) at pairs of directions (n, 3)."""
    return to_logarithm(values.T, compute_cosine(wi, wo)).T


def complete_once(data: Measured) -> Measured | None:
    """Return the completed table of a material in linear sRGB, or None if it has none."""
    if data not in _completed:
        try:
            _completed[data] = complete(data.rgb)
        except BrdfkitError:  # it is anisotropic, has too few values, or another unit
            _completed[data] = None
    return _completed[data]
