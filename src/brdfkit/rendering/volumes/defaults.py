"""Chooses a volume's transfer function, surface level and material if the user gives none."""

from dataclasses import replace
from typing import Any

import numpy as np

from brdfkit.core.array_types import BoolArray
from brdfkit.core.colours import from_srgb
from brdfkit.rendering.volumes.camera import VisibilityTest
from brdfkit.volumes import Volume
from brdfkit.volumes.transfer import windows
from brdfkit.volumes.transfer.transfer_function import TransferFunction

AIR, TISSUE = -900, 200  # values [HU]: a scan with values below AIR and above TISSUE is a CT scan
BODY, BONE = -500, 250  # smallest values of the body and of bone [HU]
BONE_SHARE = 0.002  # share of bone in the body, above which bones are shown without the skin
# Optical thickness along a volume's longest edge at the largest extinction: for a volume that
# glows, for a volume in light, and for a volume of labels
GLOWING, DENSE, OPAQUE = 10, 50, 400
RAMP = [(0, 0), (1, 1)]  # opacity that rises linearly over the volume's window of values
# Percentiles of the largest values along rays at which the colours of maximum intensity have nodes.
# A node's position in the colour map is the mean of a position that is linear in the value and one
# of equal steps, so that rare and frequent values both have contrast
NODES = (2, 10, 30, 50, 70, 90, 99.8)
DARKEST = 0.1  # position in the colour map, 0 to 1, of the faintest values above the background
LEVELS = 256  # number of bins of the histogram of values, and of entries of a transfer function
CLAY: dict[str, Any] = {
    "type": "roughplastic",
    "alpha": 0.25,
    "diffuse_reflectance": {"type": "rgb", "value": [0.72, 0.6, 0.5]},
}


def choose_transfer_function(volume: Volume, renderer: str) -> TransferFunction:
    """Choose the transfer function of a volume for a renderer.

    A volume of labels gets a colour for each label. Renderers without light get a colour map that
    glows. CT scans in HU (Hounsfield units) get the preset ct_bone, or ct_skin if there is hardly
    any bone; other scans of patients get mri_head, and all other volumes a colour map of bright
    colours. Except for CT, the function spans the volume's window, and the extinction suits the
    volume's size.
    """
    from_colormap = TransferFunction.from_colormap
    if volume.labels:
        return _make_label_function(volume, OPAQUE / float(np.ptp(volume.bounds, axis=0).max()))
    if renderer == "maximum_intensity":
        return _make_maximum_intensity_function(volume, "gray" if volume.axes else "inferno")
    if renderer == "emission_absorption":
        return from_colormap(
            "magma", volume.window, opacity=RAMP, extinction=GLOWING / _find_longest_edge(volume)
        )
    low, high = volume.range
    if volume.axes and low < AIR and high > TISSUE:
        values = windows.sample_values(volume.values)
        bony = (values > BONE).sum() > BONE_SHARE * (values > BODY).sum()
        return TransferFunction.load("ct_bone" if bony else "ct_skin")
    if volume.axes:
        preset = TransferFunction.load("mri_head").scaled_to(*volume.window)
        return replace(preset, extinction=DENSE / _find_longest_edge(volume), length_unit="")
    density = DENSE / _find_longest_edge(volume)
    return from_colormap(
        "RdYlBu_r", volume.window, opacity=RAMP, extinction=density, colour="albedo"
    )


def _find_longest_edge(volume: Volume) -> float:
    """Return the longest edge [the volume's unit of length] of the box of all visible voxels.

    The extinction is computed from it. Voxels are visible if their values are above the lower end
    of the volume's window, and the box is aligned with the grid.
    """
    longest = 0.0
    for axis, (n, step) in enumerate(zip(volume.values.shape, volume.spacing[::-1], strict=True)):
        others = tuple(k for k in range(3) if k != axis)
        there = np.flatnonzero(volume.values.max(axis=others) > volume.window[0])
        longest = max(longest, step * (np.ptp(there) + 1 if len(there) else n))
    return longest


def _make_maximum_intensity_function(volume: Volume, colours: str) -> TransferFunction:
    """Make the transfer function for pictures of the largest value along each ray.

    `colours` is the name of a colour map of Matplotlib. The colours suit the largest values along
    the rays that are parallel to the three axes of the grid.
    """
    import matplotlib as mpl

    rays = [volume.values.max(axis=axis).ravel() for axis in range(3)]
    end, largest = windows.split_background(np.concatenate(rays).astype(float))
    nodes = np.percentile(largest, NODES)
    if not end < nodes[0] < nodes[-1]:
        return TransferFunction.from_colormap(
            colours, volume.window, opacity=[(0, 0), (0.25, 1), (1, 1)]
        )
    even = np.linspace(DARKEST, 1, len(nodes))
    by_value = DARKEST + (1 - DARKEST) * (nodes - nodes[0]) / (nodes[-1] - nodes[0])
    values = np.linspace(end, nodes[-1], LEVELS)
    shades = np.interp(values, [end, *nodes], [0, *(even + by_value) / 2])
    rgb = from_srgb(mpl.colormaps[colours](shades)[:, :3])
    a = np.clip((values - end) / (nodes[0] - end), 0, 1)
    return TransferFunction(values, np.column_stack([rgb, a]), colour="emission", name=colours)


def _make_label_function(volume: Volume, extinction: float) -> TransferFunction:
    """Make a transfer function with a colour of Matplotlib's tab20 for each label.

    Label 0 means empty space, which is transparent.
    """
    import matplotlib as mpl

    labels = np.union1d(np.unique(volume.values), [0, 1])
    colours = np.array(mpl.color_sequences["tab20"])
    rgba = np.column_stack([from_srgb(colours[(labels - 1) % len(colours)]), labels > 0])
    return TransferFunction(labels, rgba, extinction, name="a colour for each label")


def make_visibility_test(transfer: TransferFunction | None, level: float) -> VisibilityTest:
    """Return a function that finds out which voxels are visible, to place the camera.

    Its arguments are the volume and k; it returns a mask of every k-th voxel along each axis. A
    voxel is visible if its opacity is above `level` or, without a transfer function, its value.
    """

    def is_visible(volume: Volume, k: int) -> BoolArray:
        sampled = np.s_[::k, ::k, ::k]
        if transfer is None:
            return volume.values[sampled] > level
        places = [volume.values[sampled]]
        if transfer.gradients is not None:
            places.append(volume.gradient_magnitude[sampled])
        return transfer(*places)[..., 3] > level

    return is_visible


def choose_surface_level(volume: Volume) -> float:
    """Choose the value of the surface to show; the surface of labels encloses all but label 0.

    It divides the values into the two classes with the largest variance between them [Otsu 1979].
    """
    low, high = volume.range
    if volume.labels or low == high:
        return 0.5 * (1 if volume.labels else high)
    values = windows.sample_values(volume.values)
    # Outliers are left out, because they would leave only a few bins for all other values
    inner = values[(values >= np.percentile(values, 0.1)) & (values <= np.percentile(values, 99.9))]
    if inner.size and np.ptp(inner) > 0:  # unless all other values are equal
        values = inner
    elif np.ptp(values) == 0:  # of few voxels of a large volume
        return (low + high) / 2
    counts, edges = np.histogram(values, LEVELS)
    below = np.cumsum(counts)[:-1]
    sums = np.cumsum(counts * (edges[1:] + edges[:-1]) / 2)
    # For each edge of the histogram as the limit between two classes of values, this is
    # proportional to the difference between the means of the classes
    difference = sums[-1] / values.size * below - sums[:-1]
    return float(edges[1:-1][np.argmax(difference**2 / (below * (values.size - below)))])
