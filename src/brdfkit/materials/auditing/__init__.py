"""`audit` examines a measurement: its coverage, its noise, and doubtful values.

`noise.py`, `spikes.py` and `albedos.py` compute what their names say. `ratios.py` compares the
brightness near the light and at the horizon with other directions, `symmetries.py` compares values
that should be equal, and `cosine.py` and `azimuth.py` recognise other conventions of instruments.
`subsets.py` draws a part of large measurements. `picture.py` draws the audit, and `report.py`
describes it in words. `data_findings.py` has the findings that both audits and fits show.
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
from brdfkit.materials.auditing.ratios import (
    compute_backward_ratio,
    compute_grazing_ratio,
    compute_retroreflection_ratio,
)
from brdfkit.materials.auditing.report import describe_audit, list_findings
from brdfkit.materials.auditing.spikes import Spike, find_spikes
from brdfkit.materials.auditing.subsets import draw_samples
from brdfkit.materials.auditing.symmetries import (
    Difference,
    compare_mirrored_values,
    compare_reciprocal_values,
)
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.coverage import Coverage, compute_coverage, is_in_plane
from brdfkit.materials.measured.evidence import find_measured_rows
from brdfkit.materials.measured.spectrum_to_rgb import to_rgb_or_mean
from brdfkit.materials.resolve import MaterialLike, to_measured
from brdfkit.model.samples import Samples

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MAX_ANGLE = 80.0  # degrees; by default a fit uses only samples with smaller angles to the normal
DPI, WIDTH = 75, 760  # resolution [pixels per inch] and width [pixels] of a notebook's picture
MOST_LISTED_ANGLES = 10  # largest number of measured angles that an audit lists one by one


@dataclass(frozen=True, repr=False)
class Audit(Shown):
    """The result of `audit`, which prints as text. Numbers that are unknown are NaN.

    Attributes
    ----------
    name : str
        Name of the material.
    shape : tuple of int or None
        Numbers of cells of a table; None for samples.
    channels : tuple of str
        Names of the channels of the values.
    size, above, valid, used : int
        Number of all cells or samples; number of those with both directions above the horizon;
        number of valid ones; number of those that a fit uses by default, with both angles to the
        normal below 80°.
    negative, zero : int
        Number of valid values below 0, and of those equal to 0, in all channels.
    negative_from, negative_to : float
        Two angles to the normal [degrees]: 9 of 10 negative values have a larger angle than the
        first one, and 9 of 10 a smaller angle than the second one, where the angle is that of the
        light or the view, whichever is larger. NaN without negative values.
    theta_i, theta_o : tuple of float
        The measured angles to the normal [degrees] of light and view; if there are more than 10,
        only the smallest and the largest.
    smallest, median, largest : float
        The smallest valid value above 0, the median of the valid values, and the largest [sr⁻¹].
    coverage : Coverage
        The share of all pairs of directions that was measured.
    in_plane : bool
        Whether all samples lie in the plane of incidence.
    reciprocity, mirror : Difference
        The differences between values that should be equal: after exchanging light and view, and on
        both sides of the plane of incidence.
    noise : Noise
        The relative noise of the values.
    albedo, albedo_of_samples : Albedo
        The directional albedo at several angles of incidence. The first one is computed from the
        interpolated BRDF, the second one from the samples alone, None where it is not known.
    grazing, retroreflection, backwards : float
        Median values near the horizon, and near the light, relative to other directions, as
        `brdfkit.materials.auditing.ratios` computes them.
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
        """The kind of data in words: "90×90×180 table", "samples" or "anisotropic samples"."""
        return str(self.data.kind)

    def rows(self) -> dict[str, str]:
        """Return the results of the audit in words, as a dictionary from headings to texts."""
        return describe_audit(self)

    def findings(self) -> tuple[str, ...]:
        """Return a sentence on each doubtful property of the measurement."""
        return tuple(map(str, list_findings(self)))

    def picture(self) -> Figure:
        """Draw a slice of the BRDF's table, its polar plots and its albedo with matplotlib.

        >>> audit(load("paint.astm")).picture().savefig("paint.png")    # doctest: +SKIP
        """
        # Import the drawing, and so matplotlib, only when it is needed, because this takes long
        from brdfkit.materials.auditing.picture import draw_audit

        return draw_audit(self)

    def document(self) -> Document:
        """Return the audit as a document for notebooks: its picture, results and findings."""
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
        """Draw the picture, and return it as the bytes of a PNG file."""
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
        The audit, which prints as text. `findings()` returns warnings, and `picture()` a matplotlib
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
    negative_from, negative_to = _locate_negative_values(samples)
    theta_i, theta_o = (
        _list_measured_angles(data, samples.wi),
        _list_measured_angles(data, samples.wo),
    )
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
        reciprocity=compare_reciprocal_values(data),
        mirror=compare_mirrored_values(data),
        noise=estimate_noise(data),
        albedo=compute_albedo(coloured, theta_i[-1]),
        albedo_of_samples=compute_sample_albedo(coloured),
        grazing=compute_grazing_ratio(part),
        retroreflection=compute_retroreflection_ratio(part),
        backwards=compute_backward_ratio(part),
        spikes=find_spikes(data),
        data=data,
    )


def _locate_negative_values(samples: Samples) -> tuple[float, float]:
    """Return two angles to the normal [degrees] between which most negative values lie.

    9 of 10 are above the first angle, and 9 of 10 below the second. The larger angle of each pair
    of directions counts. Both are NaN where no value is negative.
    """
    below = samples.valid[:, None] & (samples.values < 0)
    cosines = np.minimum(samples.wi[:, 2], samples.wo[:, 2])
    angles = np.repeat(np.degrees(np.arccos(np.clip(cosines, -1, 1))), below.sum(axis=1))
    return tuple(np.percentile(angles, (10, 90)).tolist()) if angles.size else (np.nan, np.nan)


def _list_measured_angles(data: Measured, w: FloatArray) -> tuple[float, ...]:
    """Return the angles to the normal [degrees] of the valid samples' directions `w` (n, 3).

    They are ascending. For a table, and for many angles, only the smallest and the largest are
    returned; of a completed table those of its measured cells.
    """
    cosines = w[find_measured_rows(data), 2]
    if data.is_table:
        cosines = np.array([cosines.max(), cosines.min()])
    angles = np.unique(np.degrees(np.arccos(np.clip(cosines, -1, 1))).round(1))
    return tuple((angles if len(angles) <= MOST_LISTED_ANGLES else angles[[0, -1]]).tolist())
