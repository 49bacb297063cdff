"""`PictureMasks`: where a picture shows the shape, and where it shows what was not measured."""

from __future__ import annotations

from typing import Any

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.measured_angles import MeasuredAngles
from brdfkit.viewing.controls import State
from brdfkit.viewing.materials.live_light import LAMP
from brdfkit.viewing.materials.live_material import LiveMaterial
from brdfkit.viewing.materials.material_state import MaterialState, make_look
from brdfkit.viewing.recent import Recent

KEPT = 2  # views whose directions are kept: at rest and while something moves


class PictureMasks:
    """Finds pixels of a view's pictures; `live` are the materials that it renders."""

    def __init__(self, states: MaterialState, live: Recent[str, LiveMaterial]) -> None:
        self.states, self.live = states, live
        # In each pixel, to the camera and to the lamp
        self.directions: Recent[Any, tuple[AnyArray, AnyArray]] = Recent(KEPT)
        self.angles: tuple[Measured, MeasuredAngles] | None = None

    def find_shape(self, state: State, size: tuple[int, int]) -> AnyArray:
        """Return where a picture shows the shape (height, width)."""
        return np.isfinite(self.find_directions(state, size)[0][..., 2])

    def find_unmeasured(self, state: State, size: tuple[int, int]) -> AnyArray | None:
        """Return where a picture shows what was not measured (height, width), for `hatch`.

        That is a view, and with the lamp a pair of directions, without samples near it. A completed
        material has 1 where they were inferred, and 2 where they are guesses. None where the
        material was not measured at all, and where the page was closed during the pass.
        """
        measured = self.states.measured
        if not isinstance(measured, Measured) or not self.live.kept:
            return None
        if self.angles is None or self.angles[0] is not measured:
            self.angles = measured, MeasuredAngles(measured)
        view, light = self.find_directions(state, size)
        mask, angles = view[..., 2] > 0, self.angles[1]
        kinds = np.zeros(mask.shape, np.uint8)
        if state["light.environment"] == LAMP:
            mask &= light[..., 2] > 0
            kinds[mask] = angles.find_kinds(light[mask], view[mask])
        else:
            kinds[mask] = angles.find_view_kinds(view[mask][..., 2])
        return kinds if angles.is_completed else kinds > 0

    def find_directions(self, state: State, size: tuple[int, int]) -> tuple[AnyArray, AnyArray]:
        """Return the directions to the camera and to the lamp in each pixel."""
        kind, look = self.states.make_kind(state, size, moving=False), make_look(state)
        live = next(iter(self.live.kept.values()))
        return self.directions.get(
            (kind.shape, size, look), lambda: live.find_directions(kind, look)
        )
