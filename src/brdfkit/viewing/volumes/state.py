"""The state of a view of a volume: its first values, its checks, and what a scene shows of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.arguments import is_number
from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError, no_such_error
from brdfkit.lighting.environments.map_files import load_radiance
from brdfkit.rendering.volumes import defaults
from brdfkit.rendering.volumes.camera import (
    camera_direction,
    find_front,
    place_camera,
    to_direction,
)
from brdfkit.rendering.volumes.scene import TURN_AZIMUTHS
from brdfkit.viewing.camera import Camera
from brdfkit.viewing.controls import Control, State, default_state
from brdfkit.viewing.volumes import transfer_table
from brdfkit.viewing.volumes.live_scene import Look, SceneKind, choose_steps
from brdfkit.viewing.volumes.live_volume import get_live_volume
from brdfkit.viewing.volumes.transfer_functions import TransferFunctions
from brdfkit.viewing.volumes.transfer_table import parse_colour
from brdfkit.viewing.volumes.volume_controls import make_controls
from brdfkit.volumes import Volume
from brdfkit.volumes.volume import LARGEST_COORDINATE

FIRST_BUMP = {"x": 0.5, "y": 0.25, "sx": 0.15, "sy": 0.25, "colour": "#e8a060", "a": 0.5}
CLIP = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0]]
THINNEST = 1e-3  # edge of the clipping box, as a share of the volume's
OPAQUE = 1e30  # extinction [1/unit of length] within an isosurface
MOVING_STEPS = 0.4  # share of the steps along rays while something moves
# Names whose change does not alter the samples of a picture
DRAWN_ONLY = (
    "wipe",
    "tone.",
    "show.box",
    "show.axes",
    "show.slices",
    "slices",
    "view.moving_scale",
)


class VolumeState:
    """Makes and checks the states of a view of one volume.

    `live` is the volume as scenes look it up.
    """

    def __init__(self, volume: Volume) -> None:
        self.volume, self.live = volume, get_live_volume(volume)
        self.level = defaults.choose_surface_level(volume)
        self.front = find_front(volume)
        self.functions = TransferFunctions(self.live)
        function = self.functions.load("default")
        sides = [camera_direction(volume, azimuth, 20.0) for azimuth in TURN_AZIMUTHS]
        is_visible = defaults.make_visibility_test(function, 0.0)
        origin, target = place_camera(volume, is_visible, sides, 1.0)
        self.home = tuple(float(x) for x in target)
        distance = float(np.linalg.norm(origin - target))
        # "HU" for a scan that has them; empty if unknown
        self.value_unit = "HU" if function.value_unit == "HU" else ""
        controls = make_controls(volume, self.level, distance, self.value_unit)
        self.controls = {control.name: control for control in controls}
        self.environments: dict[str, AnyArray] = {}  # maps from the page, by name

    def first(self) -> State:
        """Return the state with which a view begins: the default transfer function, home."""
        return default_state(self.controls.values()) | {
            "camera.target": list(self.home),
            "clip": CLIP,
            "slices": [n // 2 for n in self.volume.size],
            "transfer.preset": "default",
            "transfer.bumps": [dict(FIRST_BUMP)],
            **self.functions.default_part("single_scattering"),
        }

    def share_files(self, other: VolumeState) -> None:
        """Offer the environment maps and functions from the page that `other` offers."""
        self.environments, self.functions.files = other.environments, other.functions.files
        self.controls["light.environment"] = other.controls["light.environment"]

    def add_environment(self, path: Path) -> None:
        """Offer a further environment map, read from a file."""
        _, rgb = load_radiance(path)
        self.environments[path.name] = rgb
        control = self.controls["light.environment"]
        choices = dict.fromkeys([*control.choices, (path.name, path.name)])
        self.controls[control.name] = replace(control, choices=tuple(choices))

    def change(self, state: State, changes: Mapping[str, Any]) -> State:
        """Return the state after `changes`; raise `BrdfkitError` if one is not possible."""
        new = dict(state)
        for name, value in changes.items():
            if name not in state:
                raise no_such_error("setting", name, state)
            control = self.controls.get(name)
            new[name] = control.check(value) if control else self._check(name, value)
        if "transfer.preset" in changes and "transfer.points" not in changes:
            function = self.functions.load(new["transfer.preset"], new["renderer"])
            filled = self.functions.describe(function)
            new |= {name: value for name, value in filled.items() if name not in changes}
        elif "renderer" in changes and not any(name.startswith("transfer.") for name in changes):
            if self.functions.is_default(state):
                new |= self.functions.default_part(new["renderer"])
        elif "transfer.points" in changes and state["transfer.mode"] == "preset":
            new |= {"transfer.mode": "points"} if "transfer.mode" not in changes else {}
        return new

    def _check(self, name: str, value: Any) -> Any:
        """Return the value of a name that no control declares; raise an error if it is wrong."""
        fine = {
            "camera.target": lambda: _is_numbers(value, 3),
            "clip": lambda: len(value) == 2 and all(_is_numbers(corner, 3) for corner in value),
            "slices": lambda: _is_numbers(value, 3),
            "transfer.preset": lambda: value in self.functions.names(),
            "transfer.points": lambda: transfer_table.is_points(value),
            "transfer.bumps": lambda: transfer_table.is_bumps(value),
            "transfer.extinction": lambda: is_number(value) and 0 < value < 1e30,
        }[name]
        try:
            if not fine():
                raise BrdfkitError(f"{name} = {str(value)[:60]} is not possible; undo the change.")
        except TypeError:
            raise BrdfkitError(f"{name} = {str(value)[:60]} is not possible; undo it.") from None
        if name == "clip":
            low, high = np.clip(np.array(value, float), 0, 1)
            high = np.maximum(high, np.minimum(low + THINNEST, 1))
            return [np.minimum(low, high - THINNEST).tolist(), high.tolist()]
        if name == "slices":
            last = np.array(self.volume.size) - 1
            return np.clip(np.rint(value), 0, last).astype(int).tolist()
        return value

    # What a scene shows

    def camera(self, state: State) -> Camera:
        """Return the camera of a state."""
        return Camera(
            state["camera.azimuth"],
            state["camera.elevation"],
            state["camera.distance"],
            state["camera.fov"],
            tuple(state["camera.target"]),
            self.front,
        )

    def of_side(self, state: State, side: int) -> State:
        """Return the state of the picture left (0) or right (1) of the wipe.

        A default transfer function is that of the side's renderer.
        """
        renderer = state["second" if side else "renderer"]
        suits = renderer == state["renderer"] or not self.functions.is_default(state)
        function = {} if suits else self.functions.default_part(renderer)
        return state | function | {"renderer": renderer}

    def scene_kind(self, state: State, size: tuple[int, int], moving: bool) -> SceneKind:
        """Return what of the state of a side needs kernels of its own."""
        renderer = state["renderer"]
        kind = SceneKind(renderer, size, choose_steps(self.volume, MOVING_STEPS if moving else 1.0))
        if renderer != "isosurface":
            by_gradients = self.functions.table(state).ndim == 3
            kind = replace(kind, by_gradients=by_gradients, colour=state["transfer.colour"])
        if renderer == "single_scattering":
            kind = replace(kind, phase=state["phase"], max_depth=int(state["depth"]) + 1, steps=0)
        if renderer in ("single_scattering", "isosurface"):
            shown = state["show.environment"]
            kind = replace(kind, sun=state["light.sun"], shows_environment=shown)
        return kind

    def look(self, state: State) -> Look:
        """Return the parameters of the scene of a side's state."""
        sun = state["light.sun_strength"] * parse_colour(state["light.sun_colour"])
        return Look(
            camera=self.camera(state),
            table=self.functions.table(state),
            extinction=state["transfer.extinction"] * state["density"],
            level=state["level"],
            surface=parse_colour(state["surface.colour"]),
            asymmetry=state["asymmetry"],
            clip=np.array(state["clip"], float),
            background=parse_colour(state["background"]),
            environment=state["light.environment"],
            turn=state["light.turn"],
            brightness=state["light.brightness"],
            sun=sun,
            sun_direction=to_direction(state["light.sun_azimuth"], state["light.sun_elevation"]),
        )

    def find_opacities(self, state: State) -> tuple[AnyArray, float]:
        """Return what hides light in the state of a side: a table of RGBA, and the extinction."""
        if state["renderer"] == "isosurface":
            inside = self.live.row_values > state["level"]
            return np.repeat(inside.astype(float)[:, None], 4, axis=1), OPAQUE
        return self.functions.table(state), state["transfer.extinction"] * state["density"]


def list_controls(controls: Mapping[str, Control]) -> list[dict[str, Any]]:
    """Return the controls as the page reads them."""
    return [control.to_json() for control in controls.values()]


def _is_numbers(value: Any, count: int) -> bool:
    """Return whether a value is a list of as many finite numbers."""
    return len(value) == count and all(is_number(x) and abs(x) < LARGEST_COORDINATE for x in value)
