"""Computes the errors of the fits' pictures, compared with the picture of the measurement."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import isnan

from brdfkit.images.errors.metrics import METRICS, Metric
from brdfkit.rendering.result import Rendering


@dataclass(frozen=True)
class PictureError:
    """The errors of all fits' pictures in one metric.

    metric : the metric, such as PSNR.
    values : the errors, in the order of the fits.
    floor : the error that noise of the rendering alone causes.
    """

    metric: Metric
    values: tuple[float, ...]
    floor: float

    @property
    def title(self) -> str:
        """The title of the metric's column in a table."""
        return self.metric.title

    @property
    def best_index(self) -> int | None:
        """The index of the fit with the best picture; None where no error is known."""
        known = [value for value in self.values if not isnan(value)]
        return self.values.index((max if self.metric.more else min)(known)) if known else None

    def format_value(self, value: float) -> str:
        """Return a value of the metric as text, with suitable digits."""
        return str(self.metric.format_value(value))

    def exceeds_noise(self, value: float) -> bool:
        """Return whether a value is a larger error than noise of the rendering causes."""
        return bool(self.metric.exceeds(value, self.floor))

    def reorder(self, order: Sequence[int]) -> PictureError:
        """Return the errors with the fits in another order; `order`: their indices so far."""
        return replace(self, values=tuple(self.values[k] for k in order))


def compute_picture_errors(rendering: Rendering) -> dict[str, PictureError]:
    """Compute the errors of all fits' pictures in a rendering, compared with its reference.

    The result has an entry for each metric, under the metric's key, such as "psnr".
    """
    errors = rendering.errors()
    return {
        key: PictureError(METRICS[key], tuple(row[key] for row in errors.by_name.values()), floor)
        for key, floor in errors.floor.items()
    }
