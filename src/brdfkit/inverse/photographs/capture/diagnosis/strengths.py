"""Finds the strengths of lights that files do not state, or that photographs contradict."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.capture.diagnosis.lambert import LambertFit, Sample, fit_lambert
from brdfkit.inverse.photographs.capture.listing import Listing
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture

# With fewer lights, strengths of lights and shapes of objects are not told apart
FEWEST = 8
# Ratio of what Lambert's law leaves unexplained, below which the evidence is overwhelming
BETTER = 0.5
SMALLEST_SPREAD = 0.1  # standard deviation of estimated strengths below which lights are equal
MOST_UNEXPLAINED = 0.15  # by Lambert's law with estimated strengths; glossy objects mislead it
ROUNDS = 5  # of the search for the strengths of lights
# What the different lengths of vectors to lights can mean
LENGTHS = {
    "positions": "they were taken for positions of equal lamps, far away from the object, as its "
    "size is not known; a file capture.toml would tell it",
    "strengths": "they were taken for the strengths of the lights",
    "nothing": "they were not used, and the lights were taken to be equally strong",
}


def adapt_strengths(capture: ObjectCapture, listing: Listing) -> ObjectCapture:
    """Return the photographs with intensities of the lights that suit them, with a note if changed.

    Equal intensities, which no file states, become estimated ones where those explain the
    photographs much better; and stated intensities become equal ones where the photographs seem
    to be divided by them already. Lengths of vectors become what suits the photographs best.
    """
    if listing.lengths is not None:
        return _interpret_lengths(capture, listing)
    if len(capture.lights) < FEWEST:
        return capture
    sample = Sample.take(capture)
    given = fit_lambert(sample.values, sample.counted, sample.scaled_lights).unexplained
    if listing.has_intensities:
        equal = fit_lambert(sample.values, sample.counted, sample.directions).unexplained
        if equal >= BETTER * given or capture.lights.positions is not None:
            return capture
        note = (
            "the photographs seem to be divided by the intensities of the lights already, so these "
            "were taken to be equal."
        )
        return _set_intensities(capture, np.ones(len(sample.values)), note)
    strengths, free = estimate_strengths(sample)
    # The irradiance that a lamp causes is its intensity over the square of its distance
    intensities = strengths / sample.intensities
    intensities /= intensities.mean()
    is_better = free.unexplained < min(BETTER * given, MOST_UNEXPLAINED)
    if not is_better or intensities.std() < SMALLEST_SPREAD:
        return capture
    least, most = intensities.min(), intensities.max()
    note = (
        f"{listing.lights_file.name} states no intensities, and the lights are not equally strong: "
        f"they were estimated as {least:.2g} to {most:.2g} times their mean."
    )
    return _set_intensities(capture, intensities, note)


def _interpret_lengths(capture: ObjectCapture, listing: Listing) -> ObjectCapture:
    """Return the photographs with intensities by the lengths of the vectors to their lights.

    Without enough lights for a comparison, the vectors are positions.
    """
    names = {path.name: k for k, path in enumerate(listing.photographs)}
    assert listing.lengths is not None
    lengths = listing.lengths[[names[name] for name in capture.names]]
    options = {
        "positions": (np.median(lengths) / lengths) ** 2,
        "strengths": lengths / lengths.mean(),
        "nothing": np.ones(len(lengths)),
    }
    best = "positions"
    if len(lengths) >= FEWEST:
        sample = Sample.take(capture)
        unexplained = {
            word: fit_lambert(
                sample.values, sample.counted, strengths[:, None] * sample.directions
            ).unexplained
            for word, strengths in options.items()
        }
        best = min(unexplained, key=lambda word: unexplained[word])
    note = f"the vectors in {listing.lights_file.name} differ in length: {LENGTHS[best]}."
    return _set_intensities(capture, options[best], note)


def _set_intensities(capture: ObjectCapture, intensities: FloatArray, note: str) -> ObjectCapture:
    """Return photographs with other intensities of the lights (lights,), and a note on them."""
    lights = replace(capture.lights, intensities=np.repeat(intensities[:, None], 3, axis=1))
    return replace(capture, lights=lights, notes=(*capture.notes, note))


def estimate_strengths(sample: Sample) -> tuple[FloatArray, LambertFit]:
    """Estimate the strengths of the lights (lights,), with the mean 1, and fit Lambert's law.

    They start from `_solve_strengths`; then strengths and normals are fitted in turn to all values
    outside shadows and highlights.
    """
    strengths = _solve_strengths(sample)
    fit = fit_lambert(sample.values, sample.counted, strengths[:, None] * sample.directions)
    for _ in range(ROUNDS):
        predicted = sample.directions @ fit.scaled_normals.T * fit.used
        ratio = (sample.values * predicted).sum(axis=1)
        ratio = ratio / np.maximum((predicted**2).sum(axis=1), 1e-300)
        strengths = np.where(ratio > 0, ratio, strengths)
        strengths = strengths / strengths.mean()
        fit = fit_lambert(sample.values, sample.counted, strengths[:, None] * sample.directions)
    return strengths, fit


def _solve_strengths(sample: Sample) -> FloatArray:
    """Return strengths of the lights (lights,) from the pixels that few shadows reach.

    Their values are V = diag(s) D B, with the strengths s, the directions D (lights, 3) and scaled
    normals B. The first three left singular vectors U of V span the same space, U = diag(s) D A.
    So 1 / s and A are the solution of the linear equations u_k / s_k = d_k A.
    """
    darkest = sample.values.min(axis=0) / np.maximum(np.median(sample.values, axis=0), 1e-300)
    lit = sample.values[:, darkest >= np.median(darkest)]
    u, scale, _ = np.linalg.svd(lit, full_matrices=False)
    u = u[:, :3] * scale[:3]
    count = len(u)
    equations = np.zeros((count, 3, count + 9))
    for column in range(3):
        equations[np.arange(count), column, np.arange(count)] = u[:, column]
        equations[:, column, count + 3 * column : count + 3 * column + 3] = -sample.directions
    inverse = np.linalg.svd(equations.reshape(3 * count, -1))[2][-1][:count]
    if not (inverse * np.sign(inverse.sum()) > 0).all():  # Lambert's law does not hold
        return np.ones(count)
    strengths: FloatArray = 1 / inverse
    return strengths / strengths.mean()
