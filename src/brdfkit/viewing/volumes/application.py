"""`VolumeApplication`: what a session shows of a volume, and its answers to the page."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from brdfkit.core.array_types import AnyArray
from brdfkit.core.jit.threads import in_turn
from brdfkit.images.tone_mapping import ToneMapping
from brdfkit.viewing.application import Message
from brdfkit.viewing.controls import State, has_other_samples, to_changes
from brdfkit.viewing.recent import Recent
from brdfkit.viewing.session import Session
from brdfkit.viewing.tone_controls import develop, to_tone_mapping
from brdfkit.viewing.volumes import scripts
from brdfkit.viewing.volumes.answers import answer, show_slices
from brdfkit.viewing.volumes.beside import open_beside
from brdfkit.viewing.volumes.description import describe_box, describe_volume
from brdfkit.viewing.volumes.live_scene import LiveScene, SceneKind
from brdfkit.viewing.volumes.source import Source
from brdfkit.viewing.volumes.state import DRAWN_ONLY, VolumeState
from brdfkit.viewing.volumes.volume_controls import LABELS
from brdfkit.volumes import Volume
from brdfkit.volumes.summary.summary import may_be_labels

# Kept at most: as many as a wipe between two renderers needs at rest and moving, and more
LARGEST_SCENE_COUNT = 6


class VolumeApplication:
    """A view of a volume.

    `source` is what `brdfkit.volumes.load` read it from, for the scripts that are copied; None for
    a volume that was made in Python. `changes` are settings that differ from the first ones; the
    environment map and the preset among them may be files. Raises `BrdfkitError` if one of them is
    not possible.
    """

    @in_turn
    def __init__(
        self,
        volume: Volume,
        source: Source | str | None = None,
        changes: Mapping[str, Any] | None = None,
    ) -> None:
        self.source = Source(source) if isinstance(source, str) else source
        self.given = volume, self.source, changes
        given = to_changes(changes)
        self.volume, self.loaded = volume, volume
        self.states = VolumeState(volume)
        self.scenes = _make_scenes()
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
        """Forget the scenes, because the page is gone or shows something else."""
        self.scenes.clear()

    def open_beside(self, session: Session, kind: str, path: Path) -> list[Message]:
        """Open a dropped file beside the volume."""
        return open_beside(self, session, kind, path)

    def first_state(self) -> State:
        """Return the state with which a view begins."""
        return self.first

    def describe(self) -> Message:
        """Return the message "open": the panels, the controls, the volume and its histograms."""
        return describe_volume(self)

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
        self.volume, self.states, self.scenes = volume, states, _make_scenes()

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

    def describe_side(self, state: State, side: int) -> dict[str, Any]:
        """Return the renderer of a side, which the page waits for."""
        name = "second" if side else "renderer"
        return {"name": LABELS[state[name]], "needs": {name: state[name]}}

    def needs_samples_anew(self, before: State, after: State) -> bool:
        """Return whether the samples of one state are not those of another."""
        return has_other_samples(before, after, DRAWN_ONLY)

    def wants_preview(
        self, state: State, sizes: tuple[tuple[int, int], tuple[int, int]], passes: int
    ) -> bool:
        """Return False: pictures of volumes that move have noise, too."""
        return False

    @in_turn
    def render(
        self, state: State, side: int, size: tuple[int, int], moving: bool, seed: int
    ) -> AnyArray:
        """Render a pass of one sample per pixel: (height, width, 3), linear sRGB."""
        shown = self.states.of_side(state, side)
        kind = self.states.scene_kind(shown, size, moving)
        scene = self.scenes.get(kind, lambda: self._load(kind))
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

    def again(self) -> VolumeApplication:
        """Return another view of the volume with which this one began, as for another page."""
        return VolumeApplication(*self.given)

    def has_plot(self, state: State, moving: bool) -> bool:
        """Return False: a volume has no plots."""
        return False

    def draw_plots(self, state: State, moving: bool) -> list[Message]:
        """Return no plots."""
        return []

    def tone_mapping(self, state: State) -> ToneMapping:
        """Return the tone mapping of a state."""
        return to_tone_mapping(state)

    def develop(
        self, state: State, pictures: dict[int, AnyArray], moving: bool = False
    ) -> dict[int, AnyArray]:
        """Return the pictures of all sides as sRGB in 8 bits, with one exposure."""
        return develop(state, pictures, moving)

    def find_mask(self, state: State, size: tuple[int, int]) -> AnyArray | None:
        """Return None: all of a picture is compared."""
        return None

    def find_unmeasured(self, state: State, size: tuple[int, int]) -> AnyArray | None:
        """Return None: volumes are not hatched."""
        return None

    def overlay(self, state: State, size: tuple[int, int]) -> dict[str, Any]:
        """Return what the page draws over the picture."""
        return describe_box(self.volume, self.states.camera(state), size[0] / size[1])

    def follow(self, before: State, after: State) -> list[Message]:
        """Return what a change of the state shows beside the picture: doubts, and slices."""
        if after["labels"] != self.volume.labels:  # by undo, which changes no setting alone
            self._show_as(after["labels"])
        doubts = [] if before else self.doubts()  # when the page opens
        notes: list[Message] = [({"type": "error", "text": text}, []) for text in doubts]
        return [*notes, *show_slices(self.volume, before, after)]

    def answer(self, session: Session, message: dict[str, Any], data: bytes) -> list[Message]:
        """Answer a message that is about the volume."""
        return answer(self, session, message)


def _make_scenes() -> Recent[SceneKind, LiveScene]:
    """Return an empty store of scenes, which gives the memory of dropped ones back."""
    import drjit as dr

    # Dr.Jit keeps the memory of every size of a picture
    return Recent(LARGEST_SCENE_COUNT, dr.flush_malloc_cache)
