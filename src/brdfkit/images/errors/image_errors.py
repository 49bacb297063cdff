"""Compares pictures with a reference by every metric, beside the noise floor."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from brdfkit.core.array_types import AnyArray, BoolArray
from brdfkit.core.documents import Document, Paragraph, Shown, Table
from brdfkit.core.documents.parts import SOFT
from brdfkit.images.errors.masks import to_mask
from brdfkit.images.errors.metrics import METRICS, Metric
from brdfkit.images.errors.psnr import find_peak

NOISE = "({})"  # the format of an error that does not exceed the noise floor


@dataclass(frozen=True, repr=False)
class ImageErrors(Shown):
    """Errors of pictures by several metrics, beside their noise floor; prints as a table.

    `Rendering.errors` makes them. The floor is the error of the reference against itself with
    another seed. A difference that does not exceed it counts as none. The pictures share their
    samples, and so part of their noise: small differences of similar materials may be real.

    Attributes
    ----------
    reference : str
        Name of the picture that the others are compared with.
    by_name : dict of str to dict of str to float
        Name → metric → error: "psnr" [dB]; "delta_e_2000", the median, and "delta_e_2000_95", the
        95th percentile; "delta_e_itp_95", likewise, with 1 at 203 cd/m²; the means "flip" (HDR,
        67 pixels per degree) and "ssim" (of sRGB in 0..1), if their packages are installed. nan
        for a picture that is not finite, and where no pixel shows the material.
    floor : dict of str to float
        Metric → the error of noise alone; nan where there is one sample per pixel.
    peak : float
        The peak of PSNR: the 99.9th percentile of the reference.
    notes : tuple of str
        Sentences on missing metrics, and how to get them.
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
        """Return a row of texts for every picture, under `columns`, and the noise floor last."""
        rows = [(n, *(self._text(n, m) for m in row)) for n, row in self.by_name.items()]
        return [*rows, ("noise floor", *(METRICS[m].text(e) for m, e in self.floor.items()))]

    def _text(self, name: str, metric: str) -> str:
        """Format the error of a picture, in brackets if it does not exceed the noise floor."""
        text = METRICS[metric].text(self.by_name[name][metric])
        return text if self.exceeds(name, metric) else NOISE.format(text)

    @property
    def remarks(self) -> list[str]:
        """Sentences on how to read the table, and the notes."""
        none = (
            f"{NOISE.format('...')} is no difference: not above the noise floor, the reference "
            "against itself with another seed."
        )
        unknown = "The noise floor needs two samples per pixel."
        shown = any(text.startswith("(") for _, *row in self.table() for text in row)
        reading = [none] * shown + [unknown] * math.isnan(self.floor["psnr"])
        if math.isnan(self.peak):  # the notes say why nothing is known
            return list(self.notes)
        return [*reading, f"PSNR's peak is {self.peak:.3g}.", *self.notes]

    def document(self) -> Document:
        """Return a table of the errors, a row for each picture, above the noise floor."""
        *rows, floor = self.table()
        remarks = (Paragraph(remark, SOFT) for remark in self.remarks)
        title = f"Pictures beside that of {self.reference}"
        return Document(title, (Table(tuple(rows), self.columns, (floor,)), *remarks))


def compare_pictures(
    pictures: Mapping[str, AnyArray],
    other_seed: AnyArray | None = None,
    mask: BoolArray | None = None,
) -> ImageErrors:
    """Compare pictures by name with the first of them, the reference.

    `other_seed` is the reference as another seed would give it; None leaves the floor unknown.
    `mask` (height, width) selects the pixels that count; None means all.
    """
    reference, *names = pictures
    first = pictures[reference]
    mask = to_mask(first, mask)
    compared = [*(pictures[name] for name in names), other_seed]

    errors, absent = {}, []  # by metric, errors of the pictures and, last, of noise
    for key, metric in METRICS.items():
        try:
            errors[key] = [_compute_error(metric, first, picture, mask) for picture in compared]
        except ImportError:
            absent.append(metric)
    by_name = {n: {key: row[k] for key, row in errors.items()} for k, n in enumerate(names)}
    floor = {key: row[-1] for key, row in errors.items()}
    notes = [
        *_describe_empty_mask(mask),
        *_describe_not_finite(pictures, mask),
        *_describe_missing(absent),
    ]
    return ImageErrors(reference, by_name, floor, find_peak(first, mask), tuple(notes))


def _compute_error(
    metric: Metric, reference: AnyArray, picture: AnyArray | None, mask: BoolArray
) -> float:
    """Return the error of a picture; nan for none, an empty mask, or values not finite."""
    if picture is None or not mask.any() or not np.isfinite([reference[mask], picture[mask]]).all():
        return math.nan
    return metric.function(reference, picture, mask)


def _describe_empty_mask(mask: BoolArray) -> Iterator[str]:
    """Yield a sentence where the mask is empty."""
    if not mask.any():
        yield "No pixel shows the material, which leaves all errors unknown: render it larger."


def _describe_not_finite(pictures: Mapping[str, AnyArray], mask: BoolArray) -> Iterator[str]:
    """Yield a sentence on each picture that is not finite."""
    for name, picture in pictures.items():
        broken = (~np.isfinite(picture[mask]).all(axis=-1)).sum()
        if broken:
            pixels = "1 pixel" if broken == 1 else f"{broken} pixels"
            yield f"{name} is not finite in {pixels}, which leaves its errors unknown."


def _describe_missing(metrics: Sequence[Metric]) -> Iterator[str]:
    """Yield a sentence on metrics whose packages are not installed."""
    if metrics:
        titles = " and ".join(metric.title for metric in metrics)
        packages = " and ".join(metric.package for metric in metrics)
        yield f"For {titles} install {packages}: pip install 'brdfkit[metrics]'."
