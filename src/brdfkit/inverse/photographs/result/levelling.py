"""Whether normals are those of what lies flat: as a whole they do not lean, whatever its bumps."""

import numpy as np

from brdfkit.core.names import join_words
from brdfkit.inverse.photographs.capture.observations import shown_colours

COLOURS = "red", "green", "blue"
FINER = 1.25  # texels along a pixel, from which it is said


def describe_capture(capture, clipped, seen):
    """Sentences on a `Capture`, of which the share `clipped` is at its end, and what is `seen`."""
    said = []
    dark = [name for name, lit in zip(COLOURS, shown_colours(seen), strict=True) if not lit]
    if dark:
        said.append(f"Nothing is seen in {join_words(dark)}: there the maps say nothing.")
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


LEAN, BULGE = 2.0, 8.0  # degrees, of the middle and of the edges, from which it is said
FEWEST = 32  # texels along a side: of fewer the bumps themselves lean


def describe_normals(normals):
    """Sentences on normals (height, width, 3) that lean as a whole, or towards the edges."""
    if min(normals.shape[:2]) < FEWEST:
        return ()
    lean, bulge = leaning(normals)
    if lean < LEAN and bulge < BULGE:
        return ()
    return (
        f"The normals lean by {lean:.2g}° as a whole, and by {bulge:.2g}° towards the edges: the "
        "sample is not flat, or check the camera, the places of the lights, and which way is up.",
    )


def leaning(normals):
    """By how much [degrees] normals lean in the middle, and more so at the edges."""
    height, width = normals.shape[:2]
    y, x = np.mgrid[-1 : 1 : height * 1j, -1 : 1 : width * 1j]
    terms = np.stack([np.ones_like(x), x, y], axis=-1).reshape(-1, 3)
    middle, *slopes = np.linalg.lstsq(terms, normals[..., :2].reshape(-1, 2), rcond=None)[0]
    return np.degrees(np.hypot(*middle)), np.degrees(np.abs(slopes).max())
