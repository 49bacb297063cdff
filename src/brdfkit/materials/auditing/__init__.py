"""`audit`: what a measurement covers, how noisy it is and what is doubtful.

One file answers one question. Besides, `symmetries.py` finds the samples that should be equal,
`spread.py` takes a part of large measurements, `picture.py` draws the audit, `report.py` tells it
in sentences, and `data_findings.py` has those that a fit tells, too.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from brdfkit.core.documents import Document, Paragraph, Picture, Shown, Table
from brdfkit.core.documents.parts import BAD
from brdfkit.materials.auditing import report
from brdfkit.materials.auditing.albedos import Albedo, albedo, albedo_of_samples
from brdfkit.materials.auditing.grazing_and_retro import backwards, grazing, retroreflection
from brdfkit.materials.auditing.noise import Noise, noise
from brdfkit.materials.auditing.spikes import Spike, spikes
from brdfkit.materials.auditing.spread import some_samples
from brdfkit.materials.auditing.symmetries import Difference, by_mirror, by_reciprocity
from brdfkit.materials.measured.coverage import Coverage, compute_coverage, is_in_plane
from brdfkit.materials.measured.spectrum_to_rgb import to_rgb_or_mean
from brdfkit.materials.resolve import MaterialLike, to_measured

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MAX_ANGLE = 80.0  # degrees: what a fit uses by default
DPI, WIDTH = 75, 760  # of the picture in a notebook
FEW = 10  # up to so many angles are listed one by one


@dataclass(frozen=True, repr=False)
class Audit(Shown):
    """What is in a measurement; prints as text. Made by `audit`. NaN is what it cannot tell.

    Attributes
    ----------
    name : str
        Name of the material.
    shape : tuple of int or None
        Cells of a table; None for samples.
    channels : tuple of str
        What the columns of the values are.
    size, above, valid, used : int
        Number of cells or samples; of these, how many are above the horizon, are valid, and are
        used by a fit as it comes (both angles below 80°).
    negative, zero : int
        Number of valid values below 0 and equal to 0, each channel counted.
    negative_from, negative_to : float
        Angles to the normal [degrees], of light or view, whichever is larger: 9 of 10 negative
        values are above the first, 9 of 10 below the second; nan where there are none.
    theta_i, theta_o : tuple of float
        The measured angles to the normal [degrees], or their ends where they are many.
    smallest, median, largest : float
        Of the valid values [sr⁻¹]; the smallest above 0.
    coverage : Coverage
        Which part of all direction pairs was measured.
    in_plane : bool
        Whether it was measured in the plane of incidence only.
    reciprocity, mirror : Difference
        Between values that should be equal: with the directions exchanged, and left and right.
    noise : Noise
        How much the values scatter.
    albedo, albedo_of_samples : Albedo
        Over the angle of incidence: as it is looked up, and of the samples alone.
    grazing, retroreflection, backwards : float
        Three ratios of medians: see `brdfkit.materials.auditing.grazing_and_retro`.
    spikes : tuple of Spike
        Values far above all around them.
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
        """In words: a 90×90×180 table, samples or anisotropic samples."""
        samples = "anisotropic samples" if self.data.anisotropic else "samples"
        return "×".join(map(str, self.shape)) + " table" if self.shape else samples

    def rows(self) -> dict[str, str]:
        """The audit in words, by heading."""
        return report.rows(self)

    def findings(self) -> tuple[str, ...]:
        """Sentences on what is doubtful."""
        return report.findings(self)

    def picture(self) -> Figure:
        """A slice of the BRDF, its lobes and its albedo, as a matplotlib `Figure`.

        >>> load("paint.astm").audit().picture().savefig("paint.png")    # doctest: +SKIP
        """
        from brdfkit.materials.auditing.picture import picture  # only here: matplotlib is slow

        return picture(self)

    def document(self) -> Document:
        """What was measured and how well, and what is doubtful."""
        says = f"{self.name}: a slice of the table, the lobes and the albedo"
        return Document(
            self.name,
            (
                Picture(self._draw, says, WIDTH),
                Table(tuple(self.rows().items())),
                *(Paragraph(finding, BAD) for finding in self.findings()),
            ),
        )

    def _draw(self):
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
        Prints as text; `findings()` are its doubts, `picture()` is a matplotlib `Figure`.

    Raises
    ------
    BrdfkitError
        For what was not measured.

    Examples
    --------
    >>> print(audit("copper.astm"))    # doctest: +SKIP
    """
    data = to_measured(material)
    samples, part = data.samples, some_samples(data)
    above = (samples.wi[:, 2] > 0) & (samples.wo[:, 2] > 0)
    values = samples.values[samples.valid]
    positive = values[values > 0]
    negative_from, negative_to = _where_negative(samples)
    theta_i, theta_o = _angles(data, samples.wi), _angles(data, samples.wo)
    seen = to_rgb_or_mean(data)
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
        reciprocity=by_reciprocity(data),
        mirror=by_mirror(data),
        noise=noise(data),
        albedo=albedo(seen, theta_i[-1]),
        albedo_of_samples=albedo_of_samples(seen),
        grazing=grazing(part),
        retroreflection=retroreflection(part),
        backwards=backwards(part),
        spikes=spikes(data),
        data=data,
    )


def _where_negative(samples):
    """The larger angles to the normal [degrees] above and below which 9 of 10 negative values are;
    nan without any."""
    below = samples.valid[:, None] & (samples.values < 0)
    cosines = np.minimum(samples.wi[:, 2], samples.wo[:, 2])
    angles = np.degrees(np.arccos(np.clip(cosines, -1, 1)))
    found = np.repeat(angles, below.sum(axis=1))
    return np.percentile(found, (10, 90)).tolist() if found.size else (np.nan, np.nan)


def _angles(data, w):
    """The angles to the normal [degrees] of the valid directions `w`, ascending.

    Only the smallest and the largest of a table, and of more than `FEW` angles.
    """
    cosines = w[data.samples.valid, 2]
    if data.is_table:
        cosines = np.array([cosines.max(), cosines.min()])
    angles = np.unique(np.degrees(np.arccos(np.clip(cosines, -1, 1))).round(1))
    return tuple(float(a) for a in (angles if len(angles) <= FEW else angles[[0, -1]]))
