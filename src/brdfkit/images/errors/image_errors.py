"""Compares pictures with a reference by all metrics, and tells real differences from noise."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray
from brdfkit.core.documents import Document, Paragraph, Shown, Table
from brdfkit.core.documents.parts import SOFT
from brdfkit.images.errors.masks import make_mask
from brdfkit.images.errors.metrics import METRICS, Metric
from brdfkit.images.errors.psnr import find_peak

NOISE = "({})"  # the format of an error that does not exceed the noise floor


@dataclass(frozen=True, repr=False)
class ImageErrors(Shown):
    """Errors of pictures by several metrics, and their noise floor; prints as a table.

    `Rendering.errors` computes them. The noise floor is the error of the reference against itself
    with another random seed. A difference that does not exceed the floor counts as none, although
    small differences of similar materials may be real: the pictures share their samples, and so
    part of their noise.

    Attributes
    ----------
    reference : str
        Name of the picture with which all other pictures are compared.
    by_name : dict of str to dict of str to float
        Name → metric → error: "psnr" [dB]; the median "delta_e_2000" and the 95th percentile
        "delta_e_2000_95" of ΔE2000; the 95th percentile "delta_e_itp_95" of ΔE ITP, with the value
        1 at 203 cd/m²; the means "flip" (HDR, 67 pixels per degree) and "ssim" (of sRGB in 0..1),
        if their packages are installed. An error is nan for a picture that is not finite, and if no
        pixel shows the material.
    floor : dict of str to float
        Metric → noise floor; nan if there is one sample per pixel.
    peak : float
        The peak of PSNR: the 99.9th percentile of the reference.
    notes : tuple of str
        Sentences on metrics that are missing, with the packages to install.
    """

    reference: str
    by_name: dict[str, dict[str, float]]
    floor: dict[str, float]
    peak: float
    notes: tuple[str, ...] = ()

    def exceeds(self, name: str, metric: str) -> bool:
        """Return whether a picture differs from the reference by more than the noise floor."""
        return METRICS[metric].exceeds(self.by_name[name][metric], self.floor[metric])

    @property
    def columns(self) -> tuple[str, ...]:
        """The titles of the columns of `table`; titles of numbers begin with ">"."""
        return "picture", *(f">{METRICS[m].title}" for m in self.floor)

    def table(self) -> list[tuple[str, ...]]:
        """Return the table's rows of texts under `columns`, one per picture and the noise floor."""
        rows = [(n, *(self._format_error(n, m) for m in row)) for n, row in self.by_name.items()]
        return [
            *rows,
            ("noise floor", *(METRICS[m].format_value(e) for m, e in self.floor.items())),
        ]

    def _format_error(self, name: str, metric: str) -> str:
        """Format the error of a picture, in brackets if it does not exceed the noise floor."""
        text = METRICS[metric].format_value(self.by_name[name][metric])
        return text if self.exceeds(name, metric) else NOISE.format(text)

    @property
    def remarks(self) -> list[str]:
        """Sentences that explain how to read the table, followed by the notes."""
        none = (
            f"{NOISE.format('...')} is no difference: not above the noise floor, the reference "
            "against itself with another seed."
        )
        unknown = "The noise floor needs two samples per pixel."
        shown = any(text.startswith("(") for _, *row in self.table() for text in row)
        reading = [none] * shown + [unknown] * math.isnan(self.floor["psnr"])
        if math.isnan(self.peak):  # no pixel was compared; the notes say why
            return list(self.notes)
        return [*reading, f"PSNR's peak is {self.peak:.3g}.", *self.notes]

    def document(self) -> Document:
        """Return the errors as a table, one row per picture and a last row for the noise floor."""
        *rows, floor = self.table()
        remarks = (Paragraph(remark, SOFT) for remark in self.remarks)
        title = f"Pictures beside that of {self.reference}"
        return Document(title, (Table(tuple(rows), self.columns, (floor,)), *remarks))


def compare_pictures(
    pictures: Mapping[str, AnyArray],
    other_seed: AnyArray | None = None,
    mask: BoolArray | None = None,
) -> ImageErrors:
    """Compare pictures with the first of them, the reference, by all metrics.

    `pictures` are arrays (height, width, 3) by name. `other_seed` is the reference rendered with
    another seed, which gives the noise floor; None leaves the floor unknown. `mask` (height, width)
    selects the pixels to compare; None means all.
    """
    reference, *names = pictures
    first = pictures[reference]
    mask = make_mask(first, mask)
    compared = [*(pictures[name] for name in names), other_seed]

    errors, absent = {}, []  # `errors`: metric → the pictures' errors, then the noise floor
    for key, metric in METRICS.items():
        try:
            errors[key] = [_compute_error(metric, first, picture, mask) for picture in compared]
        except ImportError:
            absent.append(metric)
    by_name = {n: {key: row[k] for key, row in errors.items()} for k, n in enumerate(names)}
    floor = {key: row[-1] for key, row in errors.items()}
    notes = tuple(_describe_unknown_errors(pictures, mask, absent))
    return ImageErrors(reference, by_name, floor, find_peak(first, mask), notes)


def _compute_error(
    metric: Metric, reference: AnyArray, picture: AnyArray | None, mask: BoolArray
) -> float:
    """Return a picture's error; nan if it is None or not finite, or the mask is empty."""
    if picture is None or not mask.any() or not np.isfinite([reference[mask], picture[mask]]).all():
        return math.nan
    return metric.function(reference, picture, mask)


def _describe_unknown_errors(
    pictures: Mapping[str, AnyArray], mask: BoolArray, absent: Sequence[Metric]
) -> Iterator[str]:
    """Yield a sentence on each reason why errors are unknown.

    The mask may be empty, pixels may be not finite, and packages of the `absent` metrics missing.
    """
    if not mask.any():
        yield "No pixel shows the material, which leaves all errors unknown: render it larger."
    for name, picture in pictures.items():
        broken = (~np.isfinite(picture[mask]).all(axis=-1)).sum()
        if broken:
            pixels = "1 pixel" if broken == 1 else f"{broken} pixels"
            yield f"{name} is not finite in {pixels}, which leaves its errors unknown."
    if absent:
        titles = " and ".join(metric.title for metric in absent)
        packages = " and ".join(metric.package for metric in absent)
        yield f"For {titles} install {packages}: pip install 'brdfkit[metrics]'."
