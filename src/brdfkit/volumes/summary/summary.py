"""`summarise`: what is in a volume, which way it lies, and what is doubtful: `brdfkit info`."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.documents import Document, Paragraph, Picture, Shown, Table
from brdfkit.core.documents.parts import BAD
from brdfkit.volumes.summary import histograms, report
from brdfkit.volumes.transfer.transfer_function import TransferFunction
from brdfkit.volumes.volume import Volume

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DPI, WIDTH = 75, 760  # of the picture in a notebook


@dataclass(frozen=True, repr=False)
class VolumeSummary(Shown):
    """What is in a volume; prints as text. Made by `summarise`.

    Attributes
    ----------
    name : str
        The volume's.
    size : tuple of int
        Voxels along x, y, z.
    spacing : tuple of float
        From voxel to voxel along x, y, z.
    unit : str
        The unit of length; empty where the file tells none.
    directions : tuple of str
        Where x, y and z of the grid go in the world: "right", "front", "+x" ...
    turned : float
        The largest angle between an axis of the grid and the world's axis next to it [degrees].
    low, high : tuple of float
        The corners of the box.
    kind : str
        The type of the values.
    labels : bool
        Whether they are labels.
    least, largest, mean, median : float
        Of the values.
    different : int
        How many different values there are, of whole numbers; 0 of others.
    counts : tuple of int
        How many voxels are in each of equal parts of the range.
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
    data: Any = field(repr=False, compare=False)

    @cached_property
    def joint(self) -> NDArray[np.int64]:
        """How many voxels have which gradient magnitude and value: (m, n), both from the least."""
        return histograms.joint(self.data, self.steepest)

    def rows(self) -> dict[str, str]:
        """The summary in words, by heading."""
        return report.rows(self)

    def findings(self) -> tuple[str, ...]:
        """Sentences on what is doubtful."""
        return report.findings(self)

    def picture(self, transfer: TransferFunction | None = None) -> "Figure":
        """Three slices through the middle, and the histograms of value, and of value × gradient,
        over which a transfer function is drawn.

        >>> summarise(volumes.load("smoke")).picture().savefig("smoke.png")    # doctest: +SKIP
        """
        from brdfkit.volumes.summary.picture import picture  # only here: matplotlib is slow to load

        return picture(self, transfer)

    def document(self) -> Document:
        """What is in the volume, which way it lies, and what is doubtful."""
        return Document(
            self.name,
            (
                Picture(self._draw, f"{self.name}: three slices and two histograms", WIDTH),
                Table(tuple(self.rows().items())),
                *(Paragraph(finding, BAD) for finding in self.findings()),
            ),
        )

    def _draw(self):
        from brdfkit.core.figures import to_png  # only here: it imports matplotlib

        return to_png(self.picture(), DPI)


def summarise(volume: Volume) -> VolumeSummary:
    """What is in a volume, which way it lies, and what is doubtful.

    >>> summarise(volumes.load("slab")).directions
    ('+x', '+y', '+z')
    """
    values, (low, high) = volume.values, volume.bounds
    directions, turned = report.directions(volume)
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
        different=histograms.different(values),
        counts=tuple(histograms.counts(volume).tolist()),
        steepest=float(volume.gradient_magnitude.max()),
        data=volume,
    )
