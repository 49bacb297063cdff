"""`data_findings`: what a fit should know of its data, found in milliseconds, in sentences."""

import math
from weakref import WeakKeyDictionary

import numpy as np

from brdfkit.core.names import format_percent
from brdfkit.materials.auditing.cosine import suspected_cosine
from brdfkit.materials.auditing.grazing_and_retro import (
    GRAZING,
    STEEP,
    backwards,
    grazing,
    retroreflection,
)
from brdfkit.materials.auditing.noise import noise
from brdfkit.materials.auditing.spread import some_samples
from brdfkit.materials.auditing.symmetries import by_reciprocity
from brdfkit.materials.auditing.turned import error_when_turned
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.conventions import can_mend
from brdfkit.materials.measured.coverage import is_in_plane
from brdfkit.model.samples import Samples
from brdfkit.regression.light import format_share

# What is above these, or below DARK_HORIZON, is a finding:
NOT_RECIPROCAL, PAIRS = 0.1, 20  # the median difference, of at least so many pairs
OF_NOISE = 0.6745 * math.sqrt(2)  # the median difference of two equal values, over their noise
DARK_HORIZON, RETROREFLECTIVE = 0.5, 5  # ratios of `grazing_and_retro.py`
# ... and `backwards` there: alone, or with this `retroreflection`; of rough plaster 3.5 and 1.6
BACKWARDS, WITH_A_LOBE = 5, (2, 2.5)
# ... where that ratio is not below FORWARDS, `error_when_turned` is below TURNED
FORWARDS, TURNED = 0.9, 0.3
SAME = 1.0  # degrees: angles of incidence that differ by less are one
ZERO = 0.01  # the share of samples that are 0
SEVERAL = 5  # values below 0 that are equal
GAIN, LEAST_LIGHT = 1.25, 1e-3  # the light that is reflected ...
OBLIQUE = 60  # ... below this angle of incidence [degrees]
ALONG = math.cos(math.radians(5))  # the cosine of directions along the normal

# A fit of each of many models asks the same
_known: WeakKeyDictionary[Measured, dict[str, str]] = WeakKeyDictionary()


def data_findings(data: Measured, max_angle: float = 90.0) -> tuple[str, ...]:
    """Sentences on what is doubtful in a `Measured`, without what takes long or shows elsewhere.

    `max_angle`: the largest angle to the normal [degrees] of the samples that are used; what is
    wrong beyond it is left out.
    """
    if data not in _known:
        _known[data] = {what: sentence for what, sentence in _find(data).items() if sentence}
    found = _known[data]
    return tuple(s for what, s in found.items() if what != "horizon" or max_angle > GRAZING)


def _find(data: Measured) -> dict[str, str]:
    """The sentences by what they are about, "" where there is nothing to say."""
    samples = some_samples(data)
    cosine = _say_cosine(data)
    return {
        "azimuth": _say_direction(data, samples),
        "cosine": cosine,
        "reciprocity": "" if cosine else _say_reciprocity(data),
        "horizon": "" if cosine else _say_horizon(samples),
        "plane": _say_plane(samples),
        "incidence": _say_incidence(samples),
        "zero": _say_zero(samples),
        "sentinel": _say_sentinel(samples),
        "unit": _say_unit(data),
    }


def _say_direction(data: Measured, samples: Samples) -> str:
    """On light that is sent back to where it comes from, or azimuths that make it seem so."""
    ratio, near_light = backwards(samples), retroreflection(samples)
    mendable = can_mend(data, "mirror_azimuth")
    found = ""
    if ratio > BACKWARDS or (ratio > WITH_A_LOBE[0] and near_light > WITH_A_LOBE[1]):
        found = f"the values are {ratio:.2g} times as large towards the light as"
    elif mendable and not ratio < FORWARDS and error_when_turned(samples) < TURNED:
        found = "the highlight lies towards the light, and not"
    if found:
        mirrored = "the instrument counts phi_o from the mirror's side"
        if mendable:
            mirrored += ", which mirror_azimuth=True (--mirror-azimuth) mends"
        return (
            f"{found} in the mirror direction, phi_o = phi_i + 180°: either the material is "
            "retroreflective, which no lobe about the mirror direction can fit, or "
            f"{mirrored}"
        )
    if near_light > RETROREFLECTIVE:
        return (
            f"the material is retroreflective: the median within 5° of the light is "
            f"{near_light:.2g} times that elsewhere, which no lobe about the mirror direction can "
            "fit"
        )
    return ""


def _say_cosine(data: Measured) -> str:
    """On values that seem to be the BRDF times cos theta_o."""
    why = suspected_cosine(data)
    if not why:
        return ""
    mend = ""
    if can_mend(data, "divide_by_cos"):
        mend = "; if they are, divide_by_cos=True (--divide-by-cos) mends them"
    return f"the values seem to be the BRDF times cos theta_o, because {why}{mend}"


def _say_reciprocity(data: Measured) -> str:
    """On values that differ as wi and wo are exchanged, by more than noise makes them."""
    found = by_reciprocity(data)
    if found.pairs < PAIRS or not found.median > NOT_RECIPROCAL:
        return ""
    noises = [2 * OF_NOISE * n for n in noise(data).relative if not math.isnan(n)]
    if found.median <= max([NOT_RECIPROCAL, *noises]):
        return ""
    return (
        "the values are not reciprocal: exchanging wi and wo changes them by "
        f"{100 * found.median:.0f} % in the median"
    )


def _say_horizon(samples: Samples) -> str:
    """On values near the horizon that are darker than of most surfaces."""
    ratio = grazing(samples)
    if not ratio < DARK_HORIZON:
        return ""
    return (
        f"the values fall towards the horizon: the median beyond {GRAZING}° is {ratio:.2g} times "
        f"that between {STEEP[0]}° and {STEEP[1]}°, as of few surfaces; fit with a smaller "
        "max_angle"
    )


def _say_plane(samples: Samples) -> str:
    """On samples in the plane of incidence; along the normal there is none."""
    oblique = (samples.wi[:, 2] < ALONG) & (samples.wo[:, 2] < ALONG) & samples.valid
    if not oblique.any() or not is_in_plane(samples):
        return ""
    return (
        "the material was measured in the plane of incidence only: all beside it is a guess, also "
        "the albedo"
    )


def _say_incidence(samples: Samples) -> str:
    """On samples that all have the light at one angle to the normal."""
    angles = np.degrees(np.arccos(np.clip(samples.wi[samples.valid, 2], -1, 1)))
    if len(angles) < 2 or np.ptp(angles) > SAME:
        return ""
    return (
        f"the material was measured at one angle of incidence, {np.median(angles):.0f}°: how its "
        "highlight changes with that angle is a guess of the model's"
    )


def _say_zero(samples: Samples) -> str:
    """On samples that are 0 in all channels, as none of a surface is."""
    share = (samples.values[samples.valid] == 0).all(axis=1).mean()
    if not share > ZERO:
        return ""
    share = format_percent(100 * share)
    return f"{share} of the samples are exactly 0: probably clipped, or not measured"


def _say_sentinel(samples: Samples) -> str:
    """On a negative whole number of many samples, as -9999: a mark of what was not measured."""
    values = samples.values[samples.valid]
    whole = (values < 0) & (values == np.round(values))
    below, counts = np.unique(values[whole], return_counts=True)
    if not len(counts) or counts.max() < SEVERAL:
        return ""
    mark = below[counts.argmax()]
    return (
        f"{counts.max():,} values are exactly {mark:g}: probably a mark of what was not measured; "
        "leave those cells of the file empty"
    )


def _say_unit(data: Measured) -> str:
    """On a measurement that reflects more light than arrives, or next to none."""
    albedo = data.rgb.albedo
    angles = zip(albedo.theta_i, albedo.means, strict=False)
    shares = {angle: share for angle, share in angles if angle < OBLIQUE and share > 0}
    if not shares:
        return ""
    angle = max(shares, key=lambda angle: shares[angle])
    share = shares[angle]
    if LEAST_LIGHT <= share <= GAIN:
        return ""
    what = f"the measurement reflects {format_share(share)} of the light at {angle:g}°"
    if share > GAIN:
        return (
            f"{what}, more than arrives: the values are in another unit than 1/sr, or hold a "
            "factor, as 100 of per cent; divide them by it"
        )
    return f"{what}, less than the blackest paints: the values may be in another unit than 1/sr"
