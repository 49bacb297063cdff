"""`summarise` describes a volume, its orientation and its likely defects, for `brdfkit info`."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from brdfkit.core.array_types import IntArray
from brdfkit.core.documents import Document, Paragraph, Picture, Shown, Table
from brdfkit.core.documents.parts import BAD
from brdfkit.volumes.orientation import find_nearest_axes, name_ends
from brdfkit.volumes.summary import histograms
from brdfkit.volumes.summary.histograms import (
    FEW_VALUES,
    PARTS,
    SAMPLED_VOXELS,
    STEPS,
    format_bars,
    format_shades,
)
from brdfkit.volumes.transfer.transfer_function import TransferFunction
from brdfkit.volumes.volume import Volume

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LINES = 4  # lines of text for the histogram of values and gradient magnitudes
UNEVEN_SPACING = 3.0  # a larger ratio of the largest spacing to the smallest is a defect
TURNED_DEGREES = 1.0  # a larger angle between the axes of grid and world is reported [degrees]
CLIPPED_SHARE = 0.01  # values may be clipped if more than this share of voxels has the largest
DPI, WIDTH = 75, 760  # resolution and width [pixels] of the picture in a notebook


@dataclass(frozen=True, repr=False)
class VolumeSummary(Shown):
    """The properties of a volume, which print as text; `summarise` makes it.

    Attributes
    ----------
    name : str
        The volume's name.
    size : tuple of int
        Numbers of voxels along x, y, z.
    spacing : tuple of float
        Distances between voxels along x, y, z.
    unit : str
        The unit of length; empty if it is unknown.
    directions : tuple of str
        Where the axes x, y and z of the grid point in the world: "right", "front", "+x" ...
    turned : float
        The largest angle between an axis of the grid and the nearest axis of the world [degrees].
    low, high : tuple of float
        The corners of the box.
    kind : str
        The type of the values.
    labels : bool
        Whether the values are labels.
    least, largest, mean, median : float
        Smallest, largest, mean and median value.
    different : int
        Number of different values, if they are of integer type; otherwise 0.
    counts : tuple of int
        Histogram of the values: the numbers of voxels in equal bins of their range.
    steepest : float
        The largest gradient magnitude.
    data : Volume
        The volume.
    """

    name: str
    size: tuple[int, ...]
    spacing: tuple[float, ...]
    unit: str
    directions: tuple[str, ...]
    turned: float
    low: tuple[float, ...]
    high: tuple[float, ...]
    kind: str
    labels: bool
    least: float
    largest: float
    mean: float
    median: float
    different: int
    counts: tuple[int, ...]
    steepest: float
    data: Volume = field(repr=False, compare=False)

    @cached_property
    def joint_histogram(self) -> IntArray:
        """The joint histogram (m, n) of gradient magnitudes and values, both from low to high."""
        return histograms.count_voxels_by_gradient(self.data, self.steepest)

    def rows(self) -> dict[str, str]:
        """Return the lines of the summary's text as {heading: text}."""
        unit = f" {self.unit}" if self.unit else " (unknown unit)"
        turned = f"; turned by {self.turned:.1f}°" if self.turned > TURNED_DEGREES else ""
        corners = zip(self.low, self.high, strict=True)
        values = self.data.values
        rows = {
            "size": f"{_format_size(self.size)} voxels of {self.kind}, "
            f"{values.nbytes / 1e6:,.4g} MB",
            "spacing": f"{_format_size(self.spacing)}{unit}",
            "axes": f"{_format_directions(self.directions)}{turned}",
            "box": ", ".join(f"{low:.6g} to {high:.6g}" for low, high in corners),
            "values": f"{self.least:.6g} to {self.largest:.6g}, mean {self.mean:.4g}, "
            f"median {self.median:.4g}",
            "histogram": f"|{format_bars(np.array(self.counts))}| logarithmic",
        }
        if self.labels:
            return rows | {"labels": f"{self.different} different ones, never interpolated"}
        steps = self.joint_histogram.reshape(LINES, STEPS // LINES, PARTS).sum(axis=1)
        for i in reversed(range(LINES)):
            reach = f"{i / LINES * self.steepest:.3g} to {(i + 1) / LINES * self.steepest:.3g}"
            rows[f"gradients {reach}"] = f"|{format_shades(steps[i])}|"
        return rows

    def findings(self) -> tuple[str, ...]:
        """Return a sentence for each likely defect of the volume."""
        sentences = []
        if not self.labels and 0 < self.different <= FEW_VALUES:
            sentences.append(
                f"only {self.different} different values, all whole: perhaps labels, which must "
                "not be interpolated; then load it with labels=True (--labels)"
            )
        ratio = max(self.spacing) / min(self.spacing)
        if ratio > UNEVEN_SPACING:
            sentences.append(
                f"voxels are {ratio:.3g} times as long as wide: resolution depends on the direction"
            )
        share = float((self.data.values == self.data.values.max()).mean())
        if self.different > FEW_VALUES and share > CLIPPED_SHARE:
            sentences.append(
                f"{100 * share:.3g} % of the voxels have the largest value: perhaps clipped"
            )
        if self.least == self.largest:
            sentences.append("all voxels have the same value")
        return tuple(sentences)

    def picture(self, transfer: TransferFunction | None = None) -> "Figure":
        """Draw three slices through the middle, a histogram of values, and one with gradients.

        A transfer function is drawn over the histograms.

        >>> summarise(volumes.load("smoke")).picture().savefig("smoke.png")    # doctest: +SKIP
        """
        from brdfkit.volumes.summary.picture import draw_summary  # imports matplotlib: slow

        return draw_summary(self, transfer)

    def document(self) -> Document:
        """Return the summary with its picture as a `Document`, for terminals and notebooks."""
        return Document(
            self.name,
            (
                Picture(self._draw_png, f"{self.name}: three slices and two histograms", WIDTH),
                Table(tuple(self.rows().items())),
                *(Paragraph(finding, BAD) for finding in self.findings()),
            ),
        )

    def _draw_png(self) -> bytes:
        """Return the picture as the bytes of a PNG file."""
        from brdfkit.core.figures import to_png  # imports matplotlib: slow

        return to_png(self.picture(), DPI)


def summarise(volume: Volume) -> VolumeSummary:
    """Return the `VolumeSummary` of a volume, with its statistics and orientation.

    >>> summarise(volumes.load("slab")).directions
    ('+x', '+y', '+z')
    """
    values, (low, high) = volume.values, volume.bounds
    directions, turned = find_axis_directions(volume)
    return VolumeSummary(
        name=volume.name,
        size=volume.size,
        spacing=volume.spacing,
        unit=volume.unit,
        directions=directions,
        turned=turned,
        low=tuple(low.tolist()),
        high=tuple(high.tolist()),
        kind=str(values.dtype),
        labels=volume.labels,
        least=volume.range[0],
        largest=volume.range[1],
        mean=float(values.mean(dtype=float)),
        median=float(np.median(values)),
        different=histograms.count_different_values(values),
        counts=tuple(histograms.count_voxels_by_value(volume).tolist()),
        steepest=float(volume.gradient_magnitude.max()),
        data=volume,
    )


def find_axis_directions(volume: Volume) -> tuple[tuple[str, ...], float]:
    """Name the direction of the world in which each of the grid's axes points, such as "+x".

    Also returns the largest angle [°] between an axis of the grid and the world's nearest axis.
    """
    axes = volume.to_world[:3, :3] / np.linalg.norm(volume.to_world[:3, :3], axis=0)
    nearest, _ = find_nearest_axes(volume.to_world)
    cosines = np.abs(axes[nearest, range(3)])
    turned = float(np.degrees(np.arccos(np.clip(cosines.min(), -1, 1))))
    return tuple(end for _, end in name_ends(volume)), turned


def may_be_labels(volume: Volume) -> bool:
    """Return whether a volume's values may be labels: few whole numbers, not marked as labels."""
    if volume.labels:
        return False
    some = volume.values.reshape(-1)[:: max(volume.values.size // SAMPLED_VOXELS, 1)]
    return all(
        0 < histograms.count_different_values(values) <= FEW_VALUES
        for values in (some, volume.values)  # of which all voxels of a large volume take long
    )


def _format_size(numbers: Iterable[float]) -> str:
    """Format numbers with × between them, such as the size of a grid."""
    return " × ".join(f"{n:.6g}" for n in numbers)


def _format_directions(names: Iterable[str]) -> str:
    """Format the names of the directions in which the grid's axes point, such as "x → right"."""
    return ", ".join(f"{axis} → {name}" for axis, name in zip("xyz", names, strict=True))
