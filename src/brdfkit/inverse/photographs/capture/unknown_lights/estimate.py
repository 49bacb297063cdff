"""Gives photographs of an object lights that are estimated from the photographs alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.diagnosis.frame import find_outline
from brdfkit.inverse.photographs.capture.diagnosis.lambert import Sample, fit_lambert
from brdfkit.inverse.photographs.capture.lights import Lights
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.capture.unknown_lights.factors import factorise
from brdfkit.inverse.photographs.capture.unknown_lights.search import find_matrix

MOST_PIXELS = 8000  # of a sample; on finer ones noise hides the slopes of the surface
FEWEST = 6  # lights that can be estimated
# Ratio of singular values of lights below which they lie in a plane
SMALLEST_SPREAD = 0.01
MOST_UNEXPLAINED = 0.6  # by Lambert's law, of the values of an object whose lights are estimated
SHORTEST_OUTLINE = 0.5  # share of the circumference of a disc as large as the object
NOTE = (
    "the lights are not known: they were estimated from the photographs, as those of a matte "
    "object mostly of one albedo; their directions may be wrong by 10° and more, and the shape "
    "with them."
)


def estimate_lights(capture: ObjectCapture, folder: Path) -> ObjectCapture:
    """Return photographs of an object with estimated distant lights, and a note on them.

    Raises `BrdfkitError`, which names the `folder`, for fewer than 6 photographs, for an object
    whose outline is hardly in the photographs, for one that is not matte, and for equal lights.
    """
    if len(capture.values) < FEWEST:
        raise BrdfkitError(
            f"{folder}: lights can be estimated from {FEWEST} photographs or more, and there are "
            f"{len(capture.values)}; say where the lights are in lights.txt."
        )
    sample = Sample.take(capture, MOST_PIXELS)
    edge, _ = find_outline(sample.mask)
    # The outline is 2 pixels wide
    if edge.sum() / 2 < SHORTEST_OUTLINE * 2 * np.sqrt(np.pi * sample.mask.sum()):
        raise BrdfkitError(
            f"{folder}: lights can only be estimated if the outline of the object is in the "
            "photographs, and the mask touches their edges; say where the lights are in lights.txt."
        )
    factors = factorise(sample)
    spread = np.linalg.svd(factors.lights, compute_uv=False)
    fit = fit_lambert(sample.values, sample.counted, factors.lights)
    if spread[2] < SMALLEST_SPREAD * spread[0] or fit.unexplained > MOST_UNEXPLAINED:
        raise BrdfkitError(
            f"{folder}: its lights cannot be estimated, as they differ too little from each other, "
            "or the object is not matte; say where they are in lights.txt."
        )
    lights = np.linalg.solve(find_matrix(factors).T, factors.lights.T).T
    lengths = np.linalg.norm(lights, axis=1, keepdims=True)
    intensities = np.repeat(lengths / lengths.mean(), 3, axis=1)
    return replace(
        capture, lights=Lights(lights / lengths, intensities), notes=(*capture.notes, NOTE)
    )
