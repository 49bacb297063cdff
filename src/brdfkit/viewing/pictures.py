"""Makes the messages of a session: its pictures, their noise in words, and its errors."""

from __future__ import annotations

import logging
from typing import Any

from brdfkit.core.array_types import AnyArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.images.errors.noise import Accumulated
from brdfkit.images.hatching import hatch
from brdfkit.viewing.application import Application, Message
from brdfkit.viewing.controls import State
from brdfkit.viewing.difference_map import draw_differences, shows_differences
from brdfkit.viewing.encoding import encode_jpeg, encode_png


def make_pictures(
    application: Application,
    state: State,
    colours: dict[int, AnyArray],
    common: dict[str, Any],
    lossless: bool,
) -> list[Message]:
    """Return a message "picture" for each side, with what all of them have in `common`.

    `colours` are the pictures by side, sRGB in 8 bits. The map of their differences follows, where
    the state shows it.
    """
    encode, mime = (encode_png, "image/png") if lossless else (encode_jpeg, "image/jpeg")
    messages: list[Message] = []
    height, width = colours[0].shape[:2]
    hatched = application.find_unmeasured(state, (width, height))

    def add(described: dict[str, Any], picture: AnyArray) -> None:
        shown = picture if hatched is None else hatch(picture, hatched)
        messages.append((described | {"mime": mime}, [encode(shown)]))

    for side, picture in sorted(colours.items()):
        shown = application.describe_side(state, side)
        add({"type": "picture", "side": side} | shown | common, picture)
    if shows_differences(state, colours):
        mask = application.find_mask(state, (width, height))
        drawn, described = draw_differences(colours[0], colours[1], mask)
        add({"type": "difference", "number": common["number"]} | described, drawn)
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
