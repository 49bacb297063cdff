"""What a volume looks like if nobody says: its transfer function, its surface, its material."""

from dataclasses import replace

import numpy as np

from brdfkit.colours import from_srgb
from brdfkit.volumes.transfer_function import TransferFunction

AIR, TISSUE = -900, 200  # HU: a scan of computed tomography reaches below and above them
# Mean free paths across a volume, where it is densest
GLOWING, DENSE, OPAQUE = 10, 40, 400
RAMP = [(0, 0), (0.1, 0), (1, 1)]  # share of the range, A
BRIGHTEST = 99.9  # percentile: a few bright voxels should not hide a scan
LEVELS = 256  # of the histogram by which a surface is found
CLAY = {
    "type": "roughplastic",
    "alpha": 0.25,
    "diffuse_reflectance": {"type": "rgb", "value": [0.72, 0.6, 0.5]},
}


def transfer_function(volume, renderer):
    """The `TransferFunction` of a volume for a renderer.

    A colour for each label. Else, for renderers without light, a colour map that glows. Else for
    scans in HU the preset ct_bone, for others of patients mri_head, and for all others a colour map
    of light colours.
    """
    low, high = volume.range
    if low == high:
        low, high = min(low, 0.0), max(high, 0.0)
    across = float(np.ptp(volume.bounds, axis=0).max())
    from_colormap = TransferFunction.from_colormap
    if volume.labels:
        return _labels(volume, OPAQUE / across)
    if renderer == "maximum_intensity":
        colours = "gray" if volume.axes else "inferno"
        return from_colormap(colours, (low, high), [(0, 0), (0.25, 1), (1, 1)])
    if renderer == "emission_absorption":
        return from_colormap("magma", (low, high), RAMP, GLOWING / across)
    if volume.axes and low < AIR and high > TISSUE:
        return TransferFunction.load("ct_bone")
    if volume.axes:
        brightest = float(np.percentile(volume.values, BRIGHTEST))
        return TransferFunction.load("mri_head").scaled_to(low, max(brightest, (low + high) / 2))
    return from_colormap("RdYlBu_r", (low, high), RAMP, DENSE / across, "albedo")


def _labels(volume, extinction):
    """The colours of Matplotlib's tab20 in turn; 0 is nothing, and lets everything through."""
    import matplotlib as mpl

    labels = np.union1d(np.unique(volume.values), [0, 1])
    colours = np.array(mpl.colormaps["tab20"].colors)
    rgba = np.column_stack([from_srgb(colours[(labels - 1) % len(colours)]), labels > 0])
    return TransferFunction(labels, rgba, extinction, name="a colour for each label")


def shows(transfer, level):
    """The function (values) → whether they show, of a transfer function or of a level."""
    if transfer is None:
        return lambda values: values > level
    if transfer.gradients is None:
        return lambda values: transfer(values)[..., 3] > level
    largest = replace(transfer, rgba=transfer.rgba.max(axis=0), gradients=None)
    return shows(largest, level)


def level(volume):
    """The value of the surface to show; of labels all but 0 are within.

    The one that parts the values in two of which the means are farthest apart, by the variance
    between them [Otsu 1979].
    """
    low, high = volume.range
    if volume.labels or low == high:
        return 0.5 * (1 if volume.labels else high)
    counts, edges = np.histogram(volume.values, LEVELS)
    below = np.cumsum(counts)[:-1]
    sums = np.cumsum(counts * (edges[1:] + edges[:-1]) / 2)
    difference = sums[-1] / volume.values.size * below - sums[:-1]  # of the means, times shares
    return float(edges[1:-1][np.argmax(difference**2 / (below * (volume.values.size - below)))])
