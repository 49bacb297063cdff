"""Compares photographs of an object with Lambert's law: the axes of lights, and the coding."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.inverse.photographs.capture.diagnosis.frame import describe_axes, find_axes
from brdfkit.inverse.photographs.capture.diagnosis.lambert import Sample, fit_lambert
from brdfkit.inverse.photographs.capture.lights import Lights
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.capture.pictures.coding import USUAL_GAMMA

# The turn by half a circle about the camera's axis; it also makes a bowl of a ball
HALF_TURN = np.diag([-1.0, -1.0, 1.0])
# Ratio of what Lambert's law leaves unexplained, below which the evidence is overwhelming
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
    fit = fit_lambert(sample.values, sample.counted, sample.scaled_lights)
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


def transform_lights(lights: Lights, matrix: FloatArray) -> Lights:
    """Return the lights with directions, positions and axes multiplied by a matrix (3, 3)."""
    return replace(
        lights,
        directions=lights.directions @ matrix.T,
        positions=None if lights.positions is None else lights.positions @ matrix.T,
        axes=None if lights.axes is None else lights.axes @ matrix.T,
    )


def find_coding(capture: ObjectCapture) -> str | None:
    """Return "coded" or "decoded" if Lambert's law fits values to the power of γ or 1/γ better.

    The first means that the values seem to be coded with a gamma, the second that a gamma was
    removed that they did not have. None if neither fits much better.
    """
    sample = Sample.take(capture)
    given = fit_lambert(sample.values, sample.counted, sample.scaled_lights).unexplained
    for name, power in ("coded", USUAL_GAMMA), ("decoded", 1 / USUAL_GAMMA):
        values = (sample.values / sample.intensities[:, None]) ** power
        other = fit_lambert(values, sample.counted, sample.directions).unexplained
        if other < BETTER_CODING * given:
            return name
    return None
