"""Files of a view, such as its picture, its settings and an orbit."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from copy import copy
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image

from brdfkit.core.errors import BrdfkitError
from brdfkit.images.errors.noise import Accumulated
from brdfkit.rendering.film import write_animation
from brdfkit.viewing import picture_files
from brdfkit.viewing.controls import State
from brdfkit.viewing.encoding import encode_png, to_bytes
from brdfkit.viewing.volumes import transfer_table
from brdfkit.viewing.volumes.live_volume import VALUE_ROWS
from brdfkit.volumes import TransferFunction

if TYPE_CHECKING:
    from brdfkit.viewing.application import Message
    from brdfkit.viewing.session import Session

    Application = Any  # `VolumeApplication`, which imports this file

KINDS = {
    **picture_files.KINDS,
    "transfer": "Transfer function (JSON)",
    "film": "Orbit (GIF)",
    "frames": "Orbit (PNG frames)",
}
FRAMES, FILM_SAMPLES = 36, 8  # of an orbit


def make_file(application: Application, session: Session, kind: str) -> Message:
    """Return the message "file" of a kind of `KINDS`; a film follows when it is finished."""
    if kind in ("film", "frames"):
        if session.tasks:
            raise BrdfkitError("An orbit is being rendered already; wait for its file.")
        shown = copy(application)  # which keeps what it shows when the page opens another file
        session.tasks.append(_make_orbit(shown, session.state, session.size, kind))
        return _describe_orbit(0, 0), []
    if kind == "transfer":
        text = to_function(application, session.state).to_json()
        file = {"type": "file", "name": f"{application.name}.transfer.json"}
        return file | {"mime": "application/json"}, [text.encode()]
    if kind not in KINDS:
        raise BrdfkitError(f"A view is saved as {', '.join(KINDS)}, and not as {kind!r:.20}.")
    return picture_files.make_picture_file(application, session, kind)


def to_function(application: Application, state: State) -> TransferFunction:
    """Return the transfer function of a state."""
    states, extinction = application.states, state["transfer.extinction"] * state["density"]
    name, unit, colour = (
        state["transfer.preset"],
        application.volume.unit,
        state["transfer.colour"],
    )
    if state["transfer.mode"] == "preset":
        return replace(states.functions.load(name, state["renderer"]), extinction=extinction)
    if state["transfer.mode"] == "points":
        points = state["transfer.points"]
        rgba = np.array([[*transfer_table.parse_colour(c), a] for _, c, a in points])
        values, gradients = np.array([value for value, _, _ in points]), None
    else:
        # A row for each sixteenth of the narrowest bump is enough
        narrowest = min(bump["sx"] for bump in state["transfer.bumps"])
        step = max(1, min(16, int(VALUE_ROWS * narrowest / 16)))
        values, rows = np.unique(states.live.row_values[::step], return_index=True)
        rgba = states.functions.table(state)[..., ::step, :][..., rows, :]
        gradients = states.live.row_gradients if rgba.ndim == 3 else None
    return TransferFunction(
        values, rgba, extinction, colour, gradients, application.states.value_unit, unit, name
    )


def _make_orbit(
    application: Application, state: State, size: tuple[int, int], kind: str
) -> Iterator[list[Message]]:
    """Render a turn, frame by frame, from the view of a state on.

    Yields messages of the progress after each pass, and at last the file: one animation, or an
    archive of frames.
    """
    name, tone = application.name, application.tone_mapping(state)
    images: list[Any] = []
    brightest = 0.0  # of the first frame, which all frames are exposed by
    for number in range(FRAMES):
        azimuth = state["camera.azimuth"] + 360 * number / FRAMES
        turned, samples = state | {"camera.azimuth": azimuth}, dict[int, Accumulated]()
        for done in picture_files.render_passes(
            application, turned, size, FILM_SAMPLES, 0, samples
        ):
            yield [(_describe_orbit(number, done), [])]
        frame = picture_files.join_samples(samples, state)
        brightest = brightest or tone.brightest_of(frame)
        images.append(Image.fromarray(to_bytes(tone(frame, brightest))))
    write, suffix, mime = ORBITS[kind]
    stream = io.BytesIO()
    write(stream, images)
    file = {"type": "file", "name": f"{name}.orbit{suffix}", "mime": mime}
    yield [({"type": "busy", "text": "", "fraction": None}, []), (file, [stream.getvalue()])]


def _describe_orbit(number: int, passes: int) -> dict[str, Any]:
    """Return the message "busy" after some passes of the frame of a `number`, from 0."""
    text = f"Rendering the orbit: frame {number + 1} of {FRAMES}"
    fraction = (number + passes / FILM_SAMPLES) / FRAMES
    return {"type": "busy", "text": text, "fraction": fraction, "can_cancel": True}


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
