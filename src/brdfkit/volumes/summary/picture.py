"""The figure of a `VolumeSummary`: three slices and two histograms, and a transfer function."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from brdfkit.core.colours import to_srgb
from brdfkit.volumes.orientation import (
    SlicePlane,
    find_nearest_axes,
    list_slice_planes,
    name_ends,
)
from brdfkit.volumes.summary.histograms import PARTS
from brdfkit.volumes.transfer.transfer_function import TransferFunction
from brdfkit.volumes.transfer.windows import scale_transfer_to_values
from brdfkit.volumes.volume import Volume

VolumeSummary = Any  # the class in `summary.py`; its import would be circular
Reach = tuple[float, float, float, float]  # first and last value, first and last gradient

SIZE = 10.4, 7.2  # inches
COLOUR = "#0072b2"  # blue, the colour of the histogram of values
POINTS = 400  # number of samples of a drawn transfer function along each axis
LEVELS = 0.01, 0.25, 0.5, 0.75  # values of A whose contour lines are drawn
VEIL = 0.85  # opacity of the transfer function's colours over the histogram where A is 1


def draw_summary(summary: VolumeSummary, transfer: TransferFunction | None = None) -> Figure:
    """Draw a `VolumeSummary` as a matplotlib `Figure`, with an optional `TransferFunction`."""
    if transfer is not None:
        transfer = _scale_transfer_to_volume(transfer, summary.data)
    figure = Figure(figsize=SIZE, layout="constrained")
    above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=(1.3, 1))[:, 0]
    for axes, plane in zip(above.subplots(1, 3), list_slice_planes(summary.data), strict=True):
        _draw_slice(axes, summary, plane)
    if summary.labels:
        _draw_value_histogram(below.subplots(), summary, transfer)
        return figure
    left, right = below.subplots(1, 2)
    _draw_value_histogram(left, summary, transfer)
    _draw_gradient_histogram(right, summary, transfer)
    return figure


def _draw_slice(axes: Axes, summary: VolumeSummary, plane: SlicePlane) -> None:
    """Draw the middle slice of a plane, and label the two axes in it."""
    through = plane.axes[2]
    middle = summary.size[through] // 2
    colours = "tab20" if summary.labels else "gray"
    across, up = (_find_axis_span(summary.data, plane, k) for k in range(2))
    axes.imshow(
        plane.cut(summary.data.values, middle),
        cmap=colours,
        vmin=summary.least,
        vmax=summary.largest,
        extent=(*across, *up),
        interpolation="nearest",
    )
    axes.set_xlabel(_label_axis(summary.data, plane, 0))
    axes.set_ylabel(_label_axis(summary.data, plane, 1))
    name = f"{plane.name}: " if summary.data.axes == "RAS" else ""
    axes.set_title(f"{name}slice {middle} along {'xyz'[through]}", fontsize=10)


def _label_axis(volume: Volume, plane: SlicePlane, k: int) -> str:
    """Return the label of the axis to the right (`k` = 0) or upwards (1), with its direction."""
    axis, way = plane.axes[k], plane.ways[k]
    unit = f" [{volume.unit}]" if volume.unit else ""
    return f"{'xyz'[axis]}{unit} → {name_ends(volume)[axis][way > 0]}"


def _find_axis_span(volume: Volume, plane: SlicePlane, k: int) -> tuple[float, float]:
    """Return the world coordinates at the left and right, or at the lower and upper edge.

    `k` is 0 or 1, as for `_label_axis`.
    """
    axis, way = plane.axes[k], plane.ways[k]
    _, signs = find_nearest_axes(volume.to_world)
    start, along = volume.cube_to_world[:3, 3], volume.cube_to_world[:3, axis]
    length = float(np.linalg.norm(along))
    begin = float(signs[axis] * (start @ along)) / length
    end = begin + signs[axis] * length
    return (begin, end) if way > 0 else (end, begin)


def _draw_value_histogram(
    axes: Axes, summary: VolumeSummary, transfer: TransferFunction | None = None
) -> None:
    """Draw the histogram of values, and over it the curve and colours of a transfer function."""
    edges = np.linspace(summary.least, max(summary.largest, summary.least + 1e-9), PARTS + 1)
    axes.stairs(summary.counts, edges, fill=True, color=COLOUR)
    axes.set(yscale="log", xlabel="value", ylabel="voxels")
    axes.set_title(f"{summary.name}".replace("$", r"\$"), fontsize=10)
    axes.spines[["top", "right"]].set_visible(False)
    if transfer is not None and transfer.gradients is None:
        _draw_alpha_curve(axes, transfer, (edges[0], edges[-1]))


def _draw_gradient_histogram(
    axes: Axes, summary: VolumeSummary, transfer: TransferFunction | None = None
) -> None:
    """Draw the joint histogram of values and gradient magnitudes, and a transfer function on it."""
    unit = f" per {summary.unit}" if summary.unit else ""
    axes.set(xlabel="value", ylabel=f"gradient magnitude{unit}")
    if not summary.joint_histogram.max() > 0 or summary.least == summary.largest:
        return
    reach = (summary.least, summary.largest, 0, summary.steepest or 1)
    picture = axes.imshow(
        np.ma.masked_equal(summary.joint_histogram, 0),
        norm=LogNorm(1, max(int(summary.joint_histogram.max()), 2)),
        origin="lower",
        extent=reach,
        aspect="auto",
        cmap="viridis",
    )
    axes.figure.colorbar(picture, ax=axes, label="voxels")
    if transfer is not None:
        _draw_transfer_function(axes, transfer, reach)


def _scale_transfer_to_volume(transfer: TransferFunction, volume: Any) -> TransferFunction:
    """Convert a transfer function to the volume's values and unit of length, as renderers do."""
    transfer = scale_transfer_to_values(transfer, volume.values)
    return transfer.per(volume.unit) if volume.unit and transfer.length_unit else transfer


def _draw_alpha_curve(axes: Axes, transfer: TransferFunction, reach: tuple[float, float]) -> None:
    """Draw a transfer function over the values `reach` (low, high): A as a curve, colours below."""
    values = np.linspace(*reach, POINTS)
    rgba = transfer(values)
    own = axes.twinx()
    own.imshow(
        to_srgb(np.clip(rgba[None, :, :3], 0, 1)),
        extent=(*reach, -0.08, -0.02),
        aspect="auto",
        interpolation="nearest",
    )
    own.plot(values, rgba[:, 3], color="black", linewidth=1.4)
    own.set(xlim=reach, ylim=(-0.1, 1.05), ylabel="A")


def _draw_transfer_function(axes: Axes, transfer: TransferFunction, reach: Reach) -> None:
    """Draw a transfer function over values and gradient magnitudes: colours, and contours of A.

    `reach` are the ends of both axes.
    """
    low, high, _, steepest = reach
    values, gradients = np.linspace(low, high, POINTS), np.linspace(0, steepest, POINTS)
    if transfer.gradients is None:
        rgba = np.broadcast_to(transfer(values), (POINTS, POINTS, 4))
    else:
        rgba = transfer(values, gradients[:, None])
    colours = to_srgb(np.clip(rgba[..., :3], 0, 1))
    veil = np.dstack([colours, VEIL * rgba[..., 3]])
    axes.imshow(veil, origin="lower", extent=reach, aspect="auto", zorder=2)
    lines = axes.contour(
        values, gradients, rgba[..., 3], LEVELS, colors="black", linewidths=0.7, zorder=3
    )
    axes.clabel(lines, fmt="A = %g", fontsize=7)
    axes.set_title(transfer.name.replace("$", r"\$"), fontsize=10)
