"""Measures how far the pictures of the fits are from the picture of the measurement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isnan

from brdfkit.images.errors.metrics import METRICS, Metric
from brdfkit.rendering.result import Rendering


@dataclass(frozen=True)
class PictureError:
    """The errors of all fits' pictures by one metric.

    metric : the metric, such as PSNR.
    values : the error of each fit, in the order of the fits.
    floor : the error that noise alone causes.
    """

    metric: Metric
    values: tuple[float, ...]
    floor: float

    @property
    def title(self) -> str:
        """The title of the column."""
        return self.metric.title

    @property
    def best_index(self) -> int | None:
        """The index of the fit with the best picture; None where no error is known."""
        known = [value for value in self.values if not isnan(value)]
        return self.values.index((max if self.metric.more else min)(known)) if known else None

    def format_value(self, value: float) -> str:
        """Return a value as text."""
        return str(self.metric.format_value(value))

    def exceeds_noise(self, value: float) -> bool:
        """Return whether a value is a larger difference than noise makes."""
        return bool(self.metric.exceeds(value, self.floor))

    def reorder(self, order: Sequence[int]) -> PictureError:
        """Return the errors with the fits in another order, given by their old indices."""
        return replace(self, values=tuple(self.values[k] for k in order))


def compute_picture_errors(rendering: Rendering) -> dict[str, PictureError]:
    """Return the `PictureError`s of a rendering by the keys of its `errors()`."""
    errors = rendering.errors()
    return {
        key: PictureError(METRICS[key], tuple(row[key] for row in errors.by_name.values()), floor)
        for key, floor in errors.floor.items()
    }
