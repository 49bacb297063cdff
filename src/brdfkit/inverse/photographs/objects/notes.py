"""Writes sentences about what is doubtful in the maps of an object."""

from collections.abc import Iterator

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.names import format_percent, join_words
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.objects.fit_object import FittedObject

# Differences of exposures from 1 that are mentioned
MENTIONED_EXPOSURE = 0.03
# Standard deviation of relative residuals above which the model does not explain the photographs
MENTIONED_NOISE = 0.25
FEWEST_LIGHTS = 3  # photographs that determine the normal and the colour of a matt pixel
ALMOST = 0.8  # share of a photograph that counts, if its residuals are usual ones
MENTIONED_SHARE = 0.01  # share of pixels above which they are mentioned
# A highlight's weight is unknown where its standard error is this share of the usual spread
UNKNOWN_SHARE = 0.9
MENTIONED_UNKNOWN = 0.3
MATT_SHARE = 0.005  # usual weight of a highlight beside the diffuse one, below which it is 0
MENTIONED_BRIGHT = 0.05  # share of pixels with a reflectance above 1
# A photograph is named whose residuals are this many times the median of all photographs
WORSE = 2.0
SMALLEST_WORSE = 0.02  # median relative error below which no photograph is named
DARKEST = 0.005  # median of the diffuse reflectance below which it is mentioned
BRIGHTEST = 0.95  # quantile of the diffuse reflectance that should be 1 at most


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
    yield from _describe_exposures(capture, known.exposures)
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
    yield from _describe_highlights(state)
    if known.noise <= MENTIONED_NOISE:
        yield from _describe_brightness(state.weights[:, :, 0].max(axis=1))
    yield from _describe_worst(by_name)


def _describe_highlights(state: FittedObject) -> Iterator[str]:
    """Yield a sentence for each lobe of highlights that the photographs hardly show."""
    known = state.calibration
    assert known is not None
    for k, name in enumerate(known.parameters.lobes[1:], 1):
        spread = known.spreads[:, k]
        unknown = (state.weight_errors[:, :, k] > UNKNOWN_SHARE * spread).all(axis=1)
        if known.usual_weights[:, k].max() < MATT_SHARE * np.median(state.weights[:, :, 0]):
            yield (
                f"The object looks matt: {name} is about 0 nearly everywhere, and the shape of "
                "its highlights is unknown."
            )
        elif unknown.mean() > MENTIONED_UNKNOWN:
            yield (
                f"In {_format_share(float(unknown.mean()))} of the pixels no photograph shows the "
                f"highlight: {name} has its usual value there. Lights from other directions would "
                "show it."
            )


def _describe_brightness(diffuse: FloatArray) -> Iterator[str]:
    """Yield a sentence on diffuse reflectances (n,) that no material has."""
    bright, median = float((diffuse > 1).mean()), float(np.median(diffuse))
    units = "not in the units of the photographs"
    if bright > MENTIONED_BRIGHT:
        yield (
            f"The diffuse reflectance is above 1 in {_format_share(bright)} of the pixels: the "
            f"intensities of the lights, which are 1 where nothing states them, are {units}. All "
            "reflectances are too large by one factor, probably "
            f"{np.quantile(diffuse, BRIGHTEST):.2g} or more."
        )
    elif median < DARKEST:
        yield (
            f"The diffuse reflectance is {median:.2g} in the median: unless the object is black or "
            "a metal, the intensities of the lights, which are 1 where nothing states them, are "
            f"{units}."
        )


def _describe_worst(by_name: dict[str, tuple[float, float]]) -> Iterator[str]:
    """Yield a sentence on photographs whose errors are larger than usual."""
    medians = {name: median for name, (median, _) in by_name.items()}
    usual = float(np.median(list(medians.values()))) if medians else 0.0
    limit = max(SMALLEST_WORSE, WORSE * usual)
    worse = sorted((name for name in medians if medians[name] > limit), key=lambda n: -medians[n])
    if worse:
        named = [f"{name} ({_format_share(medians[name])})" for name in worse[:5]]
        yield (
            f"Worst explained: {join_words(named)}; {_format_share(usual)} is usual. The "
            "directions of these lights may be wrong."
        )


def _describe_exposures(capture: ObjectCapture, exposures: FloatArray) -> Iterator[str]:
    """Yield a sentence on photographs whose exposure is not the given one."""
    furthest = int(np.argmax(np.abs(np.log(exposures))))
    if abs(exposures[furthest] - 1) <= MENTIONED_EXPOSURE:
        return
    others = np.delete(exposures, furthest)
    found = (
        f"that of {capture.names[furthest]} {exposures[furthest]:.2f} times as strong, and the "
        f"others {others.min():.2f} to {others.max():.2f} times"
    )
    if not np.ptp(capture.lights.intensities, axis=0).any():
        yield f"The lights are not equally strong: the fit found {found}."
    else:
        yield f"The strengths of the lights are not quite as given: the fit found {found}."


def _format_share(share: float) -> str:
    """Return a share of 1 as a percentage."""
    return format_percent(100 * share)
