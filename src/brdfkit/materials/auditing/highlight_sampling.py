"""Tells whether a highlight is narrower than the steps at which it was measured."""

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.materials.measured import Measured
from brdfkit.model.samples import Samples

# Neighbours in the plane of incidence that differ by more than this factor tell that a highlight is
# narrower than the sampling: of reconstructions of measured materials with steps of 1° to 10° and
# 5 % noise, no narrow highlight was missed, and 2 % of the others were reported
NARROW_RATIO = 3.0
OFFSET = 1e-3  # added to values [sr⁻¹], so that dark ones and their noise do not count
NEAR_LIGHT = 4.0  # neighbours nearer to the light [degrees] may show retro-reflection instead
WIDEST_STEP = 15.0  # values farther apart [degrees] are no neighbours
SAME_DIRECTION = 0.1  # directions nearer than this [degrees] count as equal
IN_PLANE = np.radians(1.0)  # samples this near to the plane of incidence count as in it
FEWEST_SAMPLES = 8


def warn_of_narrow_highlight(data: Measured) -> str:
    """Return a warning of a highlight that is narrower than the steps of its samples, or ""."""
    if data.is_table:
        return ""
    step, ratio = find_largest_ratio(data.samples)
    if ratio <= NARROW_RATIO:
        return ""
    return (
        f"neighbours {step:.2g}° apart differ {ratio:.0f} times: the highlight is narrower than "
        "the sampling; its height and width are guesses"
    )


def find_largest_ratio(samples: Samples) -> tuple[float, float]:
    """Return the step [degrees] and the ratio of the neighbours that differ most, or (0, 1).

    Neighbours have the same direction of incidence, and lie in its plane.
    """
    rows = samples.valid & is_in_own_plane(samples)
    if rows.sum() < FEWEST_SAMPLES:
        return 0.0, 1.0
    part = samples.at(rows)
    theta = np.degrees(np.arccos(np.clip(part.wi[:, 2], -1, 1)))
    ahead = compute_signed_angles(part)
    values = np.maximum(part.values.mean(axis=1), 0) + OFFSET
    # One number for each direction of incidence, and for each view in its plane
    keys = np.round(np.concatenate([part.wi, ahead[:, None] / 60], axis=1), 3)
    places, group = np.unique(keys, axis=0, return_inverse=True)
    group = group.ravel()
    counts = np.bincount(group)
    theta, ahead, values = (np.bincount(group, a) / counts for a in (theta, ahead, values))
    step = np.diff(ahead)
    neighbours = (places[1:, :3] == places[:-1, :3]).all(axis=1)
    neighbours &= (step > SAME_DIRECTION) & (step <= WIDEST_STEP)
    towards_light = np.abs(ahead + theta) < NEAR_LIGHT
    neighbours &= ~(towards_light[1:] | towards_light[:-1])
    if not neighbours.any():
        return 0.0, 1.0
    ratios = np.exp(np.abs(np.diff(np.log(values))))
    row = int(np.argmax(np.where(neighbours, ratios, 0)))
    return float(step[row]), float(ratios[row])


def is_in_own_plane(samples: Samples) -> BoolArray:
    """Return a mask (n,) of the samples that lie in the plane of incidence, to within 1°.

    For light along the normal this is the plane of the x axis.
    """
    across = compute_axes(samples)[1]
    return np.asarray(np.abs(np.sum(across * samples.wo[:, :2], axis=1)) < np.sin(IN_PLANE))


def compute_signed_angles(samples: Samples) -> FloatArray:
    """Return θo [degrees] of samples in the plane of incidence, below 0 on the light's side."""
    along = compute_axes(samples)[0]
    return np.degrees(np.arctan2(-np.sum(along * samples.wo[:, :2], axis=1), samples.wo[:, 2]))


def compute_axes(samples: Samples) -> tuple[FloatArray, FloatArray]:
    """Return the horizontal unit vectors (n, 2) towards the light, and across the plane."""
    along = samples.wi[:, :2]
    length = np.hypot(along[:, 0], along[:, 1])[:, None]
    along = np.where(length > IN_PLANE / 2, along / np.maximum(length, 1e-12), (1.0, 0.0))
    return along, np.stack([-along[:, 1], along[:, 0]], axis=1)
