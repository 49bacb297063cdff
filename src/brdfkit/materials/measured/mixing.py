"""Mixes the channels of a measured material."""

import functools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np


def mix(data, weights, channels, info):
    """A copy of a `Measured` with other `channels`, mixed from its own by `weights` (old, new), and
    with the notes `info`.

    Standard errors are mixed as those of independent channels.
    """
    changed = {"channels": tuple(channels), "info": info}
    if data.standard_error is not None:
        changed["standard_error"] = np.sqrt(data.standard_error**2 @ weights**2)
    if data._table is not None:
        changed["_table"] = data._table.mixed(weights)
    if data._samples is not None:
        changed["_samples"] = replace(data._samples, values=data.values @ weights)
    if data._lookup is not None:
        mixed = getattr(data._lookup, "mixed", functools.partial(MixedLookup, data._lookup))
        changed["_lookup"] = mixed(weights)
    return replace(data, **changed)


@dataclass(frozen=True, eq=False)
class MixedLookup:
    """A lookup whose channels are mixed by `weights` (old, new)."""

    lookup: Callable
    weights: np.ndarray

    def __call__(self, wi, wo):
        return self.lookup(wi, wo) @ self.weights
