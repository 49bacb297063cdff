"""Computes derivatives of pictures with respect to few numbers, by rendering a picture for each."""

from collections.abc import Iterator
from contextlib import contextmanager

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, MitsubaObject
from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.inverse.scenes.problem.tensors import make_opaque_array
from brdfkit.inverse.scenes.problem.views import Views

DERIVATIVE_COST = 2.3  # time of a picture of derivatives, relative to a plain picture
# Step of finite differences in a search coordinate; without bounds, relative to the coordinate
DIFFERENCE_STEP = 0.05
# Step of finite differences for the place of a lamp: a share of its distance, or in radians
PLACE_STEP = 0.03
# Integrators of Mitsuba that cannot render a picture of derivatives
BACKWARD_ONLY = "PRBVolpathIntegrator", "BasicVolumetricPrimitiveRadianceFieldIntegrator"
NOT_ATTACHED = "not attached to the AD graph"  # part of Mitsuba's error if nothing has a derivative


def compute_derivatives(views: Views, x: FloatArray, spp: int, seed: int) -> AnyArray:
    """Return the derivatives (n, pixels, channels) of all pixels by the coordinates `x`."""
    derivatives = np.zeros((len(x), *views.target_pixels.shape), np.float32)
    for numbers in group_numbers_by_picture(views):
        picture = _compute_derivative(views, x, numbers, spp, seed)
        store_by_channel(picture, derivatives, numbers)
    return derivatives


def group_numbers_by_picture(views: Views) -> Iterator[list[int]]:
    """Yield groups of numbers, by index, whose derivatives fit into one picture.

    The three numbers of a colour each change their own channel alone, so they share a picture. All
    other numbers need a picture each.
    """
    for end, unknown in zip(views.ends, views.unknowns, strict=True):
        rows = list(range(end - len(unknown.start), end))
        yield from [rows] if unknown.is_colour else [[row] for row in rows]


def store_by_channel(picture: AnyArray, derivatives: AnyArray, rows: list[int]) -> None:
    """Copy a picture (pixels, channels) into the `rows` of `derivatives` (n, pixels, channels).

    A single row receives all channels; each of several rows receives only its own channel.
    """
    for channel, row in enumerate(rows):
        own = [channel] if 1 < len(rows) == picture.shape[1] else slice(None)
        derivatives[row][:, own] = picture[:, own]


def count_derivative_pictures(views: Views) -> float:
    """Return how many renderings of all pictures the derivatives take.

    Numbers of a lamp count less, as only the pictures that it lights are rendered.
    """
    groups = group_numbers_by_picture(views)
    return sum(len(views.find_changed_pictures(group)) for group in groups) / len(views.targets)


@contextmanager
def track_derivatives(views: Views, x: FloatArray, picture: int) -> Iterator[list[MitsubaObject]]:
    """Track derivatives for the unknowns at `x` within a block, in the light of a picture.

    Yields the unknowns' Mitsuba arrays; those of transforms, the places of lamps, are not tracked.
    Tracking ends with the block, even after an error: Dr.Jit's loops visit the BSDFs of all scenes,
    so arrays that were still tracked would make every other scene fail.
    """
    entries = views.make_entries(x)
    for unknown, entry in zip(views.unknowns, entries, strict=True):
        if not unknown.place:
            dr.enable_grad(entry)
    try:
        views.write_entries(entries, picture)
        yield entries
    finally:
        views.write_to_scene(x, picture)


def _compute_derivative(
    views: Views, x: FloatArray, numbers: list[int], spp: int, seed: int
) -> FloatArray:
    """Return the derivative (pixels, channels) of the pixels as the `numbers` move together.

    Finite differences replace Mitsuba's derivative where it is wrong or missing, as it is for the
    position of a lamp.
    """
    wrong = views.has_wrong_derivatives[numbers].any()
    if not wrong and type(views.integrator).__name__ not in BACKWARD_ONLY:
        picture = _render_derivative(views, x, numbers, spp, seed)
        if picture is not None and picture.any():
            return picture
    return compute_finite_differences(views, x, numbers, spp, seed)


def _render_derivative(
    views: Views, x: FloatArray, numbers: list[int], spp: int, seed: int
) -> FloatArray | None:
    """Render the derivative of the pixels; None if Mitsuba finds nothing to differentiate."""
    tangent, pictures = np.zeros(len(x)), views.make_black_pictures()
    tangent[numbers] = views.differentiate_values(x)[numbers]
    changed = views.find_changed_pictures(numbers)
    views.cost += DERIVATIVE_COST * spp * len(changed) / len(pictures)
    try:
        for i in changed:
            pictures[i] = _render_picture_of_derivatives(views, x, tangent, i, spp, seed)
    except Exception as error:
        if NOT_ATTACHED not in str(error):
            raise
        return None
    return views.join_pictures(pictures)


def _render_picture_of_derivatives(
    views: Views, x: FloatArray, tangent: FloatArray, picture: int, spp: int, seed: int
) -> AnyArray:
    """Return one picture's derivative (height, width, channels) as the values move by `tangent`."""
    # Every unknown gets a tangent, mostly 0, so that one compiled kernel serves all derivatives
    with raise_first_cause(), track_derivatives(views, x, picture) as entries:
        parts = zip(views.unknowns, entries, views.split_by_unknown(tangent), strict=True)
        tracked = []
        for unknown, entry, part in parts:
            if not unknown.place:
                dr.set_grad(entry, make_opaque_array(type(entry), part))
                tracked.append(entry)
        # Propagate derivatives to values that plugins precompute, as the renderer's loops do not
        dr.enqueue(dr.ADMode.Forward, tracked)
        dr.traverse(dr.ADMode.Forward, flags=dr.ADFlag.ClearEdges)
        return np.array(
            views.integrator.render_forward(
                views.scene,
                views.parameters,
                sensor=views.sensors[picture],
                seed=int(seed) + picture,
                spp=int(spp),
            )
        )


def compute_finite_differences(
    views: Views, x: FloatArray, numbers: list[int], spp: int, seed: int
) -> FloatArray:
    """Return the pixels' derivative: central differences of pictures with equal samples."""
    ends, changed = np.array([x, x], float), views.find_changed_pictures(numbers)
    step = DIFFERENCE_STEP * np.maximum(np.abs(x), DIFFERENCE_STEP)
    step[views.upper_bounds - views.lower_bounds == 1] = DIFFERENCE_STEP
    step = np.where(views.is_place, PLACE_STEP * views.scales, step)
    ends[:, numbers] += np.outer([-1, 1], step[numbers])
    ends = np.clip(ends, views.lower_bounds, views.upper_bounds)
    low, high = (views.render_pixels(end, spp, seed, changed) for end in ends)
    width = (ends[1] - ends[0])[numbers]
    return (high - low) / (width if len(width) == high.shape[1] else width[0])
