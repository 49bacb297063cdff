"""`KeptFits`: the fits to a material of late, which the pages of a server share."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from brdfkit.regression import Fit

LARGEST_COUNT = 32  # fits that are kept


@dataclass
class KeptFits:
    """The fits to one material.

    `latest`: the last fit that was made, given or shown of each model, by its label. `all`: all
    fits of late, with their labels.
    """

    latest: dict[str, Fit] = field(default_factory=dict)
    all: deque[tuple[str, Fit]] = field(default_factory=lambda: deque(maxlen=LARGEST_COUNT))

    def keep(self, label: str, fit: Fit) -> None:
        """Make a fit the one of its model."""
        if self.latest.get(label) is not fit:
            self.latest[label] = fit
            self.all.append((label, fit))
