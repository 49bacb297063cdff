"""Compares photographs of an object with Lambert's law: axes, strengths of lights, and coding."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.capture.diagnosis.frame import describe_axes, find_axes
from brdfkit.inverse.photographs.capture.diagnosis.lambert import (
    Sample,
    estimate_strengths,
    fit_lambert,
)
from brdfkit.inverse.photographs.capture.lights import Lights
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.capture.pictures.coding import USUAL_GAMMA

# With fewer lights, strengths of lights and shapes of objects are not told apart
FEWEST_FOR_STRENGTHS = 8
# The turn by half a circle about the camera's axis; it also makes a bowl of a ball
HALF_TURN = np.diag([-1.0, -1.0, 1.0])
# Ratios of what Lambert's law leaves unexplained, below which the evidence is overwhelming
BETTER_STRENGTHS = 0.5
SMALLEST_SPREAD = 0.1  # standard deviation of estimated strengths below which lights are equal
MOST_UNEXPLAINED = 0.15  # by Lambert's law with estimated strengths; glossy objects mislead it
BETTER_CODING = 0.85


def turn_lights(capture: ObjectCapture, lights_file: Path) -> ObjectCapture:
    """Return the photographs with lights in the axes of the photographs, with a note if turned.

    The lights are only turned if the outline of the object leaves no doubt about it. A hollow
    object is not told from one whose lights are turned by half a circle, so these are kept.
    """
    matrix = np.eye(3)
    if (capture.lights.directions[:, 2] < 0).all():
        matrix[2, 2] = -1
    lights = transform_lights(capture.lights, matrix)
    sample = Sample.take(replace(capture, lights=lights))
    fit = fit_lambert(sample.values, sample.counted, scale(sample))
    turn = find_axes(fit.scaled_normals, sample.mask)
    matrix = matrix if turn is None else turn @ matrix
    if (matrix == np.eye(3)).all():
        return capture
    if (matrix == HALF_TURN).all():
        note = (
            f"the normals at the outline point inwards: the object is hollow, or -x and -y of "
            f"{lights_file.name} point to the right and up in the photographs."
        )
        return replace(capture, notes=(*capture.notes, note))
    note = (
        f"{lights_file.name}: the outline of the object shows that in this file "
        f"{describe_axes(matrix)}; the lights were turned into the axes of the photographs."
    )
    turned = transform_lights(capture.lights, matrix)
    return replace(capture, lights=turned, notes=(*capture.notes, note))


def scale(sample: Sample) -> FloatArray:
    """Return the directions of the lights of a sample times their intensities (lights, 3)."""
    return sample.directions * sample.intensities[:, None]


def transform_lights(lights: Lights, matrix: FloatArray) -> Lights:
    """Return the lights with directions, positions and axes multiplied by a matrix (3, 3)."""
    return replace(
        lights,
        directions=lights.directions @ matrix.T,
        positions=None if lights.positions is None else lights.positions @ matrix.T,
        axes=None if lights.axes is None else lights.axes @ matrix.T,
    )


def adapt_strengths(
    capture: ObjectCapture, lights_file: Path, has_intensities: bool
) -> ObjectCapture:
    """Return the photographs with intensities of the lights that suit them, with a note if changed.

    Equal intensities, which no file states, become estimated ones where those explain the
    photographs much better; and stated intensities become equal ones where the photographs seem
    to be divided by them already.
    """
    if len(capture.lights) < FEWEST_FOR_STRENGTHS:
        return capture
    sample = Sample.take(capture)
    given = fit_lambert(sample.values, sample.counted, scale(sample)).unexplained
    if has_intensities:
        equal = fit_lambert(sample.values, sample.counted, sample.directions).unexplained
        if equal >= BETTER_STRENGTHS * given:
            return capture
        intensities = np.ones_like(capture.lights.intensities)
        note = (
            "the photographs seem to be divided by the intensities of the lights already, so these "
            "were taken to be equal."
        )
    else:
        strengths, free = estimate_strengths(sample)
        is_better = free.unexplained < min(BETTER_STRENGTHS * given, MOST_UNEXPLAINED)
        if not is_better or strengths.std() < SMALLEST_SPREAD:
            return capture
        intensities = np.repeat(strengths[:, None], 3, axis=1)
        note = (
            f"{lights_file.name} states no intensities, and the lights are not equally strong: "
            f"they were estimated as {strengths.min():.2g} to {strengths.max():.2g} times their "
            "mean."
        )
    lights = replace(capture.lights, intensities=intensities)
    return replace(capture, lights=lights, notes=(*capture.notes, note))


def find_coding(capture: ObjectCapture) -> str | None:
    """Return "coded" or "decoded" if Lambert's law fits values to the power of γ or 1/γ better.

    The first means that the values seem to be coded with a gamma, the second that a gamma was
    removed that they did not have. None if neither fits much better.
    """
    sample = Sample.take(capture)
    given = fit_lambert(sample.values, sample.counted, scale(sample)).unexplained
    for name, power in ("coded", USUAL_GAMMA), ("decoded", 1 / USUAL_GAMMA):
        values = (sample.values / sample.intensities[:, None]) ** power
        other = fit_lambert(values, sample.counted, sample.directions).unexplained
        if other < BETTER_CODING * given:
            return name
    return None
