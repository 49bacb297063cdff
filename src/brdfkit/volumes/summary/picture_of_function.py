"""Draws a transfer function over the histograms of a volume: what shows of its voxels, and how."""

import numpy as np

from brdfkit.core.colours import to_srgb
from brdfkit.volumes.transfer.windows import scale_to_values

POINTS = 400  # along each axis
LEVELS = 0.01, 0.25, 0.5, 0.75  # of A, as lines
VEIL = 0.85  # opacity of the colours where A is 1


def for_volume(transfer, volume):
    """The function with the volume's values and its unit of length, as renderers have it."""
    transfer = scale_to_values(transfer, volume.values)
    return transfer.per(volume.unit) if volume.unit and transfer.length_unit else transfer


def draw_curve(axes, transfer, reach):
    """Draw A of a function of values from 0 to 1, on an axis of its own, over its colours."""
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


def draw_function(axes, transfer, reach):
    """Draw the colours of a function where it shows, and lines of A, over values × gradients."""
    low, high, _, steepest = reach
    values, gradients = np.linspace(low, high, POINTS), np.linspace(0, steepest, POINTS)
    if transfer.gradients is None:
        rgba = np.broadcast_to(transfer(values), (POINTS, POINTS, 4))
    else:
        rgba = transfer(values, gradients[:, None])
    colours = to_srgb(np.clip(rgba[..., :3], 0, 1))
    shown = np.dstack([colours, VEIL * rgba[..., 3]])
    axes.imshow(shown, origin="lower", extent=reach, aspect="auto", zorder=2)
    lines = axes.contour(
        values, gradients, rgba[..., 3], LEVELS, colors="black", linewidths=0.7, zorder=3
    )
    axes.clabel(lines, fmt="A = %g", fontsize=7)
    axes.set_title(transfer.name.replace("$", r"\$"), fontsize=10)
