"""How far the pictures of the fits are from that of the measurement, and how far noise alone is."""

from dataclasses import dataclass, replace
from math import isnan

from brdfkit.images.errors.metrics import METRICS, Metric


@dataclass(frozen=True)
class PictureError:
    """An error of pictures by a `metric`: the `values` of the fits, in their order, and the
    `floor`, that of noise alone."""

    metric: Metric
    values: tuple[float, ...]
    floor: float

    @property
    def title(self):
        """What the column is called."""
        return self.metric.title

    @property
    def first(self):
        """The place of the fit that comes nearest; None where no error is known."""
        known = [value for value in self.values if not isnan(value)]
        return self.values.index((max if self.metric.more else min)(known)) if known else None

    def text(self, value):
        """A value as text."""
        return self.metric.text(value)

    def exceeds(self, value):
        """Whether a value is a larger difference than noise makes."""
        return self.metric.exceeds(value, self.floor)

    def in_order(self, order):
        """The same with the fits in another order, numbers of the old one."""
        return replace(self, values=tuple(self.values[k] for k in order))


def picture_errors(rendering):
    """The `PictureError`s of a `Rendering` by the keys of its `errors()`."""
    found = rendering.errors()
    return {
        key: PictureError(METRICS[key], tuple(row[key] for row in found.by_name.values()), floor)
        for key, floor in found.floor.items()
    }
