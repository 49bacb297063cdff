"""Finds lights that are in another order than the photographs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from brdfkit.core.array_types import IntArray
from brdfkit.inverse.photographs.capture.diagnosis.lambert import (
    FEWEST_RANKED,
    Sample,
    fit_lambert,
)
from brdfkit.inverse.photographs.capture.listing import Listing
from brdfkit.inverse.photographs.capture.object_capture import ObjectCapture

# What Lambert's law leaves unexplained of glossy objects at most, and of shuffled lights at least
MOST_UNEXPLAINED = 0.7
BETTER = 0.6  # ratio of that by another order, below which the evidence for it is overwhelming


def order_lights(capture: ObjectCapture, listing: Listing) -> ObjectCapture:
    """Return the photographs with their lights in an order that suits them, with a note if changed.

    Programs sort names as 1, 10, 2, and so may be the rows of a table without names.
    """
    if len(capture.lights) < FEWEST_RANKED or not listing.is_ordered_by_number:
        return capture
    order = find_alphabetical_order(listing)
    place = {path.name: k for k, path in enumerate(listing.photographs)}
    kept = np.array([place[name] for name in capture.names])
    other = replace(capture, lights=listing.lights.select(order[kept]))
    given = measure_unexplained(capture)
    if given < MOST_UNEXPLAINED or measure_unexplained(other) > BETTER * given:
        return capture
    note = (
        f"the rows of {listing.lights_file.name} belong to the photographs in alphabetical order, "
        "as Lambert's law shows: 10 comes before 2."
    )
    return replace(other, notes=(*other.notes, note))


def find_alphabetical_order(listing: Listing) -> IntArray:
    """Return the row of the lights that belongs to each photograph if names are sorted as text."""
    names = [path.name for path in listing.photographs]
    rows = {name: row for row, name in enumerate(sorted(names))}
    return np.array([rows[name] for name in names])


def describe_misfit(capture: ObjectCapture) -> tuple[str, ...]:
    """Return a sentence if Lambert's law hardly explains photographs by their lights, or none."""
    if len(capture.lights) < FEWEST_RANKED or measure_unexplained(capture) < MOST_UNEXPLAINED:
        return ()
    return (
        "the lights hardly explain the photographs: check that they are in the same order, and "
        "that the camera and the object stood still.",
    )


def measure_unexplained(capture: ObjectCapture) -> float:
    """Return which share of the photographs Lambert's law leaves unexplained: see `LambertFit`."""
    sample = Sample.take(capture)
    return fit_lambert(sample.values, sample.counted, sample.scaled_lights).unexplained
