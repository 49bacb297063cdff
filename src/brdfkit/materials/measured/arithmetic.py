"""Subtracts a BRDF from a measured material: what is left has the same samples or cells."""

import functools
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.selection import require_max_angle
from brdfkit.model.samples import Table
from brdfkit.model.samples.samples import require_some


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


def subtract(data, brdf, max_angle):
    """A copy of a `Measured` with values less those of `brdf`, as `Measured.minus` says.

    Samples that are left out are unknown in it, and there is no lookup between the samples.
    """
    require_max_angle(max_angle)
    samples, name = data.samples, f"{data.name} - {brdf.name}"
    inside = samples.within(max_angle)
    known = brdf.eval(samples.wi[inside], samples.wo[inside])
    if known.shape[1] not in (1, len(data.channels)):
        raise BrdfkitError(
            f"{name}: {known.shape[1]} channels cannot be subtracted from {len(data.channels)}; "
            "give BRDFs with the same channels."
        )
    values = np.full(samples.values.shape, np.nan)
    values[inside] = samples.values[inside] - known
    valid = np.isfinite(values).all(axis=1)
    require_some(valid, name, values, data.channels)
    if not data.is_table:
        left = replace(samples, values=values, valid=valid)
        return replace(data, name=name, _samples=left, _lookup=None)
    table = Table(values.reshape(data._table.values.shape), data._table.phi_d_period)
    return replace(data, name=name, _table=table)
