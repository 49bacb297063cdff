"""Writes sentences about what is doubtful in the maps of an object."""

from collections.abc import Iterator

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.names import join_words
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.objects.fit_object import FittedObject

# Differences of exposures from 1 that are mentioned
MENTIONED_EXPOSURE = 0.03
# Standard deviation of relative residuals above which the model does not explain the photographs
MENTIONED_NOISE = 0.25
FEWEST_LIGHTS = 3  # photographs that determine the normal and the colour of a matt pixel
MENTIONED_SHARE = 0.01  # share of pixels above which they are mentioned
# A highlight's weight is unknown where its standard error is this share of the usual spread
UNKNOWN_SHARE = 0.9
MENTIONED_UNKNOWN = 0.3
MATT_SHARE = 0.005  # usual weight of a highlight beside the diffuse one, below which it is 0
MENTIONED_BRIGHT = 0.05  # share of pixels with a reflectance above 1
# A photograph is named whose residuals are this many times the median of all photographs
WORSE = 2.0
ALMOST = 0.8  # share of a photograph that counts, if its residuals are usual ones


def describe_object_fit(
    capture: ObjectCapture, state: FittedObject, by_name: dict[str, tuple[float, float]]
) -> tuple[str, ...]:
    """Return sentences about doubtful findings of a fit.

    `by_name` has the median and the 90th percentile of each photograph's relative errors.
    """
    return tuple(_find_doubts(capture, state, by_name))


def _find_doubts(
    capture: ObjectCapture, state: FittedObject, by_name: dict[str, tuple[float, float]]
) -> Iterator[str]:
    """Yield a sentence for each doubt."""
    known = state.calibration
    assert known is not None
    yield from _describe_exposures(capture.names, known.exposures)
    if known.noise > MENTIONED_NOISE:
        yield (
            f"The model does not explain the photographs, from which it differs by "
            f"{100 * known.noise:.0f} %: do not trust the maps. Check the lights and how the "
            "photographs are coded, or choose another model; mirrors need a light for each normal."
        )
    if len(capture.names) == FEWEST_LIGHTS:
        yield (
            f"{FEWEST_LIGHTS} photographs do not tell highlights from normals, so the errors are "
            "larger than stated; take more, or choose the model lambert for a matt object."
        )
    few = float((state.lights < ALMOST * FEWEST_LIGHTS).mean())
    if few > MENTIONED_SHARE:
        yield (
            f"In {100 * few:.0f} % of the pixels fewer than {FEWEST_LIGHTS} photographs count, the "
            "others being in the shadow or clipped: there neighbours and usual values decide."
        )
    for k, name in enumerate(known.parameters.lobes[1:], 1):
        spread = known.spreads[:, k]
        unknown = (state.weight_errors[:, :, k] > UNKNOWN_SHARE * spread).all(axis=1)
        if known.usual_weights[:, k].max() < MATT_SHARE * np.median(state.weights[:, :, 0]):
            yield f"The object looks matt: {name} is about 0 nearly everywhere."
        elif unknown.mean() > MENTIONED_UNKNOWN:
            yield (
                f"In {100 * unknown.mean():.0f} % of the pixels no photograph shows the highlight: "
                f"{name} is the usual one there. More lights would show it."
            )
    bright = float((state.weights[:, :, 0] > 1).any(axis=1).mean())
    if bright > MENTIONED_BRIGHT:
        yield (
            f"The diffuse reflectance is above 1 in {100 * bright:.0f} % of the pixels: the stated "
            "intensities of the lights are not in the units of the photographs, so all "
            "reflectances are too large by one factor."
        )
    medians = {name: median for name, (median, _) in by_name.items()}
    usual = float(np.median(list(medians.values()))) if medians else 0.0
    worse = [name for name, median in medians.items() if median > WORSE * usual]
    if worse:
        yield (f"Worst explained: {join_words(worse[:5])}; the light may be elsewhere than stated.")


def _describe_exposures(names: tuple[str, ...], exposures: FloatArray) -> Iterator[str]:
    """Yield a sentence on photographs whose exposure is not the stated one."""
    furthest = int(np.argmax(np.abs(np.log(exposures))))
    if abs(exposures[furthest] - 1) > MENTIONED_EXPOSURE:
        yield (
            "The photographs do not agree on the strength of their lights: the fit took "
            f"{names[furthest]} as {exposures[furthest]:.2f} times as bright as stated, and the "
            f"others {exposures.min():.2f} to {exposures.max():.2f} times."
        )
