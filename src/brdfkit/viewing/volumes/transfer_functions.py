"""`TransferFunctions`: the transfer functions of a view, and the table of the one that it shows.

The transfer function of a view is the part of its state whose names begin with "transfer.".
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import no_such_error
from brdfkit.rendering.volumes import defaults
from brdfkit.viewing.controls import State
from brdfkit.viewing.volumes import transfer_table
from brdfkit.viewing.volumes.live_volume import LiveVolume
from brdfkit.volumes import TransferFunction
from brdfkit.volumes.transfer.files import list_presets
from brdfkit.volumes.transfer.windows import scale_transfer_to_values

# Presets that are chosen for the volume, as for a renderer
CHOSEN = {"emission": "emission_absorption", "intensity": "maximum_intensity"}


class TransferFunctions:
    """The transfer functions of a view of one volume: presets, and `files` from the page, by name.

    The preset "default" suits the volume and the renderer.
    """

    def __init__(self, live: LiveVolume) -> None:
        self.live, self.volume = live, live.volume
        self.files: dict[str, TransferFunction] = {}
        self.presets: dict[str, TransferFunction] = {}
        # Functions by the renderer that they suit, and the parts of the state that they are
        self.defaults: dict[str, TransferFunction] = {}
        self.default_parts: dict[str, State] = {}
        self.last_table: tuple[State, AnyArray] = {}, np.zeros(0)

    def names(self) -> list[str]:
        """Return the names of the functions that the page offers."""
        return ["default", *CHOSEN, *list_presets(), *self.files]

    def load(self, name: str, renderer: str = "single_scattering") -> TransferFunction:
        """Return the function of a name, scaled to the volume; "default" suits the `renderer`."""
        if name == "default":
            return self._choose(renderer)
        if name in CHOSEN:
            return self._choose(CHOSEN[name])
        if name in self.files:
            return self.files[name]
        if name not in self.presets:
            if name not in list_presets():
                raise no_such_error("transfer function", name, self.names())
            self.presets[name] = self._scale(TransferFunction.load(name))
        return self.presets[name]

    def add(self, path: Path) -> None:
        """Offer the transfer function of a file as a preset with the file's name."""
        function = replace(TransferFunction.load(path), name=path.name)
        self.files[path.name] = self._scale(function)
        self.last_table = {}, np.zeros(0)  # of an older function of this name

    def _choose(self, renderer: str) -> TransferFunction:
        """Return the transfer function that suits the volume and a renderer."""
        renderer = "single_scattering" if renderer == "isosurface" else renderer
        if renderer not in self.defaults:
            function = defaults.choose_transfer_function(self.volume, renderer)
            self.defaults[renderer] = self._scale(function)
        return self.defaults[renderer]

    def _scale(self, function: TransferFunction) -> TransferFunction:
        """Return a function in the volume's values and its unit of length."""
        function = scale_transfer_to_values(function, self.volume.values)
        if self.volume.unit and function.length_unit:
            function = function.per(self.volume.unit)
        return function

    # The part of the state

    def describe(self, function: TransferFunction) -> State:
        """Return the part of the state that a transfer function is."""
        exact = function.gradients is not None or self.volume.labels
        return {
            "transfer.mode": "preset" if exact else "points",
            "transfer.points": transfer_table.to_points(function, self.live.low, self.live.high),
            "transfer.extinction": function.extinction,
            "transfer.colour": function.colour,
        }

    def default_part(self, renderer: str) -> State:
        """Return the part of the state that the default function of a renderer is."""
        if renderer not in self.default_parts:
            self.default_parts[renderer] = self.describe(self._choose(renderer))
        return self.default_parts[renderer]

    def is_default(self, state: State) -> bool:
        """Return whether a state has the default function of its renderer, as it is."""
        if state["transfer.preset"] != "default":
            return False
        part = self.default_part(state["renderer"])
        return all(state[name] == value for name, value in part.items())

    def table(self, state: State) -> AnyArray:
        """Return RGBA of a state's transfer function, (n, 4) or over gradients (m, n, 4).

        Equal functions give the same array, since it is made anew only after a change.
        """
        names = (name for name in state if name == "renderer" or name.startswith("transfer."))
        function = {name: state[name] for name in names}
        last = self.last_table  # another thread may exchange it meanwhile
        if last[0] != function:
            last = self.last_table = function, self._make_table(state)
        return last[1]

    def _make_table(self, state: State) -> AnyArray:
        """Return RGBA of a state's transfer function at the rows of a table."""
        if state["transfer.mode"] == "preset":
            function = self.load(state["transfer.preset"], state["renderer"])
            return transfer_table.table_of_function(function, self.live)
        return transfer_table.to_table(state, self.live)
