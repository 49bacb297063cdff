"""Converts samples in which phi_o is off by 180°, or which are the BRDF times cos theta_o.

brdfkit's own convention is the BRDF without a cosine, and the mirror direction at
phi_o = phi_i + 180°. Some instruments have it at phi_o = phi_i.
"""

from dataclasses import replace

import numpy as np

from brdfkit.core.array_types import BoolArray, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.materials.measured.measured_data import Data, MeasuredData
from brdfkit.model.samples.samples import require_valid

LEAST_COSINE = 1e-3  # values are not divided by a smaller cosine: the quotient would be noise
# The notes that record each of the two conversions; OPTIONS has them by the argument of `mend`
DIVIDED = {"cosine": "the values were BRDF × cos theta_o and are divided by it"}
TURNED = {"azimuth": "phi_o was counted from the mirror's side and is 180° more"}
OPTIONS = {"mirror_azimuth": TURNED, "divide_by_cos": DIVIDED}


def mend(data: Data, mirror_azimuth: bool = False, divide_by_cos: bool = False) -> Data:
    """Add 180° to every phi_o of a `Measured`, divide its values by cos theta_o, or do both.

    Notes in `info` record it. Raises `BrdfkitError` for data whose convention is known: a table, a
    format with its own interpolation, and data that were converted before.
    """
    if mirror_azimuth:
        _require_unmended(data, "mirror_azimuth")
        turned = replace(data.samples, wo=data.samples.wo * [-1, -1, 1])
        data = replace(data, info=data.info | TURNED, _samples=turned)
    if divide_by_cos:
        _require_unmended(data, "divide_by_cos")
        data = _divide_by_cosine(data)
    return data


def can_mend(data: MeasuredData, option: str) -> bool:
    """Return whether `mend` accepts the argument named `option` for a `Measured`."""
    return not (data.is_table or data.has_lookup) and not _was_mended(data, option)


def compute_view_cosines(wo: FloatArray) -> tuple[FloatArray, BoolArray]:
    """Return the cosines to the normal (n, 1) of the views `wo` (n, 3), to divide their values by.

    The second result is a mask (n,) of the views whose cosine is too small to divide by; for these
    the first result is 1.
    """
    low = wo[:, 2] < LEAST_COSINE
    return np.where(low, 1.0, wo[:, 2])[:, None], low


def _divide_by_cosine(data: Data) -> Data:
    """Divide the values of a `Measured` and their standard errors by cos theta_o."""
    samples, errors = data.samples, data.standard_error
    cosine, low = compute_view_cosines(samples.wo)
    values, valid = samples.values / cosine, samples.valid & ~low
    require_valid(valid, data.name, values, data.channels)
    return replace(
        data,
        info=data.info | DIVIDED,
        standard_error=None if errors is None else errors / cosine,
        _samples=replace(samples, values=values, valid=valid),
    )


def _was_mended(data: MeasuredData, option: str) -> bool:
    """Return whether the notes of a `Measured` record that `mend` applied this option before."""
    return OPTIONS[option].items() <= data.info.items()


def _require_unmended(data: MeasuredData, option: str) -> None:
    """Raise `BrdfkitError`, with the reason, where `mend` does not accept this option."""
    if can_mend(data, option):
        return
    what = "is a table, which states its directions and that it holds the BRDF"
    if _was_mended(data, option):
        what = f"was converted already ({' '.join(OPTIONS[option].values())})"
    elif not data.is_table:
        what = "has a format that states its directions and that it holds the BRDF"
    raise BrdfkitError(f"{data.name}: {what}; leave out {option} (--{option.replace('_', '-')}).")
