"""Makes the messages of a session: its pictures, their noise in words, and its errors."""

from __future__ import annotations

import logging
from typing import Any

from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.images.errors.noise import Accumulated
from brdfkit.viewing.application import Application, Message
from brdfkit.viewing.controls import State
from brdfkit.viewing.encoding import encode_jpeg, encode_png


def make_pictures(
    application: Application,
    state: State,
    pictures: dict[int, AnyArray],
    common: dict[str, Any],
    moving: bool,
    lossless: bool,
) -> list[Message]:
    """Return a message "picture" for each side, with what all of them have in `common`."""
    messages: list[Message] = []
    for side, colours in sorted(application.develop(state, pictures, moving).items()):
        mime = "image/png" if lossless else "image/jpeg"
        picture = {"type": "picture", "side": side, "mime": mime}
        content = encode_png(colours) if lossless else encode_jpeg(colours)
        messages.append((picture | common, [content]))
    return messages


def describe_noise(accumulated: Accumulated | None) -> str:
    """Return the noise of samples, in words."""
    noise = None if accumulated is None else accumulated.noise
    return "" if noise is None else f"{100 * noise:.2g} % noise"


def describe_error(error: Exception) -> Message:
    """Return the message "error"; an error that is none of brdfkit's sentences is logged, too."""
    text = str(error)
    if not isinstance(error, BrdfkitError):
        logging.getLogger(__name__).error("brdfkit view failed", exc_info=error)
        text = f"brdfkit failed ({type(error).__name__}: {error}); please report it."
    return {"type": "error", "text": text}, []
