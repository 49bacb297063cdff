"""The controls of the tone mapping of a view, and the tone mapping of its state."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from brdfkit.core.array_types import AnyArray
from brdfkit.images.tone_mapping import CURVES, ToneMapping
from brdfkit.viewing.controls import Control, State
from brdfkit.viewing.encoding import to_bytes, to_bytes_quickly
from brdfkit.viewing.picture_files import join_sides

STOPS = "Each stop doubles the light of both sides, before the curve."


def make_tone_controls() -> list[Control]:
    """Return the controls of the tone mapping."""
    control = partial(Control, panel="tone")
    window: dict[str, Any] = {"tone.curve": ("range",)}
    curves = tuple((name, name) for name in CURVES)
    means = (("channel", "each channel"), ("luminance", "luminance"))
    return [
        control("tone.curve", "Curve", default="range", kind="choice", choices=curves),
        control("tone.stops", "Exposure", default=0.0, low=-6, high=6, unit="stops", help=STOPS),
        control("tone.low", "Black at", default=0.0, low=0, high=10, when=window),
        control("tone.high", "White at", default=1.0, low=0.01, high=20, when=window),
        control("tone.by", "Applied to", default="channel", kind="choice", choices=means),
    ]


def to_tone_mapping(state: Mapping[str, Any]) -> ToneMapping:
    """Return the tone mapping of a state."""
    high = max(state["tone.high"], state["tone.low"] + 1e-3)
    return ToneMapping(
        state["tone.curve"], 2.0 ** state["tone.stops"], state["tone.by"], state["tone.low"], high
    )


def develop(state: State, pictures: dict[int, AnyArray], moving: bool) -> dict[int, AnyArray]:
    """Return the pictures of all sides as sRGB in 8 bits, with the exposure of both together.

    With `moving`, bytes may be one level off, so that it takes less time.
    """
    tone = to_tone_mapping(state)
    brightest = tone.brightest_of(join_sides(pictures, state))
    convert = to_bytes_quickly if moving else to_bytes
    return {side: convert(tone(picture, brightest)) for side, picture in pictures.items()}
