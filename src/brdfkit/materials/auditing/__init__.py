"""`audit`: what a measurement covers, how noisy it is and what is doubtful.

One file answers one question: `noise.py`, `spikes.py`, `albedos.py`, `ratios.py` (brightness near
the light and at the horizon), `cosine.py` and `azimuth.py` (other conventions). `symmetries.py`
compares samples that should be equal, `subsets.py` draws a part of large measurements, `picture.py`
draws the audit, `report.py` describes it in sentences, and `data_findings.py` has the sentences
that a fit shows, too.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from brdfkit.core.array_types import FloatArray
from brdfkit.core.documents import Document, Paragraph, Picture, Shown, Table
from brdfkit.core.documents.parts import BAD
from brdfkit.materials.auditing.albedos import Albedo, compute_albedo, compute_sample_albedo
from brdfkit.materials.auditing.noise import Noise, estimate_noise
from brdfkit.materials.auditing.ratios import backward_ratio, grazing_ratio, retroreflection_ratio
from brdfkit.materials.auditing.report import describe_audit, list_findings
from brdfkit.materials.auditing.spikes import Spike, find_spikes
from brdfkit.materials.auditing.subsets import draw_samples
from brdfkit.materials.auditing.symmetries import Difference, compare_mirrored, compare_reciprocal
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.coverage import Coverage, compute_coverage, is_in_plane
from brdfkit.materials.measured.spectrum_to_rgb import to_rgb_or_mean
from brdfkit.materials.resolve import MaterialLike, to_measured
from brdfkit.model.samples import Samples

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MAX_ANGLE = 80.0  # degrees: a fit uses smaller angles by default
DPI, WIDTH = 75, 760  # of the picture in a notebook
MOST_LISTED_ANGLES = 10  # of more, the smallest and the largest are given


@dataclass(frozen=True, repr=False)
class Audit(Shown):
    """The audit of a measurement, made by `audit`; prints as text. NaN stands for unknown numbers.

    Attributes
    ----------
    name : str
        Name of the material.
    shape : tuple of int or None
        Cells of a table; None for samples.
    channels : tuple of str
        Names of the columns of the values.
    size, above, valid, used : int
        Number of cells or samples; of these, how many are above the horizon, how many are valid,
        and how many a fit uses by default (both angles below 80°).
    negative, zero : int
        Number of valid values below 0 and equal to 0, in all channels.
    negative_from, negative_to : float
        Angles to the normal [degrees] of light or view, whichever is larger: 9 of 10 negative
        values are above the first angle, 9 of 10 below the second; nan without negative values.
    theta_i, theta_o : tuple of float
        The measured angles to the normal [degrees]; of many, the smallest and the largest.
    smallest, median, largest : float
        The smallest valid value above 0, the median and the largest one [sr⁻¹].
    coverage : Coverage
        The share of all direction pairs that was measured.
    in_plane : bool
        Whether it was measured in the plane of incidence only.
    reciprocity, mirror : Difference
        The differences between values that should be equal: with the directions exchanged, and
        left and right.
    noise : Noise
        The relative noise of the values.
    albedo, albedo_of_samples : Albedo
        The albedo over the angle of incidence: by the lookup, and of the samples alone.
    grazing, retroreflection, backwards : float
        Three ratios of medians: see `brdfkit.materials.auditing.ratios`.
    spikes : tuple of Spike
        Values far above all their neighbours.
    data : Measured
        The material.
    """

    name: str
    shape: tuple[int, ...] | None
    channels: tuple[str, ...]
    size: int
    above: int
    valid: int
    used: int
    negative: int
    zero: int
    negative_from: float
    negative_to: float
    theta_i: tuple[float, ...]
    theta_o: tuple[float, ...]
    smallest: float
    median: float
    largest: float
    coverage: Coverage
    in_plane: bool
    reciprocity: Difference
    mirror: Difference
    noise: Noise
    albedo: Albedo
    albedo_of_samples: Albedo | None
    grazing: float
    retroreflection: float
    backwards: float
    spikes: tuple[Spike, ...]
    data: Any = field(repr=False, compare=False)

    @property
    def kind(self) -> str:
        """The kind in words: "90×90×180 table", "samples" or "anisotropic samples"."""
        return str(self.data.kind)

    def rows(self) -> dict[str, str]:
        """Return the audit in words, by heading."""
        return describe_audit(self)

    def findings(self) -> tuple[str, ...]:
        """Return sentences on what is doubtful."""
        return list_findings(self)

    def picture(self) -> Figure:
        """Draw a slice of the BRDF, its lobes and its albedo, as a matplotlib `Figure`.

        >>> audit(load("paint.astm")).picture().savefig("paint.png")    # doctest: +SKIP
        """
        from brdfkit.materials.auditing.picture import draw_audit  # only here: matplotlib is slow

        return draw_audit(self)

    def document(self) -> Document:
        """Return the audit as a document: the picture, the rows and the findings."""
        caption = f"{self.name}: a slice of the table, the lobes and the albedo"
        return Document(
            self.name,
            (
                Picture(self._draw_png, caption, WIDTH),
                Table(tuple(self.rows().items())),
                *(Paragraph(finding, BAD) for finding in self.findings()),
            ),
        )

    def _draw_png(self) -> bytes:
        """Draw the picture as the bytes of a PNG file."""
        from brdfkit.core.figures import to_png

        return to_png(self.picture(), DPI)


def audit(material: MaterialLike) -> Audit:
    """Audit a measured material: its coverage, its noise, and doubtful values.

    Parameters
    ----------
    material : Measured, str or Path
        The measured material, or its name or path.

    Returns
    -------
    Audit
        The audit, which prints as text; `findings()` are its doubts, `picture()` is a matplotlib
        `Figure`.

    Raises
    ------
    BrdfkitError
        For a material that was not measured.

    Examples
    --------
    >>> print(audit("copper.astm"))    # doctest: +SKIP
    """
    data = to_measured(material)
    samples, part = data.samples, draw_samples(data)
    above = (samples.wi[:, 2] > 0) & (samples.wo[:, 2] > 0)
    values = samples.values[samples.valid]
    positive = values[values > 0]
    negative_from, negative_to = _locate_negative(samples)
    theta_i, theta_o = _list_angles(data, samples.wi), _list_angles(data, samples.wo)
    coloured = to_rgb_or_mean(data)
    return Audit(
        name=data.name,
        shape=data.table.shape if data.is_table else None,
        channels=data.channels,
        size=len(above),
        above=int(above.sum()),
        valid=len(values),
        used=int(samples.within(MAX_ANGLE).sum()),
        negative=int((values < 0).sum()),
        zero=int((values == 0).sum()),
        negative_from=negative_from,
        negative_to=negative_to,
        theta_i=theta_i,
        theta_o=theta_o,
        smallest=float(positive.min()) if positive.size else np.nan,
        median=float(np.median(values)),
        largest=float(values.max()),
        coverage=compute_coverage(data),
        in_plane=is_in_plane(part),
        reciprocity=compare_reciprocal(data),
        mirror=compare_mirrored(data),
        noise=estimate_noise(data),
        albedo=compute_albedo(coloured, theta_i[-1]),
        albedo_of_samples=compute_sample_albedo(coloured),
        grazing=grazing_ratio(part),
        retroreflection=retroreflection_ratio(part),
        backwards=backward_ratio(part),
        spikes=find_spikes(data),
        data=data,
    )


def _locate_negative(samples: Samples) -> tuple[float, float]:
    """Return the angles to the normal [degrees] above and below which 9 of 10 negative values are.

    The larger angle of each pair counts. They are nan where no value is negative.
    """
    below = samples.valid[:, None] & (samples.values < 0)
    cosines = np.minimum(samples.wi[:, 2], samples.wo[:, 2])
    angles = np.repeat(np.degrees(np.arccos(np.clip(cosines, -1, 1))), below.sum(axis=1))
    return tuple(np.percentile(angles, (10, 90)).tolist()) if angles.size else (np.nan, np.nan)


def _list_angles(data: Measured, w: FloatArray) -> tuple[float, ...]:
    """Return the angles to the normal [degrees] of the valid directions `w` (n, 3), ascending.

    For a table, and for many angles, they are only the smallest and the largest.
    """
    cosines = w[data.samples.valid, 2]
    if data.is_table:
        cosines = np.array([cosines.max(), cosines.min()])
    angles = np.unique(np.degrees(np.arccos(np.clip(cosines, -1, 1))).round(1))
    return tuple((angles if len(angles) <= MOST_LISTED_ANGLES else angles[[0, -1]]).tolist())
