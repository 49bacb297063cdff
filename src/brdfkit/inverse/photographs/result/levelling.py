"""Writes sentences on what the photographs do not show, and on normals that are not level."""

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.names import join_words
from brdfkit.inverse.photographs.capture.capture import Capture
from brdfkit.inverse.photographs.capture.observations import Observations

COLOURS = "red", "green", "blue"
LONG_PIXEL = 1.25  # length of a pixel [texels] above which the result's notes mention it
# Angles [degrees] by which the normals of a flat sample may lean: as a whole, and outwards at its
# edges
LARGEST_LEAN, LARGEST_BULGE = 2.0, 8.0
# Smallest side of a map [texels] whose normals are judged; in fewer texels the slopes of bumps do
# not average to zero
FEWEST_TEXELS = 32


def describe_capture(capture: Capture, clipped: float, observed: Observations) -> tuple[str, ...]:
    """Return sentences on colours and details that the photographs do not show.

    `clipped` is the share of clipped values, which a sentence also mentions.
    """
    sentences = []
    dark = [
        name for name, lit in zip(COLOURS, observed.find_lit_channels(), strict=True) if not lit
    ]
    if dark:
        sentences.append(f"Nothing is seen in {join_words(dark)}: there the maps say nothing.")
    texel = np.array(capture.size) / observed.shape[::-1]
    lengths = [(capture.pixel_size(camera) / texel).max() for camera in capture.cameras]
    length = float(np.median(lengths))
    if length > LONG_PIXEL:
        sentences.append(
            f"A pixel is {length:.2g} texels long: what is finer than pixels is guessed from "
            "neighbours, and the standard errors do not know how well; see resolution."
        )
    if clipped:
        sentences.append(f"{100 * clipped:.2g} % of the pixels are clipped; they do not count.")
    return tuple(sentences)


def describe_normals(normals: FloatArray) -> tuple[str, ...]:
    """Return a sentence on normals (height, width, 3) that lean on average or towards the edges."""
    if min(normals.shape[:2]) < FEWEST_TEXELS:
        return ()
    lean, bulge = _measure_lean(normals)
    if lean < LARGEST_LEAN and bulge < LARGEST_BULGE:
        return ()
    return (
        f"The normals lean by {lean:.2g}° as a whole, and by {bulge:.2g}° towards the edges: the "
        "sample is not flat, or check the camera, the places of the lights, and which way is up.",
    )


def _measure_lean(normals: FloatArray) -> tuple[float, float]:
    """Return the mean slant of normals, and how much larger it is at the edges [degrees].

    Planes are fitted to the x and y of the normals (height, width, 3) over the map. Their mean is
    the slant; their slope is large for a bulging sample, whose normals lean outwards at its edges.
    """
    height, width = normals.shape[:2]
    y, x = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    terms = np.stack([np.ones_like(x), x, y], axis=-1).reshape(-1, 3)
    middle, *slopes = np.linalg.lstsq(terms, normals[..., :2].reshape(-1, 2), rcond=None)[0]
    return float(np.degrees(np.hypot(*middle))), float(np.degrees(np.abs(slopes).max()))
