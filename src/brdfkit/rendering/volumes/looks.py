"""What a volume looks like if nobody says: its transfer function, its surface, its material."""

from dataclasses import replace

import numpy as np

from brdfkit.core.colours import from_srgb
from brdfkit.volumes.transfer import windows
from brdfkit.volumes.transfer.transfer_function import TransferFunction

AIR, TISSUE = -900, 200  # HU: a scan of computed tomography reaches below and above them
BODY, BONE, BONY = -500, 250, 0.002  # HU, and the share of a body that is bone, at least
# Mean free paths across what shows, where it is densest
GLOWING, DENSE, OPAQUE = 10, 50, 400
RAMP = [(0, 0), (1, 1)]  # share of the window, A
# Of the largest values along rays: their percentiles are the nodes of the greys, which are halfway
# from even shares of the window to even shares of the rays, so that every part has its contrast
NODES = (2, 10, 30, 50, 70, 90, 99.8)
DARKEST = 0.1
LEVELS = 256  # of the histogram by which a surface is found
CLAY = {
    "type": "roughplastic",
    "alpha": 0.25,
    "diffuse_reflectance": {"type": "rgb", "value": [0.72, 0.6, 0.5]},
}


def transfer_function(volume, renderer):
    """The `TransferFunction` of a volume for a renderer.

    A colour for each label. Else, for renderers without light, a colour map that glows. Else for
    scans in HU the preset ct_bone, or ct_skin where there is no bone, for others of patients
    mri_head, and for all others a colour map of light colours. All but those in HU are of the
    volume's window, and as dense as its matter is large.
    """
    from_colormap = TransferFunction.from_colormap
    if volume.labels:
        return _labels(volume, OPAQUE / float(np.ptp(volume.bounds, axis=0).max()))
    if renderer == "maximum_intensity":
        return _of_largest_values(volume, "gray" if volume.axes else "inferno")
    if renderer == "emission_absorption":
        return from_colormap(
            "magma", volume.window, opacity=RAMP, extinction=GLOWING / _across(volume)
        )
    low, high = volume.range
    if volume.axes and low < AIR and high > TISSUE:
        values = windows.sample_values(volume.values)
        bony = (values > BONE).sum() > BONY * (values > BODY).sum()
        return TransferFunction.load("ct_bone" if bony else "ct_skin")
    if volume.axes:
        found = TransferFunction.load("mri_head").scaled_to(*volume.window)
        return replace(found, extinction=DENSE / _across(volume), length_unit="")
    density = DENSE / _across(volume)
    return from_colormap(
        "RdYlBu_r", volume.window, opacity=RAMP, extinction=density, colour="albedo"
    )


def _across(volume):
    """The longest edge, along the axes of the grid, of the box about what the window shows."""
    longest = 0.0
    for axis, (n, step) in enumerate(zip(volume.values.shape, volume.spacing[::-1], strict=True)):
        others = tuple(k for k in range(3) if k != axis)
        there = np.flatnonzero(volume.values.max(axis=others) > volume.window[0])
        longest = max(longest, step * (np.ptp(there) + 1 if len(there) else n))
    return longest


def _of_largest_values(volume, colours):
    """The function for maximum intensity, by the largest values along the axes of the grid."""
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


def _labels(volume, extinction):
    """The colours of Matplotlib's tab20 in turn; 0 is nothing, and lets everything through."""
    import matplotlib as mpl

    labels = np.union1d(np.unique(volume.values), [0, 1])
    colours = np.array(mpl.colormaps["tab20"].colors)
    rgba = np.column_stack([from_srgb(colours[(labels - 1) % len(colours)]), labels > 0])
    return TransferFunction(labels, rgba, extinction, name="a colour for each label")


def shows(transfer, level):
    """The function (volume, k) → which of every k-th voxel along each axis show, by a transfer
    function or by a level."""

    def found(volume, k):
        every = np.s_[::k, ::k, ::k]
        if transfer is None:
            return volume.values[every] > level
        places = [volume.values[every]]
        if transfer.gradients is not None:
            places.append(volume.gradient_magnitude[every])
        return transfer(*places)[..., 3] > level

    return found


def level(volume):
    """The value of the surface to show; of labels all but 0 are within.

    The one that parts the values in two of which the means are farthest apart, by the variance
    between them [Otsu 1979].
    """
    low, high = volume.range
    if volume.labels or low == high:
        return 0.5 * (1 if volume.labels else high)
    values = windows.sample_values(volume.values)
    # outliers would leave but a few parts to all others
    values = values[
        (values >= np.percentile(values, 0.1)) & (values <= np.percentile(values, 99.9))
    ]
    counts, edges = np.histogram(values, LEVELS)
    below = np.cumsum(counts)[:-1]
    sums = np.cumsum(counts * (edges[1:] + edges[:-1]) / 2)
    difference = sums[-1] / values.size * below - sums[:-1]  # of the means, times shares
    return float(edges[1:-1][np.argmax(difference**2 / (below * (values.size - below)))])
