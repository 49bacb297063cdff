"""Mends samples that were written in another convention: their azimuths, or a cosine in them."""

from dataclasses import replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.measured_data import MeasuredData
from brdfkit.model.samples.samples import require_some

Data = TypeVar("Data", bound=MeasuredData)
LEAST_COSINE = 1e-3  # a BRDF times a smaller cosine does not tell the BRDF
# The notes of what was done, by their keys
DIVIDED = {"cosine": "the values were BRDF × cos theta_o and are divided by it"}
TURNED = {"azimuth": "phi_o was counted from the mirror's side and is 180° more"}
OPTIONS = {"mirror_azimuth": TURNED, "divide_by_cos": DIVIDED}


def mend(data: Data, mirror_azimuth: bool = False, divide_by_cos: bool = False) -> Data:
    """A `Measured` with 180° added to every phi_o, with its values divided by cos theta_o, or both.

    The notes in `info` say so. Raises `BrdfkitError` for a table, for a format that has values
    between the samples, and for what was mended before: these are in brdfkit's convention.
    """
    if mirror_azimuth:
        _require_unmended(data, "mirror_azimuth")
        turned = replace(data.samples, wo=data.samples.wo * [-1, -1, 1])
        data = replace(data, info=data.info | TURNED, _samples=turned)
    if divide_by_cos:
        _require_unmended(data, "divide_by_cos")
        data = _divide(data)
    return data


def can_be_mended(data: MeasuredData, option: str) -> bool:
    """Whether `mend` takes this option for a `Measured`."""
    return not (data.is_table or data.has_lookup) and not _has_notes(data, option)


def cosines(wo: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """What values (n, channels) with a cosine of the view are divided by, (n, 1); and the rows of
    `wo` (n, 3) in which it is too small, where this is 1."""
    low = wo[:, 2] < LEAST_COSINE
    return np.where(low, 1.0, wo[:, 2])[:, None], low


def _divide(data: Data) -> Data:
    """The values and their standard errors divided by cos theta_o."""
    samples, errors = data.samples, data.standard_error
    cosine, low = cosines(samples.wo)
    values, valid = samples.values / cosine, samples.valid & ~low
    require_some(valid, data.name, values, data.channels)
    return replace(
        data,
        info=data.info | DIVIDED,
        standard_error=None if errors is None else errors / cosine,
        _samples=replace(samples, values=values, valid=valid),
    )


def _has_notes(data, option):
    return OPTIONS[option].items() <= data.info.items()


def _require_unmended(data, option):
    """Raise `BrdfkitError` where a `Measured` is in brdfkit's convention as it is."""
    if can_be_mended(data, option):
        return
    what = "is a table, which states its directions and that it holds the BRDF"
    if _has_notes(data, option):
        what = f"was mended already ({' '.join(OPTIONS[option].values())})"
    elif not data.is_table:
        what = "has a format that states its directions and that it holds the BRDF"
    raise BrdfkitError(f"{data.name}: {what}; leave out {option} (--{option.replace('_', '-')}).")
