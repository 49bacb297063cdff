"""A `VolumeSummary` as a picture: three slices through the middle, and two histograms."""

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from brdfkit.volumes.summary.histograms import PARTS
from brdfkit.volumes.summary.picture_of_function import draw_curve, draw_function, for_volume

SIZE = 10.4, 7.2  # inches
COLOUR = "#0072b2"
PLANES = (("x", "y", "z"), ("x", "z", "y"), ("y", "z", "x"))  # across, up, and through


def picture(summary, transfer=None):
    """The picture of a `VolumeSummary` as a matplotlib `Figure`, with a `TransferFunction`."""
    if transfer is not None:
        transfer = for_volume(transfer, summary.data)
    figure = Figure(figsize=SIZE, layout="constrained")
    above, below = figure.subfigures(2, 1, height_ratios=(1.3, 1))
    for axes, (across, up, through) in zip(above.subplots(1, 3), PLANES, strict=True):
        _draw_slice(axes, summary, "xyz".index(across), "xyz".index(up), "xyz".index(through))
    if summary.labels:
        draw_values(below.subplots(), summary, transfer)
        return figure
    left, right = below.subplots(1, 2)
    draw_values(left, summary, transfer)
    draw_gradients(right, summary, transfer)
    return figure


def _draw_slice(axes, summary, across, up, through):
    """Draw the middle slice, with the two axes of the grid and where they go."""
    middle = summary.size[through] // 2
    voxels = np.take(summary.data.values, middle, axis=2 - through)  # (up, across): z is slowest
    colours = "tab20" if summary.labels else "gray"
    axes.imshow(
        voxels,
        cmap=colours,
        vmin=summary.least,
        vmax=summary.largest,
        origin="lower",
        extent=(*span(summary.data, across), *span(summary.data, up)),
        interpolation="nearest",
    )
    unit = f" [{summary.unit}]" if summary.unit else ""
    axes.set_xlabel(f"{'xyz'[across]}{unit} → {summary.directions[across]}")
    axes.set_ylabel(f"{'xyz'[up]}{unit} → {summary.directions[up]}")
    axes.set_title(f"slice {middle} along {'xyz'[through]}", fontsize=10)


def span(volume, axis):
    """Where the grid's `axis` begins and ends in the world, along it; it may run downwards."""
    start, along = volume.cube_to_world[:3, 3], volume.cube_to_world[:3, axis]
    length = np.linalg.norm(along)
    one_way = np.sign(along[np.abs(along).argmax()])
    begin = one_way * (start @ along) / length
    return begin, begin + one_way * length


def draw_values(axes, summary, transfer=None):
    """Draw the histogram of values, over it σ_t of a function of values, below it the colours."""
    edges = np.linspace(summary.least, max(summary.largest, summary.least + 1e-9), PARTS + 1)
    axes.stairs(summary.counts, edges, fill=True, color=COLOUR)
    axes.set(yscale="log", xlabel="value", ylabel="voxels")
    axes.set_title(f"{summary.name}".replace("$", r"\$"), fontsize=10)
    axes.spines[["top", "right"]].set_visible(False)
    if transfer is not None and transfer.gradients is None:
        draw_curve(axes, transfer, (edges[0], edges[-1]))


def draw_gradients(axes, summary, transfer=None):
    """Draw the joint histogram, over it what a function shows in its colours, with lines of A."""
    unit = f" per {summary.unit}" if summary.unit else ""
    axes.set(xlabel="value", ylabel=f"gradient magnitude{unit}")
    if not summary.joint.max() > 0 or summary.least == summary.largest:
        return
    reach = (summary.least, summary.largest, 0, summary.steepest or 1)
    drawn = axes.imshow(
        np.ma.masked_equal(summary.joint, 0),
        norm=LogNorm(1, max(int(summary.joint.max()), 2)),
        origin="lower",
        extent=reach,
        aspect="auto",
        cmap="viridis",
    )
    axes.figure.colorbar(drawn, ax=axes, label="voxels")
    if transfer is not None:
        draw_function(axes, transfer, reach)
