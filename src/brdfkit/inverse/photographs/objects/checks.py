"""Checks photographs of an object before a fit, and marks values that are no numbers as lost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.inverse.photographs.capture.lights import Lights
from brdfkit.inverse.photographs.capture.making_lights import SMALLEST_SPREAD
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture
from brdfkit.inverse.photographs.maps.texel_parameters import CHANNELS

LENGTH_TOLERANCE = 1e-3  # largest difference of a unit vector's length from 1


def prepare_object(capture: ObjectCapture) -> ObjectCapture:
    """Return photographs whose values are finite; those that were not are 0, and lost.

    Raises `BrdfkitError` for arrays that do not fit each other, lights without a direction or an
    intensity, an empty mask, and photographs that are black in all pixels that count.
    """
    _check_shapes(capture)
    _check_lights(capture.lights)
    finite = np.isfinite(capture.values)
    bad = int((~finite).any(axis=(0, 2)).sum())
    if bad:
        lost = ~finite if capture.lost is None else capture.lost | ~finite
        note = f"In {bad:,} pixels some values are not finite; they do not count."
        values = np.where(finite, capture.values, capture.values.dtype.type(0))
        capture = replace(capture, values=values, lost=lost, notes=(*capture.notes, note))
    bright = capture.values > 0
    if capture.lost is not None:
        bright &= ~capture.lost
    if not bright.any():
        raise BrdfkitError(
            f"{capture.name}: all photographs are black, clipped or lost where the object is; "
            "check their exposure, and the mask."
        )
    return capture


def check_lights_of_fit(capture: ObjectCapture) -> None:
    """Raise `BrdfkitError` for fitted photographs whose lights lie in one plane."""
    spread = np.linalg.svd(capture.lights.directions, compute_uv=False)
    if spread[2] < SMALLEST_SPREAD * spread[0]:
        raise BrdfkitError(
            f"{capture.name}: the directions of all lights that are fitted lie in one plane, which "
            "leaves the normals open; add lights from other sides."
        )


def _check_shapes(capture: ObjectCapture) -> None:
    """Raise `BrdfkitError` unless the arrays of a capture fit each other."""
    count, pixels = len(capture.lights), int(capture.mask.sum())
    if not pixels:
        raise BrdfkitError(
            f"{capture.name}: the mask shows no pixel of the object; paint the object white in it."
        )
    if len(capture.names) != count or len(set(capture.names)) != count:
        raise BrdfkitError(f"names: there should be {count}, one for each light, all different.")
    for name, shape in (
        ("values", (count, pixels, CHANNELS)),
        ("lost", (count, pixels, CHANNELS)),
        ("normals", (pixels, 3)),
    ):
        array = getattr(capture, name)
        if array is not None and array.shape != shape:
            raise BrdfkitError(
                f"{name}: its shape {array.shape} should be {shape}, for {count} lights and the "
                f"{pixels:,} pixels of the mask."
            )


def _check_lights(lights: Lights) -> None:
    """Raise `BrdfkitError` for lights with wrong directions, intensities or positions."""
    shape = len(lights), 3
    for name in ("directions", "intensities", "positions", "axes"):
        vectors = getattr(lights, name)
        if vectors is not None and (vectors.shape != shape or not np.isfinite(vectors).all()):
            raise BrdfkitError(
                f"{name}: they should be three finite numbers for each of the {len(lights)} lights."
            )
    for name in ("directions", "axes"):
        vectors = getattr(lights, name)
        if vectors is None:
            continue
        if np.abs(np.linalg.norm(vectors, axis=1) - 1).max() > LENGTH_TOLERANCE:
            raise BrdfkitError(f"{name}: they should be unit vectors; divide by their lengths.")
    power = lights.intensities
    if (power < 0).any() or not (power > 0).any(axis=1).all():
        raise BrdfkitError("intensities: each light needs one above 0, and none below.")
    if lights.positions is not None and (lights.positions[:, 2] == 0).any():
        number = int(np.argmax(lights.positions[:, 2] == 0))
        raise BrdfkitError(
            f"positions: lamp {number + 1} is at z = 0, within the object; z points from the "
            "object to the camera, in metres."
        )
