"""`VolumeApplication`: what a session shows of a volume, and its answers to the page."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_number, to_whole_number
from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.jit.threads import in_turn
from brdfkit.images.tone_mapping import ToneMapping
from brdfkit.viewing.application import Message
from brdfkit.viewing.controls import State, to_changes
from brdfkit.viewing.session import Session
from brdfkit.viewing.tone_controls import develop, to_tone_mapping
from brdfkit.viewing.volumes import saving, scripts, slices
from brdfkit.viewing.volumes.histograms import make_histograms
from brdfkit.viewing.volumes.live_scene import LiveScene, SceneKind
from brdfkit.viewing.volumes.opening import load_raw, load_upload
from brdfkit.viewing.volumes.painting import paint
from brdfkit.viewing.volumes.pointer import find_visible_voxel
from brdfkit.viewing.volumes.source import Source
from brdfkit.viewing.volumes.state import VolumeState, list_controls, needs_samples_anew
from brdfkit.viewing.volumes.uploads import Upload
from brdfkit.viewing.volumes.volume_controls import PANELS
from brdfkit.volumes import Volume
from brdfkit.volumes.orientation import LETTERS, PLANES, name_ends
from brdfkit.volumes.summary.summary import may_be_labels

SCENES = (
    6  # kept at most, as many as a wipe between two renderers needs at rest and moving, and more
)


class VolumeApplication:
    """A view of a volume.

    `source` is what `brdfkit.volumes.load` read it from, for the scripts that are copied; None for
    a volume that was made in Python. `changes` are settings that differ from the first ones; the
    environment map and the preset among them may be files. Raises `BrdfkitError` if one of them is
    not possible.
    """

    def __init__(
        self,
        volume: Volume,
        source: Source | str | None = None,
        changes: Mapping[str, Any] | None = None,
    ) -> None:
        self.upload = Upload()
        self.show(volume, Source(source) if isinstance(source, str) else source, changes)

    @in_turn
    def show(
        self, volume: Volume, source: Source | None, changes: Mapping[str, Any] | None = None
    ) -> None:
        """Show another volume."""
        given = to_changes(changes)
        self.volume, self.source, self.loaded = volume, source, volume
        self.states = VolumeState(volume)
        self.scenes: dict[SceneKind, LiveScene] = {}
        self.first = self.change(self.states.first(), self._read_files(given))

    def _read_files(self, changes: Mapping[str, Any]) -> State:
        """Return changes with the names of their files, after they were read."""
        readers = {
            "light.environment": self.states.add_environment,
            "transfer.preset": self.states.functions.add,
        }
        read = dict(changes)
        for name in readers.keys() & changes.keys():
            path = Path(str(changes[name]))
            if os.path.isfile(path):  # False, too, for what is no path
                readers[name](path)
                read[name] = path.name
        return read

    @in_turn
    def add_environment(self, path: Path) -> None:
        """Offer the environment map of a file; scenes with an older one of its name are closed."""
        self.states.add_environment(path)
        self.scenes.clear()

    def close(self) -> None:
        """Forget the files of the page, which is gone."""
        self.upload.clear()

    def first_state(self) -> State:
        """Return the state with which a view begins."""
        return self.first

    def describe(self) -> Message:
        """Return the message "open": the panels, the controls, the volume and its histograms."""
        volume, live = self.volume, self.states.live
        counts, joint = make_histograms(volume, (live.low, live.high), live.steepest)
        return {
            "title": volume.name,
            "panels": [
                {"name": name, "label": label, "open": is_open} for name, label, is_open in PANELS
            ],
            "controls": list_controls(self.states.controls),
            "volume": {
                "size": volume.size,
                "spacing": volume.spacing,
                "unit": volume.unit,
                "value_unit": self.states.value_unit,
                "range": [live.low, live.high],
                "steepest": live.steepest,
                "axes": volume.axes,
                "axis_names": self._name_axes(),
            },
            "histogram": counts,
            "presets": self.states.functions.names(),
            "saves": [{"kind": kind, "label": label} for kind, label in saving.KINDS.items()],
        }, [joint]

    def _name_axes(self) -> list[str]:
        """Return the names of the grid's axes, which of a patient say where they start and end."""
        if self.volume.axes != "RAS":
            return list("xyz")
        return ["–".join(ends).capitalize() for ends in name_ends(self.volume)]

    def change(self, state: State, changes: Mapping[str, Any]) -> State:
        """Return the state after changes; raise `BrdfkitError` if one is not possible.

        If the values become labels, or no longer are, what is as at first suits that.
        """
        new = self.states.change(state, changes)
        if new["labels"] == self.volume.labels:
            return new
        kept = scripts.find_changes(self, state)
        self._show_as(new["labels"])
        return self.states.change(self.states.first(), {**kept, **changes})

    @in_turn
    def _show_as(self, labels: bool) -> None:
        """Show the values as labels, or as none."""
        same = labels == self.loaded.labels
        volume = self.loaded if same else replace(self.loaded, labels=labels)
        states = VolumeState(volume)
        states.share_files(self.states)
        self.volume, self.states, self.scenes = volume, states, {}

    def doubts(self) -> list[str]:
        """Return a sentence for what may be wrong with how the volume is shown."""
        told = self.source is not None and "labels" in self.source.settings
        if told or not may_be_labels(self.volume):
            return []
        return [
            f"{self.name} may hold labels, not densities: if so, tick “Values are labels” below "
            "the transfer function."
        ]

    def sides(self, state: State) -> int:
        """Return the number of pictures: 2 if there is a renderer right of the wipe."""
        return 2 if state["second"] else 1

    def needs_samples_anew(self, before: State, after: State) -> bool:
        """Return whether the samples of one state are not those of another."""
        return needs_samples_anew(before, after)

    @in_turn
    def render(
        self, state: State, side: int, size: tuple[int, int], moving: bool, seed: int
    ) -> AnyArray:
        """Render a pass of one sample per pixel: (height, width, 3), linear sRGB."""
        import drjit as dr

        shown = self.states.of_side(state, side)
        kind = self.states.scene_kind(shown, size, moving)
        scene = self.scenes.pop(kind, None) or self._load(kind)
        self.scenes[kind] = scene  # the last one is the newest
        if len(self.scenes) > SCENES:
            self.scenes.pop(next(iter(self.scenes)))
            dr.flush_malloc_cache()  # which keeps the memory of every size of a picture
        scene.show(self.states.look(shown))
        return scene.render(seed)

    def _load(self, kind: SceneKind) -> LiveScene:
        """Load the scene of a kind."""
        return LiveScene(self.states.live, kind, self.states.environments)

    @property
    def name(self) -> str:
        """The name of the volume."""
        return self.volume.name

    @property
    def subject(self) -> str:
        """The volume's name and size."""
        return f"{self.name} of {'×'.join(map(str, self.volume.size))} voxels"

    def tone_mapping(self, state: State) -> ToneMapping:
        """Return the tone mapping of a state."""
        return to_tone_mapping(state)

    def develop(
        self, state: State, pictures: dict[int, AnyArray], moving: bool = False
    ) -> dict[int, AnyArray]:
        """Return the pictures of all sides as sRGB in 8 bits, with one exposure."""
        return develop(state, pictures, moving)

    def overlay(self, state: State, size: tuple[int, int]) -> dict[str, Any]:
        """Return the places of the box's corners, its size, the names of its ends, the renderers.

        `across` is the length across the picture's shorter side at the camera's target.
        """
        corners = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), -1).reshape(-1, 3)
        to_world = self.volume.cube_to_world
        points = corners @ to_world[:3, :3].T + to_world[:3, 3]
        camera = self.states.camera(state)
        edges = np.linalg.norm(to_world[:3, :3], axis=0)
        ends = name_ends(self.volume, LETTERS) if self.volume.axes == "RAS" else ()
        return {
            "corners": np.round(camera.project(points, size[0] / size[1]), 5).tolist(),
            "size": [f"{edge:.4g} {self.volume.unit}".strip() for edge in edges],
            "ends": [letter for pair in ends for letter in pair],
            "across": 2 * camera.distance * float(np.tan(np.radians(camera.fov / 2))),
            "renderers": [state["renderer"], state["second"]],
        }

    def follow(self, before: State, after: State) -> list[Message]:
        """Return what a change of the state shows beside the picture: doubts, and slices."""
        if after["labels"] != self.volume.labels:  # by undo, which changes no setting alone
            self._show_as(after["labels"])
        doubts = [] if before else self.doubts()  # when the page opens
        notes: list[Message] = [({"type": "error", "text": text}, []) for text in doubts]
        return [*notes, *self._draw_slices(before, after)]

    def _draw_slices(self, before: State, after: State) -> list[Message]:
        """Return the slices if they are shown and have changed."""
        if not after["show.slices"]:
            return []
        drawn_by = "show.slices", "slices.low", "slices.high"
        drawn = all(before.get(name) == after[name] for name in drawn_by)
        window, shown = (after["slices.low"], after["slices.high"]), before.get("slices")
        planes, pictures = slices.draw_slices(
            self.volume, after["slices"], window, shown if drawn else None
        )
        return [({"type": "slices", "planes": planes}, pictures)] if planes else []

    def answer(self, session: Session, message: dict[str, Any], data: bytes) -> list[Message]:
        """Answer a message that is about the volume."""
        answers: dict[str, Callable[[Session, dict[str, Any]], list[Message]]] = {
            "probe": self._probe,
            "probe_slice": self._probe_slice,
            "save": self._save,
            "copy": self._copy,
            "raw": partial(load_raw, self),
            "paint": self._paint,
        }
        kind = str(message.get("type"))
        if kind == "upload":
            return load_upload(self, session, message, data)
        if kind not in answers:
            raise BrdfkitError(
                f"The page sent a message {kind!r:.40}, which is unknown; reload it."
            )
        return answers[kind](session, message)

    def _probe(self, session: Session, message: dict[str, Any]) -> list[Message]:
        """Return the value of the first voxel that is visible under the pointer."""
        place = np.clip([to_number(name, message.get(name)) for name in "xy"], 0, 1)
        state, (width, height) = session.state, session.size
        shown = self.states.of_side(state, int(bool(state["second"]) and place[0] > state["wipe"]))
        table, extinction = self.states.find_opacities(shown)
        at = find_visible_voxel(
            self.states.live,
            self.states.camera(state),
            place,
            width / height,
            state["clip"],
            table,
            extinction,
            shown["renderer"] == "maximum_intensity",
        )
        text = "" if at is None else slices.describe_voxel(self.volume, at, self.states.value_unit)
        return [({"type": "probe", "text": text, "voxel": at}, [])]

    def _paint(self, session: Session, message: dict[str, Any]) -> list[Message]:
        """Change the transfer function by a stroke, as one undo step."""
        width, height = session.size
        hide = bool(message.get("hide"))
        changes = paint(self.states, session.state, message.get("stroke"), width / height, hide)
        return session.handle({"type": "set", "changes": changes, "moving": False})

    def _probe_slice(self, session: Session, message: dict[str, Any]) -> list[Message]:
        """Return the value of the voxel under the pointer in a slice."""
        plane = to_whole_number("plane", message.get("plane"), 0, len(PLANES) - 1)
        x, y = (to_number(name, message.get(name)) for name in "xy")
        at = slices.move_crosshair(self.volume, session.state["slices"], plane, x, y)
        text = slices.describe_voxel(self.volume, at, self.states.value_unit)
        return [({"type": "probe", "text": text, "voxel": at}, [])]

    def _save(self, session: Session, message: dict[str, Any]) -> list[Message]:
        """Return a file for the page to keep."""
        return [saving.make_file(self, session, str(message.get("kind")))]

    def _copy(self, session: Session, message: dict[str, Any]) -> list[Message]:
        """Return the view as a script or a command."""
        kind = str(message.get("kind"))
        write = scripts.write_command if kind == "command" else scripts.write_script
        title = "The same picture from a command" if kind == "command" else "The same from Python"
        return [({"type": "text", "title": title, "text": write(self, session)}, [])]
