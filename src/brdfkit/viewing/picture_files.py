"""The picture of a view's state, from a script, and as a file that the page keeps."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.memory import require_memory
from brdfkit.core.progress_bar import Progress
from brdfkit.images.errors.noise import Accumulated
from brdfkit.rendering.progressive import derive_seed
from brdfkit.rendering.result import Rendering
from brdfkit.viewing.application import Application, Message
from brdfkit.viewing.controls import State
from brdfkit.viewing.difference_map import draw_differences, shows_differences
from brdfkit.viewing.encoding import encode_png
from brdfkit.viewing.passes import add_passes, mix_pictures
from brdfkit.viewing.temporary_folders import make_folder

if TYPE_CHECKING:
    from brdfkit.viewing.session import Session

T = TypeVar("T")
KINDS = {
    "png": "Picture (PNG)",
    "exr": "Picture (EXR, linear)",
    "state": "Settings (JSON)",
}


def join_sides(pictures: dict[int, AnyArray], state: State) -> AnyArray:
    """Return the left picture left of the wipe, and the right one right of it; or both in a row."""
    if 1 not in pictures:
        return pictures[0]
    if state.get("compare", "wipe") != "wipe":
        return np.concatenate([pictures[0], pictures[1]], axis=1)
    width = pictures[0].shape[1]
    edge = round(state["wipe"] * width)
    return np.concatenate([pictures[0][:, :edge], pictures[1][:, edge:]], axis=1)


def join_samples(samples: dict[int, Accumulated], state: State) -> AnyArray:
    """Return the picture of a state from the samples of its sides, linear."""
    pictures = {side: total.picture for side, total in samples.items() if total.passes}
    return join_sides(pictures, state)


def render_state(
    application: Application,
    state: State,
    size: tuple[int, int],
    spp: int,
    seed: int = 0,
    progress: Progress | None = None,
) -> Rendering:
    """Return the picture of a state, of `spp` passes, the same as the page's for the seed 0.

    Raises `BrdfkitError` for a `size` [pixels] that the memory has no room for.
    """
    require_memory(size, application.sides(state))
    start = time.monotonic()
    sums: dict[int, Accumulated] = {}
    for done in render_passes(application, state, size, spp, seed, sums):
        if progress:
            progress(done, spp)
    joined = join_samples(sums, state)
    tone = application.tone_mapping(state)
    seconds = time.monotonic() - start
    return Rendering({application.name: joined}, spp, seconds, seed, tone_mapping=tone, bare=True)


def render_passes(
    application: Application,
    state: State,
    size: tuple[int, int],
    spp: int,
    seed: int,
    sums: dict[int, Accumulated],
) -> Iterator[int]:
    """Add `spp` passes of a state to the samples by side, `sums`; yield their number after each."""
    for number in range(spp):
        sides = range(application.sides(state))
        pictures = {
            side: application.render(state, side, size, False, derive_seed(seed, number))
            for side in sides
        }
        sums |= add_passes(sums, pictures)
        yield number + 1


def make_picture_file(application: Application, session: Session, kind: str) -> Message:
    """Return the message "file" with the picture so far, or with the settings, of `KINDS`."""
    makers = {"png": _make_png, "exr": _make_exr, "state": _make_state}
    suffix, mime, content = makers[kind](application, session)
    return {"type": "file", "name": f"{application.name}{suffix}", "mime": mime}, [content]


def _make_png(application: Application, session: Session) -> tuple[str, str, bytes]:
    """Make the picture as it is shown."""
    pictures = _require_picture(mix_pictures(session.accumulated, session.previews))
    colours = application.develop(session.state, pictures, False)
    if shows_differences(session.state, colours):
        return ".png", "image/png", encode_png(draw_differences(colours[0], colours[1])[0])
    return ".png", "image/png", encode_png(join_sides(colours, session.state))


def _make_exr(application: Application, session: Session) -> tuple[str, str, bytes]:
    _require_picture(session.accumulated)
    samples = join_samples(session.accumulated, session.state)
    picture = Rendering({application.name: samples}, session.passes, 0.0)
    with make_folder() as folder:
        path = Path(folder) / "picture.exr"
        picture.write(path)
        return ".exr", "image/x-exr", path.read_bytes()


def _require_picture(pictures: dict[int, T]) -> dict[int, T]:
    """Return pictures, or samples, by side; raise `BrdfkitError` if there are none."""
    if not pictures:
        raise BrdfkitError("There is no picture yet; wait for the first one.")
    return pictures


def _make_state(application: Application, session: Session) -> tuple[str, str, bytes]:
    text = json.dumps(session.state, indent=1)
    return ".view.json", "application/json", text.encode()
