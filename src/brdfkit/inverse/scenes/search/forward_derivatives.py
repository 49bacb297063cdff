"""Computes derivatives of pictures with respect to few numbers, by rendering a picture for each."""

from collections.abc import Iterator
from contextlib import contextmanager

import drjit as dr
import numpy as np

from brdfkit.core.array_types import AnyArray, FloatArray, MitsubaObject
from brdfkit.core.jit.loops import raise_first_cause
from brdfkit.inverse.scenes.problem.views import Views, make_opaque_array

DERIVATIVE_COST = 2.3  # time of a picture of derivatives, relative to a plain picture
# Step of finite differences in a search coordinate; without bounds, relative to the coordinate
DIFFERENCE_STEP = 0.05
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


@contextmanager
def track_derivatives(views: Views, x: FloatArray) -> Iterator[list[MitsubaObject]]:
    """Track derivatives for the unknowns at `x` within a block; yield the unknowns' Mitsuba arrays.

    Tracking ends with the block, even after an error: Dr.Jit's loops visit the BSDFs of all scenes,
    so arrays that were still tracked would make every other scene fail.
    """
    entries = views.make_entries(x)
    dr.enable_grad(entries)
    try:
        views.write_entries(entries)
        yield entries
    finally:
        views.write_to_scene(x)


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
    return _compute_finite_differences(views, x, numbers, spp, seed)


def _render_derivative(
    views: Views, x: FloatArray, numbers: list[int], spp: int, seed: int
) -> FloatArray | None:
    """Render the derivative of the pixels; None if Mitsuba finds nothing to differentiate."""
    views.cost += DERIVATIVE_COST * spp
    tangent = np.zeros(len(x))
    tangent[numbers] = views.differentiate_values(x)[numbers]
    try:
        # Every unknown gets a tangent, mostly 0, so that one compiled kernel serves all derivatives
        with raise_first_cause(), track_derivatives(views, x) as entries:
            for entry, part in zip(entries, views.split_by_unknown(tangent), strict=True):
                dr.set_grad(entry, make_opaque_array(type(entry), part))
            # Propagate derivatives to values that plugins precompute, as the renderer's loops do
            # not
            dr.enqueue(dr.ADMode.Forward, entries)
            dr.traverse(dr.ADMode.Forward, flags=dr.ADFlag.ClearEdges)
            return views.join_pictures(
                [
                    views.integrator.render_forward(
                        views.scene,
                        views.parameters,
                        sensor=sensor,
                        seed=int(seed) + i,
                        spp=int(spp),
                    )
                    for i, sensor in enumerate(views.scene.sensors())
                ]
            )
    except Exception as error:
        if NOT_ATTACHED not in str(error):
            raise
        return None


def _compute_finite_differences(
    views: Views, x: FloatArray, numbers: list[int], spp: int, seed: int
) -> FloatArray:
    """Return the pixels' derivative: central differences of pictures with equal samples."""
    ends = np.array([x, x], float)
    step = DIFFERENCE_STEP * np.maximum(np.abs(x), DIFFERENCE_STEP)
    step[views.upper_bounds - views.lower_bounds == 1] = DIFFERENCE_STEP
    ends[:, numbers] += np.outer([-1, 1], step[numbers])
    ends = np.clip(ends, views.lower_bounds, views.upper_bounds)
    low, high = (views.render_residuals(end, spp, seed) for end in ends)
    width = (ends[1] - ends[0])[numbers]
    return (high - low) / (width if len(width) == high.shape[1] else width[0])
