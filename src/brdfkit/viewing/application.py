"""`Application`: what a session needs of a volume, or of materials, to show them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol, TypeAlias

from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.images.tone_mapping import ToneMapping
from brdfkit.viewing.controls import State

Message: TypeAlias = tuple[dict[str, Any], list[bytes]]  # JSON, and the bytes beside it


class Application(Protocol):
    """What a session shows: a volume, or materials."""

    @property
    def name(self) -> str:
        """The name of what is shown, for files."""

    @property
    def subject(self) -> str:
        """What is shown, in words that tell it from all else: no other takes its settings."""

    def again(self) -> Application:
        """Return another view of the same, as for another page."""

    def describe(self) -> Message:
        """Return the message "open", with the panels, the controls and the data."""

    def first_state(self) -> State:
        """Return the state with which a view begins."""

    def change(self, state: State, changes: Mapping[str, Any]) -> State:
        """Return the state after changes; raise `BrdfkitError` if one is not possible."""

    def sides(self, state: State) -> int:
        """Return the number of pictures beside each other: 1 or 2, or 0 without any."""

    def describe_side(self, state: State, side: int) -> dict[str, Any]:
        """Return the "name" of what a side shows, and what it "needs".

        Those are the settings with other values of which the picture is another one, for which the
        page waits.
        """

    def needs_samples_anew(self, before: State, after: State) -> bool:
        """Return whether the samples of one state are not those of another."""

    def wants_preview(
        self, state: State, sizes: tuple[tuple[int, int], tuple[int, int]], passes: int
    ) -> bool:
        """Return whether a picture without noise is to be made at rest, after some passes.

        It is then shown until the passes have little noise. `sizes` are those of pictures at rest
        and while something moves.
        """

    def render(
        self, state: State, side: int, size: tuple[int, int], moving: bool, seed: int
    ) -> AnyArray:
        """Render a pass: (height, width, 3), linear sRGB."""

    def has_plot(self, state: State, moving: bool) -> bool:
        """Return whether a plot beside the picture shows another state."""

    def draw_plots(self, state: State, moving: bool) -> list[Message]:
        """Return the next plots that show another state; only quick ones while something moves."""

    def tone_mapping(self, state: State) -> ToneMapping:
        """Return the tone mapping of a state."""

    def develop(
        self, state: State, pictures: dict[int, AnyArray], moving: bool
    ) -> dict[int, AnyArray]:
        """Return the pictures of all sides as sRGB in 8 bits, with one exposure."""

    def find_mask(self, state: State, size: tuple[int, int]) -> AnyArray | None:
        """Return where a picture shows what is compared (height, width); None for everywhere."""

    def find_unmeasured(self, state: State, size: tuple[int, int]) -> AnyArray | None:
        """Return where a picture is to be hatched (height, width), if anywhere."""

    def overlay(self, state: State, size: tuple[int, int]) -> dict[str, Any]:
        """Return what the page draws over the picture."""

    def follow(self, before: State, after: State) -> list[Message]:
        """Return what a change of the state shows beside the picture, such as slices."""

    def answer(self, session: Any, message: dict[str, Any], data: bytes) -> list[Message]:
        """Answer a message about the application; `session` is the `Session` that received it."""

    def open_beside(self, session: Any, kind: str, path: Path) -> list[Message]:
        """Open a dropped file beside what is shown, such as a light; `kinds.py` has its `kind`.

        Raises `BrdfkitError` for a kind of which the application makes nothing.
        """

    def close(self) -> None:
        """Forget what was loaded, because the page is gone or shows something else."""


def unknown_message_error(kind: str) -> BrdfkitError:
    """Return the error for a message of the page that no application knows."""
    return BrdfkitError(f"The page sent a message {kind!r:.40}, which is unknown; reload it.")


def no_use_error(name: str, what: str) -> BrdfkitError:
    """Return the error for a dropped file that means nothing to what is shown.

    >>> print(no_use_error("a.ply", "a mesh shows a material"))
    a.ply: a mesh shows a material; open one, and drop the file again.
    """
    return BrdfkitError(f"{name}: {what}; open one, and drop the file again.")
