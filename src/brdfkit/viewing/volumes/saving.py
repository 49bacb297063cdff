"""Files of a view, such as its picture, its settings and an orbit."""

from __future__ import annotations

import io
import json
import tempfile
import zipfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.progress_bar import Progress
from brdfkit.images.errors.noise import Accumulated
from brdfkit.rendering.film import write_animation
from brdfkit.rendering.progressive import derive_seed
from brdfkit.rendering.result import Rendering
from brdfkit.viewing.controls import State
from brdfkit.viewing.encoding import encode_png, to_bytes
from brdfkit.viewing.volumes import transfer_table
from brdfkit.volumes import TransferFunction

if TYPE_CHECKING:
    from brdfkit.viewing.application import Message
    from brdfkit.viewing.session import Session

    Application = Any  # `VolumeApplication`, which imports this file

KINDS = {
    "png": "Picture (PNG)",
    "exr": "Picture (EXR, linear)",
    "state": "Settings (JSON)",
    "transfer": "Transfer function (JSON)",
    "film": "Orbit (GIF)",
    "frames": "Orbit (PNG frames)",
}
FRAMES, FILM_SAMPLES = 36, 8  # of an orbit


def join_sides(pictures: dict[int, AnyArray], wipe: float) -> AnyArray:
    """Return the left picture left of the wipe, and the right one right of it."""
    if 1 not in pictures:
        return pictures[0]
    width = pictures[0].shape[1]
    edge = round(wipe * width)
    return np.concatenate([pictures[0][:, :edge], pictures[1][:, edge:]], axis=1)


def render_state(
    application: Application,
    state: State,
    size: tuple[int, int],
    spp: int,
    seed: int = 0,
    progress: Progress | None = None,
) -> Rendering:
    """Return the picture of a state, of `spp` passes, the same as the page's for the seed 0."""
    import time

    start = time.monotonic()
    sums = {side: Accumulated() for side in range(application.sides(state))}
    for number in range(spp):
        for side in sums:
            picture = application.render(state, side, size, False, derive_seed(seed, number))
            sums[side] = sums[side].add_pass(picture, 1)
        if progress:
            progress(number + 1, spp)
    joined = join_sides({side: total.picture for side, total in sums.items()}, state["wipe"])
    tone = application.states.tone_mapping(state)
    name = application.volume.name
    seconds = time.monotonic() - start
    return Rendering({name: joined}, spp, seconds, seed, tone_mapping=tone, bare=True)


def make_file(application: Application, session: Session, kind: str) -> Message:
    """Return the message "file" of a kind of `KINDS`; a film follows when it is finished."""
    if kind in ("film", "frames"):
        if session.tasks:
            raise BrdfkitError("An orbit is being rendered already; wait for its file.")
        session.tasks.append(_make_orbit(application, session.state, session.size, kind))
        return {"type": "busy", "text": "The orbit is rendered", "fraction": 0.0}, []
    makers = {
        "png": _make_png,
        "exr": _make_exr,
        "state": _make_state,
        "transfer": _make_transfer,
    }
    if kind not in makers:
        raise BrdfkitError(f"A view is saved as {', '.join(KINDS)}, and not as {kind!r:.20}.")
    suffix, mime, content = makers[kind](application, session)
    name = f"{application.volume.name}{suffix}"
    return {"type": "file", "name": name, "mime": mime}, [content]


def _current_picture(session: Session) -> AnyArray:
    """Return the picture of a session so far, linear."""
    done = {side: a.picture for side, a in session.accumulated.items() if a.passes}
    if not done:
        raise BrdfkitError("There is no picture yet; wait for the first one.")
    return join_sides(done, session.state["wipe"])


def _make_png(application: Application, session: Session) -> tuple[str, str, bytes]:
    colours = application.develop(session.state, {0: _current_picture(session)})
    return ".png", "image/png", encode_png(colours[0])


def _make_exr(application: Application, session: Session) -> tuple[str, str, bytes]:
    picture = Rendering({application.volume.name: _current_picture(session)}, session.passes, 0.0)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "picture.exr"
        picture.write(path)
        return ".exr", "image/x-exr", path.read_bytes()


def _make_state(application: Application, session: Session) -> tuple[str, str, bytes]:
    text = json.dumps(session.state, indent=1)
    return ".view.json", "application/json", text.encode()


def _make_transfer(application: Application, session: Session) -> tuple[str, str, bytes]:
    return (
        ".transfer.json",
        "application/json",
        to_function(application, session.state).to_json().encode(),
    )


def to_function(application: Application, state: State) -> TransferFunction:
    """Return the transfer function of a state."""
    states, extinction = application.states, state["transfer.extinction"] * state["density"]
    name, unit, colour = (
        state["transfer.preset"],
        application.volume.unit,
        state["transfer.colour"],
    )
    if state["transfer.mode"] == "preset":
        return replace(states.load_preset(name), extinction=extinction)
    if state["transfer.mode"] == "points":
        points = state["transfer.points"]
        rgba = np.array([[*transfer_table.parse_colour(c), a] for _, c, a in points])
        values, gradients = np.array([value for value, _, _ in points]), None
    else:
        step = 16  # of the rows over values, which are far finer than any bump
        values, rows = np.unique(states.live.row_values[::step], return_index=True)
        rgba = states.table(state)[..., ::step, :][..., rows, :]
        gradients = states.live.row_gradients if rgba.ndim == 3 else None
    return TransferFunction(
        values, rgba, extinction, colour, gradients, application.states.value_unit, unit, name
    )


def _make_orbit(
    application: Application, state: State, size: tuple[int, int], kind: str
) -> Iterator[list[Message]]:
    """Render a turn, frame by frame, from the view of a state on.

    Yields messages of the progress, and at last the file: one animation, or an archive of frames.
    """
    name, tone = application.volume.name, application.states.tone_mapping(state)
    images: list[Any] = []
    brightest = 0.0  # of the first frame, which all frames are exposed by
    for number in range(FRAMES):
        azimuth = state["camera.azimuth"] + 360 * number / FRAMES
        frame = render_state(
            application, state | {"camera.azimuth": azimuth}, size, FILM_SAMPLES
        ).pictures[name]
        brightest = brightest or tone.brightest_of(frame)
        images.append(Image.fromarray(to_bytes(tone(frame, brightest))))
        text = f"The orbit is rendered: {number + 1} of {FRAMES} frames"
        yield [({"type": "busy", "text": text, "fraction": (number + 1) / FRAMES}, [])]
    write, suffix, mime = ORBITS[kind]
    stream = io.BytesIO()
    write(stream, images)
    file = {"type": "file", "name": f"{name}.orbit{suffix}", "mime": mime}
    yield [({"type": "busy", "text": "", "fraction": None}, []), (file, [stream.getvalue()])]


def _write_frames(stream: io.BytesIO, images: list[Any]) -> None:
    """Write images as an archive of PNGs."""
    with zipfile.ZipFile(stream, "w") as archive:
        for number, image in enumerate(images):
            archive.writestr(f"{number:03d}.png", encode_png(np.asarray(image)))


def _write_gif(stream: io.BytesIO, images: list[Any]) -> None:
    """Write images as an animation."""
    write_animation(stream, "GIF", images, len(images))


ORBITS = {
    "film": (_write_gif, ".gif", "image/gif"),
    "frames": (_write_frames, ".zip", "application/zip"),
}
