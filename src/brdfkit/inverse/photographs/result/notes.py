"""What one should know of photographs and of the texels asked for, in words."""

import numpy as np

from brdfkit.core.names import listed
from brdfkit.inverse.photographs.capture.observations import shown_colours

COLOURS = "red", "green", "blue"
FINER = 1.25  # texels along a pixel, from which it is said


def describe_capture(capture, clipped, seen):
    """Sentences on a `Capture`, of which the share `clipped` is at its end, and what is `seen`."""
    said = []
    dark = [name for name, lit in zip(COLOURS, shown_colours(seen), strict=True) if not lit]
    if dark:
        said.append(f"Nothing is seen in {listed(dark)}: there the maps say nothing.")
    texel = np.array(capture.size) / seen.shape[::-1]
    finer = float(np.median([(capture.pixel(c) / texel).max() for c in capture.cameras]))
    if finer > FINER:
        said.append(
            f"A pixel is {finer:.2g} texels long: what is finer than pixels is guessed from "
            "neighbours, and the standard errors do not know how well; see resolution."
        )
    if clipped:
        said.append(f"{100 * clipped:.2g} % of the pixels are clipped; they do not count.")
    return tuple(said)
