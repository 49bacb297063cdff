"""Mixes the channels of a measured material, and subtracts another BRDF from it.

The results have the same directions, as samples or as the cells of a table.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from brdfkit.core.arguments import to_number
from brdfkit.core.array_types import FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.measured_data import Data, Lookup
from brdfkit.model.samples import Table
from brdfkit.model.samples.samples import require_valid


def mix_channels(
    data: Data, weights: FloatArray, channels: Sequence[str], info: dict[str, str]
) -> Data:
    """Return a `Measured` in new `channels`, which are linear combinations of the old ones.

    `weights` (old, new) are the coefficients, and `info` are the notes of the result. Standard
    errors are propagated as if the channels' errors were independent.
    """
    changed: dict[str, Any] = {"channels": tuple(channels), "info": info}
    if data.standard_error is not None:
        changed["standard_error"] = np.sqrt(data.standard_error**2 @ weights**2)
    if data._table is not None:
        changed["_table"] = data._table.mix_channels(weights)
    if data._samples is not None:
        changed["_samples"] = replace(data._samples, values=data.values @ weights)
    if data._lookup is not None:
        mix = getattr(data._lookup, "mix_channels", partial(partial, _look_up_mixed, data._lookup))
        changed["_lookup"] = mix(weights)
    return replace(data, **changed)


def _look_up_mixed(
    lookup: Lookup, weights: FloatArray, wi: FloatArray, wo: FloatArray
) -> FloatArray:
    """Evaluate an interpolation function `lookup`, and mix its channels by `weights` (old, new)."""
    return lookup(wi, wo) @ weights


def subtract(data: Data, brdf: Any, max_angle: float) -> Data:
    """Return a `Measured` with the differences between measured values and another BRDF.

    `brdf` is a material with `name` and `eval`. Samples with an angle to the normal at or beyond
    `max_angle` [degrees] are masked. The differences are interpolated by brdfkit, even where the
    file format has its own interpolation.
    """
    to_number("max_angle", max_angle, above=0, most=90)
    samples, name = data.samples, f"{data.name} - {brdf.name}"
    inside = samples.within(max_angle)
    subtrahend = brdf.eval(samples.wi[inside], samples.wo[inside])
    if subtrahend.shape[1] not in (1, len(data.channels)):
        raise BrdfkitError(
            f"{name}: {subtrahend.shape[1]} channels cannot be subtracted from "
            f"{len(data.channels)}; give BRDFs with the same channels."
        )
    values = np.full(samples.values.shape, np.nan)
    values[inside] = samples.values[inside] - subtrahend
    valid = np.isfinite(values).all(axis=1)
    require_valid(valid, name, values, data.channels)
    if data._table is None:
        differences = replace(samples, values=values, valid=valid)
        return replace(data, name=name, _samples=differences, _lookup=None)
    table = Table(values.reshape(data._table.values.shape), data._table.phi_d_period)
    return replace(data, name=name, _table=table)
