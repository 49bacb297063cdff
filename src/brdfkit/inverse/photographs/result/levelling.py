"""Whether normals are those of what lies flat: as a whole they do not lean, whatever its bumps."""

import numpy as np

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
