"""Inverts the curve by which a camera or a program codes 8-bit photographs, where there is one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from brdfkit.core.arguments import is_number, wrong_value_error
from brdfkit.core.array_types import FloatArray

LINEAR, SRGB, GAMMA = "linear", "srgb", "gamma"
USUAL_GAMMA = 2.2
ADVICE = (
    "give --linearise linear if its numbers are in proportion to light, or --linearise sRGB if it "
    "comes from a camera's JPEG or was made for screens"
)


@dataclass(frozen=True)
class Coding:
    """The curve of coded photographs: that of sRGB, or a power of the linear values.

    `exponent` γ: linear values are the coded ones to the power of γ; None for the curve of sRGB.
    """

    exponent: float | None = 1.0

    def decode(self, coded: FloatArray) -> FloatArray:
        """Return linear values in the range 0 to 1 for coded values in that range."""
        if self.exponent is None:  # IEC 61966-2-1
            upper = ((np.maximum(coded, 0.04045) + 0.055) / 1.055) ** 2.4
            return np.where(coded <= 0.04045, coded / 12.92, upper).astype(coded.dtype)
        return coded if self.exponent == 1 else coded**self.exponent


def to_coding(linearise: str | float | None) -> Coding | None:
    """Return the `Coding` of 8-bit photographs that a user names; None where the user names none.

    `linearise` is "linear", "sRGB", "gamma" (2.2), or the exponent γ as a number or its digits, at
    least 1. Raises `BrdfkitError` for anything else.
    """
    if linearise is None:
        return None
    word = linearise.strip().lower() if isinstance(linearise, str) else linearise
    named = {LINEAR: Coding(1.0), SRGB: Coding(None), GAMMA: Coding(USUAL_GAMMA)}
    if isinstance(word, str) and word in named:
        return named[word]
    try:
        exponent = float(word)
    except (TypeError, ValueError):
        exponent = 0.0
    if not isinstance(word, bool) and is_number(exponent) and 1 <= exponent <= 5:
        return Coding(exponent)
    raise wrong_value_error(
        "linearise", linearise, "linear, sRGB, gamma, or the exponent of a gamma between 1 and 5"
    )
