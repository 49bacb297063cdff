"""Mixes the channels of a measured material, and subtracts another BRDF from it.

The result has the same samples or cells.
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
    """Return a `Measured` with other `channels`, mixed from the old ones, and with notes `info`.

    `weights` (old, new) are the shares of the old channels in the new ones. The standard
    errors of the channels count as independent.
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
    """Return the values of a lookup, with its channels mixed by `weights` (old, new)."""
    return lookup(wi, wo) @ weights


def subtract(data: Data, brdf: Any, max_angle: float) -> Data:
    """Subtract `brdf` from the values of a `Measured`, as `Measured.subtract` describes it.

    `brdf` is a material with `name` and `eval`. Samples with an angle at or beyond `max_angle`
    [degrees] are unknown in the result, and it has no lookup between the samples.
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
