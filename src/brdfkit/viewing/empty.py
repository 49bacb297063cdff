"""`EmptyApplication`: a page that shows nothing yet, and offers what brdfkit knows by name."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from brdfkit.core import catalogue
from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import no_such_error
from brdfkit.images.tone_mapping import ToneMapping
from brdfkit.viewing.application import Message, no_use_error, unknown_message_error
from brdfkit.viewing.controls import State
from brdfkit.volumes import made

MODELS = "ggx", "ward", "lambert"  # that begin a view of a model alone
FILES = (
    ("Measured material", "MERL .binary, RGL .bsdf, ASTM .astm, .csv and more; a saved fit .json"),
    ("Volume", "NIfTI, NRRD, DICOM, VTI, MetaImage, TIFF, .vol, raw voxels; a folder of slices"),
    ("Light or shape", "an environment map .hdr or .exr, a mesh .obj or .ply"),
)


def list_names() -> list[str]:
    """Return the names of what the empty page offers."""
    return [*catalogue.list_materials(), *MODELS, *made.list_volume_names()]


class EmptyApplication:
    """A view of nothing: the page says what can be dropped, and lists names to choose."""

    name, subject = "An empty page", "nothing"

    def again(self) -> EmptyApplication:
        """Return another empty view, as for another page."""
        return EmptyApplication()

    def describe(self) -> Message:
        """Return the message "open": what can be dropped, and the names with their titles."""
        materials = [(name, shipped.title) for name, shipped in catalogue.list_materials().items()]
        lists = {
            "Measured materials": materials,
            "Models": [(name, name) for name in MODELS],
            "Volumes": [(name, name) for name in made.list_volume_names()],
        }
        start = {"files": FILES, "lists": list(lists.items())}
        common = {"title": "", "parts": [], "panels": [], "controls": [], "saves": []}
        return common | {"start": start}, []

    def first_state(self) -> State:
        """Return the state, which has no settings."""
        return {}

    def change(self, state: State, changes: Mapping[str, Any]) -> State:
        """Return the state; raise `BrdfkitError` for any change."""
        for name in changes:
            raise no_such_error("setting", str(name)[:80], [])
        return state

    def sides(self, state: State) -> int:
        """Return 0, because there is no picture."""
        return 0

    def describe_side(self, state: State, side: int) -> dict[str, Any]:
        """Raise an error, because there is no picture."""
        raise NotImplementedError

    def needs_samples_anew(self, before: State, after: State) -> bool:
        """Return False, because there is no picture."""
        return False

    def wants_preview(
        self, state: State, sizes: tuple[tuple[int, int], tuple[int, int]], passes: int
    ) -> bool:
        """Return False, because there is no picture."""
        return False

    def find_mask(self, state: State, size: tuple[int, int]) -> AnyArray | None:
        """Return None, because there is no picture."""
        return None

    def find_unmeasured(self, state: State, size: tuple[int, int]) -> AnyArray | None:
        """Return None, because there is no picture."""
        return None

    def render(
        self, state: State, side: int, size: tuple[int, int], moving: bool, seed: int
    ) -> AnyArray:
        """Raise an error, because there is no picture."""
        raise NotImplementedError

    def has_plot(self, state: State, moving: bool) -> bool:
        """Return False, because there are no plots."""
        return False

    def draw_plots(self, state: State, moving: bool) -> list[Message]:
        """Return no plots."""
        return []

    def tone_mapping(self, state: State) -> ToneMapping:
        """Return the usual tone mapping."""
        return ToneMapping()

    def develop(
        self, state: State, pictures: dict[int, AnyArray], moving: bool
    ) -> dict[int, AnyArray]:
        """Return no pictures."""
        return {}

    def overlay(self, state: State, size: tuple[int, int]) -> dict[str, Any]:
        """Return nothing to draw."""
        return {}

    def follow(self, before: State, after: State) -> list[Message]:
        """Return nothing to show."""
        return []

    def answer(self, session: Any, message: dict[str, Any], data: bytes) -> list[Message]:
        """Ignore the pointer; refuse any other message."""
        kind = str(message.get("type"))
        if kind == "probe":
            return []
        raise unknown_message_error(kind)

    def open_beside(self, session: Any, kind: str, path: Path) -> list[Message]:
        """Refuse a file that needs something beside which it is opened."""
        raise no_use_error(path.name, "a transfer function shows a volume")

    def close(self) -> None:
        """Do nothing, because nothing was loaded."""
