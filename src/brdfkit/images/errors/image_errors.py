"""`ImageErrors`: pictures compared to a reference by every metric, beside the noise floor."""

import math
from dataclasses import dataclass

import numpy as np

from brdfkit.core.documents import Document, Paragraph, Shown, Table
from brdfkit.core.documents.parts import SOFT
from brdfkit.images.errors.masks import to_mask
from brdfkit.images.errors.metrics import METRICS
from brdfkit.images.errors.psnr import find_peak

NOISE = "({})"  # how an error is written that does not exceed the noise floor


@dataclass(frozen=True, repr=False)
class ImageErrors(Shown):
    """Errors of pictures, by several metrics, beside their noise floor; prints as a table.

    Made by `Rendering.errors`. The floor is what a metric says of the reference against itself
    with another seed: a difference that does not exceed it is said to be none. The pictures share
    their samples, and so part of their noise: small differences of like materials may be real.

    Attributes
    ----------
    reference : str
        Name of the picture that the others are compared to.
    by_name : dict of str to dict of str to float
        Name → metric → error: "psnr" [dB]; "delta_e_2000", the median, and "delta_e_2000_95", the
        95th percentile; "delta_e_itp_95", likewise, with 1 at 203 cd/m²; the means "flip" (HDR,
        67 pixels per degree) and "ssim" (of sRGB in 0..1), if their packages are installed. nan
        for a picture that is not finite, and where no pixel shows the material.
    floor : dict of str to float
        Metric → what it says of noise alone; nan where there is one sample per pixel.
    peak : float
        What PSNR takes for the peak: the 99.9th percentile of the reference.
    notes : tuple of str
        Sentences on what is missing, and how to get it.
    """

    reference: str
    by_name: dict[str, dict[str, float]]
    floor: dict[str, float]
    peak: float
    notes: tuple[str, ...] = ()

    def exceeds(self, name: str, metric: str) -> bool:
        """Whether the picture `name` differs from the reference by more than the noise floor."""
        return METRICS[metric].exceeds(self.by_name[name][metric], self.floor[metric])

    @property
    def columns(self) -> tuple[str, ...]:
        """The titles of the columns of `table`; those of numbers begin with ">"."""
        return "picture", *(f">{METRICS[m].title}" for m in self.floor)

    def table(self) -> list[tuple[str, ...]]:
        """A row of texts for every picture, under `columns`; the last one is the noise floor."""
        rows = [(n, *(self._text(n, m) for m in row)) for n, row in self.by_name.items()]
        return [*rows, ("noise floor", *(METRICS[m].text(e) for m, e in self.floor.items()))]

    def _text(self, name, metric):
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
        """The errors, a row for each picture, over the noise floor."""
        *rows, floor = self.table()
        remarks = (Paragraph(remark, SOFT) for remark in self.remarks)
        title = f"Pictures beside that of {self.reference}"
        return Document(title, (Table(tuple(rows), self.columns, (floor,)), *remarks))


def compare_pictures(pictures, other_seed=None, mask=None):
    """The `ImageErrors` of `pictures` by name, of which the first is the reference.

    `other_seed`: the reference as another seed would give it, or None, which leaves the floor
    unknown; `mask` (height, width): the pixels that count, all for None.
    """
    reference, *names = pictures
    first = pictures[reference]
    mask = to_mask(first, mask)
    compared = [*(pictures[name] for name in names), other_seed]

    found, absent = {}, []  # errors of the pictures and, last, of noise, by metric
    for key, metric in METRICS.items():
        try:
            found[key] = [_compute_error(metric, first, picture, mask) for picture in compared]
        except ImportError:
            absent.append(metric)
    by_name = {n: {key: row[k] for key, row in found.items()} for k, n in enumerate(names)}
    floor = {key: row[-1] for key, row in found.items()}
    notes = [
        *_describe_empty_mask(mask),
        *_describe_not_finite(pictures, mask),
        *_describe_missing(absent),
    ]
    return ImageErrors(reference, by_name, floor, find_peak(first, mask), tuple(notes))


def _compute_error(metric, reference, picture, mask):
    """The error of a picture; nan where there is none, where either is not finite, and where the
    mask is empty."""
    if picture is None or not mask.any() or not np.isfinite([reference[mask], picture[mask]]).all():
        return math.nan
    return metric.function(reference, picture, mask)


def _describe_empty_mask(mask):
    """A sentence where the mask is empty."""
    if not mask.any():
        yield "No pixel shows the material, which leaves all errors unknown: render it larger."


def _describe_not_finite(pictures, mask):
    """A sentence on each picture that is not finite."""
    for name, picture in pictures.items():
        broken = (~np.isfinite(picture[mask]).all(axis=-1)).sum()
        if broken:
            pixels = "1 pixel" if broken == 1 else f"{broken} pixels"
            yield f"{name} is not finite in {pixels}, which leaves its errors unknown."


def _describe_missing(metrics):
    """A sentence on `metrics` whose packages are not installed."""
    if metrics:
        titles = " and ".join(metric.title for metric in metrics)
        packages = " and ".join(metric.package for metric in metrics)
        yield f"For {titles} install {packages}: pip install 'brdfkit[metrics]'."
