"""Mends samples of another convention: azimuths from the mirror's side, or values times a cosine.

brdfkit's own convention is the BRDF without a cosine, and the mirror direction at
phi_o = phi_i + 180°.
"""

from dataclasses import replace

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.measured_data import Data, MeasuredData
from brdfkit.model.samples.samples import require_valid

LEAST_COSINE = 1e-3  # a smaller cosine is not divided out: the quotient would be noise
# The notes that say what was mended, by their keys
DIVIDED = {"cosine": "the values were BRDF × cos theta_o and are divided by it"}
TURNED = {"azimuth": "phi_o was counted from the mirror's side and is 180° more"}
OPTIONS = {"mirror_azimuth": TURNED, "divide_by_cos": DIVIDED}


def mend(data: Data, mirror_azimuth: bool = False, divide_by_cos: bool = False) -> Data:
    """Return a `Measured` with 180° added to every phi_o, with values over cos theta_o, or both.

    The notes in `info` say so. Raises `BrdfkitError` for data that are in brdfkit's convention: a
    table, a format with values between its samples, and data that were mended before.
    """
    if mirror_azimuth:
        _require_unmended(data, "mirror_azimuth")
        turned = replace(data.samples, wo=data.samples.wo * [-1, -1, 1])
        data = replace(data, info=data.info | TURNED, _samples=turned)
    if divide_by_cos:
        _require_unmended(data, "divide_by_cos")
        data = _divide(data)
    return data


def can_mend(data: MeasuredData, option: str) -> bool:
    """Return whether `mend` accepts this option, by its name, for a `Measured`."""
    return not (data.is_table or data.has_lookup) and not _has_notes(data, option)


def find_cosines(wo: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return cos theta_o (n, 1) of the directions `wo` (n, 3), to divide values by it.

    The second result is a mask (n,) of the rows where the cosine is too small; 1 stands there.
    """
    low = wo[:, 2] < LEAST_COSINE
    return np.where(low, 1.0, wo[:, 2])[:, None], low


def _divide(data: Data) -> Data:
    """Return a `Measured` with its values and their standard errors divided by cos theta_o."""
    samples, errors = data.samples, data.standard_error
    cosine, low = find_cosines(samples.wo)
    values, valid = samples.values / cosine, samples.valid & ~low
    require_valid(valid, data.name, values, data.channels)
    return replace(
        data,
        info=data.info | DIVIDED,
        standard_error=None if errors is None else errors / cosine,
        _samples=replace(samples, values=values, valid=valid),
    )


def _has_notes(data: MeasuredData, option: str) -> bool:
    """Return whether the notes of a `Measured` say that this option was applied."""
    return OPTIONS[option].items() <= data.info.items()


def _require_unmended(data: MeasuredData, option: str) -> None:
    """Raise `BrdfkitError` where a `Measured` is in brdfkit's convention as it is."""
    if can_mend(data, option):
        return
    what = "is a table, which states its directions and that it holds the BRDF"
    if _has_notes(data, option):
        what = f"was mended already ({' '.join(OPTIONS[option].values())})"
    elif not data.is_table:
        what = "has a format that states its directions and that it holds the BRDF"
    raise BrdfkitError(f"{data.name}: {what}; leave out {option} (--{option.replace('_', '-')}).")
