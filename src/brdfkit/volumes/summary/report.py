"""A `VolumeSummary` in words: the rows and sentences that `brdfkit info VOLUME` prints."""

import numpy as np

from brdfkit.volumes.summary import histograms
from brdfkit.volumes.summary.histograms import FEW, PARTS, STEPS, bars, shades

PATIENT = (("left", "right"), ("back", "front"), ("feet", "head"))
WORLD = (("-x", "+x"), ("-y", "+y"), ("-z", "+z"))
LINES = 4  # of the histogram of value × gradient magnitude

# What is beyond is a finding:
UNEVEN = 3.0  # the largest spacing over the smallest
TURNED = 1.0  # degrees
CLIPPED = 0.01  # of the voxels at the largest value


def directions(volume):
    """Where the axes x, y, z of the grid go in the world, in words, and the largest angle to it."""
    axes = volume.to_world[:3, :3] / np.linalg.norm(volume.to_world[:3, :3], axis=0)
    main = np.abs(axes).argmax(axis=0)
    words = PATIENT if volume.axes == "RAS" else WORLD
    named = tuple(words[w][int(axes[w, i] > 0)] for i, w in enumerate(main))
    cosines = np.abs(axes[main, range(3)])
    return named, float(np.degrees(np.arccos(np.clip(cosines.min(), -1, 1))))


def rows(summary):
    """What is in the volume: texts by heading."""
    unit = f" {summary.unit}" if summary.unit else " (no unit is told)"
    turned = f"; turned by {summary.turned:.1f}°" if summary.turned > TURNED else ""
    corners = zip(summary.low, summary.high, strict=True)
    values = summary.data.values
    found = {
        "size": f"{_times(summary.size)} voxels of {summary.kind}, {values.nbytes / 1e6:,.4g} MB",
        "spacing": f"{_times(summary.spacing)}{unit}",
        "axes": f"{_arrows(summary.directions)}{turned}",
        "box": ", ".join(f"{low:.6g} to {high:.6g}" for low, high in corners),
        "values": f"{summary.least:.6g} to {summary.largest:.6g}, mean {summary.mean:.4g}, "
        f"median {summary.median:.4g}",
        "histogram": f"|{bars(np.array(summary.counts))}| logarithmic",
    }
    if summary.labels:
        return found | {"labels": f"{summary.different}, never interpolated"}
    steps = summary.joint.reshape(LINES, STEPS // LINES, PARTS).sum(axis=1)
    for i in reversed(range(LINES)):
        reach = f"{i / LINES * summary.steepest:.3g} to {(i + 1) / LINES * summary.steepest:.3g}"
        found[f"gradients {reach}"] = f"|{shades(steps[i])}|"
    return found


def findings(summary):
    """What is doubtful: a sentence on each finding."""
    found = []
    if not summary.labels and 0 < summary.different <= FEW:
        found.append(
            f"only {summary.different} different values, all whole: perhaps labels, which are not "
            "to be interpolated; load it with labels=True (--labels)"
        )
    ratio = max(summary.spacing) / min(summary.spacing)
    if ratio > UNEVEN:
        found.append(f"voxels are {ratio:.3g} times as long as wide: details differ by direction")
    share = float((summary.data.values == summary.data.values.max()).mean())
    if summary.different > FEW and share > CLIPPED:
        found.append(f"{100 * share:.3g} % of the voxels have the largest value: perhaps clipped")
    if summary.least == summary.largest:
        found.append("of one value all over")
    return tuple(found)


def may_be_labels(volume):
    """Whether a volume, which does not say so, has few values, all whole by type."""
    return not volume.labels and 0 < histograms.different(volume.values) <= FEW


def _times(numbers):
    return " × ".join(f"{n:.6g}" for n in numbers)


def _arrows(names):
    return ", ".join(f"{axis} → {name}" for axis, name in zip("xyz", names, strict=True))
