"""Warns in sentences of doubtful properties of a measurement.

Audits and fits print these warnings. The tests take milliseconds, so that every fit can run them.
"""

import math
from weakref import WeakKeyDictionary

import numpy as np

from brdfkit.core.names import format_percent
from brdfkit.materials.auditing.azimuth import compute_turned_error_ratio
from brdfkit.materials.auditing.cosine import explain_suspected_cosine
from brdfkit.materials.auditing.finding import Finding
from brdfkit.materials.auditing.highlight_sampling import warn_of_narrow_highlight
from brdfkit.materials.auditing.noise import estimate_noise
from brdfkit.materials.auditing.ratios import (
    GRAZING,
    STEEP,
    compute_backward_ratio,
    compute_grazing_ratio,
    compute_retroreflection_ratio,
)
from brdfkit.materials.auditing.subsets import draw_samples
from brdfkit.materials.auditing.symmetries import compare_reciprocal_values
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.conventions import can_mend
from brdfkit.materials.measured.coverage import is_in_plane
from brdfkit.model.samples import Samples
from brdfkit.regression.albedo import format_light_share

# Values are reported as not reciprocal if the relative difference of f(wi, wo) and f(wo, wi) is
# larger in the median of at least FEWEST_PAIRS pairs
RECIPROCITY_ERROR, FEWEST_PAIRS = 0.1, 20
# Median difference of two values that should be equal, over the standard deviation of their noise
NOISE_TO_DIFFERENCE = 0.6745 * math.sqrt(2)
# Values fall towards the horizon if the grazing ratio is below the first number, and a material is
# retroreflective if the retroreflection ratio is above the second. `ratios.py` computes both ratios
GRAZING_BELOW, RETROREFLECTIVE = 0.5, 5
# The highlight lies towards the light if the backward ratio exceeds BACKWARD, or if backward and
# retroreflection ratio exceed the two numbers of BACKWARD_WITH_LOBE. `ratios.py` computes both;
# rough plaster, with ratios of 3.5 and 1.6, is not reported
BACKWARD, BACKWARD_WITH_LOBE = 5, (2, 2.5)
# The highlight also lies towards the light if the backward ratio is at least LEAST_BACKWARD, and
# turning phi_o by 180° multiplies the error of a fitted model by less than TURNED_ERROR_BELOW
LEAST_BACKWARD, TURNED_ERROR_BELOW = 0.9, 0.3
SAME_ANGLE = 1.0  # degrees; angles of incidence that differ by less count as equal
ZERO_SHARE = 0.01  # a larger share of samples that are exactly 0 is reported
# If more values than this equal the same negative whole number, such as -9999, it is reported as a
# mark of missing data
MOST_EQUAL_NEGATIVE = 4
# An albedo above the first or below the second number, at incidences below OBLIQUE [degrees], means
# that the unit is wrong
LARGEST_ALBEDO, SMALLEST_ALBEDO = 1.25, 1e-3
OBLIQUE = 60
# The angles that a finding concerns, by its topic
WHERE = {
    "azimuth": "views at phi_o = phi_i, on the side of the light",
    "cosine": "all views, most at large theta_o",
}
# Directions whose cosine to the normal is larger count as directions along the normal
ALONG_NORMAL = math.cos(math.radians(5))

# The findings on each material, kept because every fit to the same material needs them again
_cache: WeakKeyDictionary[Measured, tuple[Finding, ...]] = WeakKeyDictionary()


def list_data_findings(data: Measured, max_angle: float = 90.0) -> tuple[str, ...]:
    """Return a sentence on each doubtful property of a `Measured` that quick tests reveal.

    `max_angle` [degrees] is the largest angle to the normal of the samples that a fit uses; faults
    beyond it are not reported.
    """
    found = find_faults(data)
    return tuple(str(f) for f in found if f.topic != "horizon" or max_angle > GRAZING)


def find_faults(data: Measured) -> tuple[Finding, ...]:
    """Return the doubtful properties of a `Measured` that quick tests reveal."""
    if data not in _cache:
        findings = (
            said if isinstance(said, Finding) else Finding(topic, said, WHERE.get(topic, ""))
            for topic, said in _test(data).items()
            if said
        )
        _cache[data] = tuple(findings)
    return _cache[data]


def _test(data: Measured) -> dict[str, str | Finding]:
    """Test a `Measured` for all kinds of faults; return what was found by topic, or nothing."""
    samples = draw_samples(data)
    cosine = _warn_of_cosine_factor(data)
    return {
        "azimuth": _warn_of_backward_highlight(data, samples),
        "cosine": cosine,
        "reciprocity": "" if cosine else _warn_of_broken_reciprocity(data),
        "horizon": "" if cosine else _warn_of_dark_horizon(samples),
        "plane": _warn_of_single_plane(samples),
        "incidence": _warn_of_single_incidence(samples),
        "highlight": "" if cosine else warn_of_narrow_highlight(data),
        "zero": _warn_of_zeros(samples),
        "sentinel": _warn_of_missing_value_mark(samples),
        "unit": _warn_of_wrong_unit(data),
    }


def _warn_of_backward_highlight(data: Measured, samples: Samples) -> Finding | str:
    """Return a warning of retroreflection, or of azimuths that are off by 180°, or ""."""
    ratio, near_light = compute_backward_ratio(samples), compute_retroreflection_ratio(samples)
    mendable = can_mend(data, "mirror_azimuth")
    beginning = ""
    has_lobe = ratio > BACKWARD_WITH_LOBE[0] and near_light > BACKWARD_WITH_LOBE[1]
    if ratio > BACKWARD or has_lobe:
        beginning = f"the values are {ratio:.2g} times as large towards the light as"
    elif (
        mendable
        and not ratio < LEAST_BACKWARD
        and compute_turned_error_ratio(samples) < TURNED_ERROR_BELOW
    ):
        beginning = "the highlight lies towards the light, and not"
    if beginning:
        text = (
            f"{beginning} in the mirror direction, phi_o = phi_i + 180°: either the material is "
            "retroreflective, which no lobe about the mirror direction can fit, or "
            "the instrument counts phi_o from the mirror's side"
        )
        if not mendable:
            return text
        remedy = ", which mirror_azimuth=True (--mirror-azimuth) mends"
        return Finding("azimuth", text, WHERE["azimuth"], "mirror_azimuth", remedy)
    if near_light > RETROREFLECTIVE:
        return (
            f"the material is retroreflective: the median within 5° of the light is "
            f"{near_light:.2g} times that elsewhere, which no lobe about the mirror direction can "
            "fit"
        )
    return ""


def _warn_of_cosine_factor(data: Measured) -> Finding | str:
    """Return a warning of values that seem to be the BRDF times cos theta_o, or ""."""
    why = explain_suspected_cosine(data)
    if not why:
        return ""
    text = f"the values seem to be the BRDF times cos theta_o, because {why}"
    if not can_mend(data, "divide_by_cos"):
        return text
    remedy = "; if they are, divide_by_cos=True (--divide-by-cos) mends them"
    return Finding("cosine", text, WHERE["cosine"], "divide_by_cos", remedy)


def _warn_of_broken_reciprocity(data: Measured) -> str:
    """Return a warning of values that are not reciprocal to within their noise, or ""."""
    difference = compare_reciprocal_values(data)
    if difference.pairs < FEWEST_PAIRS or not difference.median > RECIPROCITY_ERROR:
        return ""
    noise = [n for n in estimate_noise(data).relative if not math.isnan(n)]
    if difference.median <= 2 * NOISE_TO_DIFFERENCE * max(noise, default=0.0):
        return ""
    return (
        "the values are not reciprocal: exchanging wi and wo changes them by "
        f"{100 * difference.median:.0f} % in the median"
    )


def _warn_of_dark_horizon(samples: Samples) -> str:
    """Return a warning of values that fall towards the horizon, which is rare, or ""."""
    ratio = compute_grazing_ratio(samples)
    if not ratio < GRAZING_BELOW:
        return ""
    return (
        f"the values fall towards the horizon: the median beyond {GRAZING}° is {ratio:.2g} times "
        f"that between {STEEP[0]}° and {STEEP[1]}°, as of few surfaces; fit with a smaller "
        "max_angle"
    )


def _warn_of_single_plane(samples: Samples) -> str:
    """Return a warning of samples that all lie in the plane of incidence, or ""."""
    oblique = (samples.wi[:, 2] < ALONG_NORMAL) & (samples.wo[:, 2] < ALONG_NORMAL)
    oblique &= samples.valid
    if not oblique.any() or not is_in_plane(samples):
        return ""
    return (
        "the material was measured in the plane of incidence only: all beside it is a guess, also "
        "the albedo"
    )


def _warn_of_single_incidence(samples: Samples) -> str:
    """Return a warning of samples that all have the same angle of incidence, or ""."""
    angles = np.degrees(np.arccos(np.clip(samples.wi[samples.valid, 2], -1, 1)))
    if len(angles) < 2 or np.ptp(angles) > SAME_ANGLE:
        return ""
    return (
        f"the material was measured at one angle of incidence, {np.median(angles):.0f}°: how its "
        "highlight changes with that angle is a guess of the model's"
    )


def _warn_of_zeros(samples: Samples) -> str:
    """Return a warning of samples that are 0 in all channels, which no surface is, or ""."""
    share = (samples.values[samples.valid] == 0).all(axis=1).mean()
    if not share > ZERO_SHARE:
        return ""
    percent = format_percent(100 * share)
    return f"{percent} of the samples are exactly 0: probably clipped, or not measured"


def _warn_of_missing_value_mark(samples: Samples) -> str:
    """Return a warning of a mark for missing values, such as many values of -9999, or ""."""
    values = samples.values[samples.valid]
    whole = (values < 0) & (values == np.round(values))
    below, counts = np.unique(values[whole], return_counts=True)
    if not len(counts) or counts.max() <= MOST_EQUAL_NEGATIVE:
        return ""
    mark = below[counts.argmax()]
    return (
        f"{counts.max():,} values are exactly {mark:g}: probably a mark of what was not measured; "
        "leave those cells of the file empty"
    )


def _warn_of_wrong_unit(data: Measured) -> str:
    """Return a warning if an albedo above 1 or near 0 shows a wrong unit, otherwise ""."""
    albedo = data.rgb.albedo
    angles = zip(albedo.theta_i, albedo.means, strict=False)
    shares = {angle: share for angle, share in angles if angle < OBLIQUE and share > 0}
    if not shares:
        return ""
    angle = max(shares, key=lambda angle: shares[angle])
    share = shares[angle]
    if SMALLEST_ALBEDO <= share <= LARGEST_ALBEDO:
        return ""
    what = f"the measurement reflects {format_light_share(share)} of the light at {angle:g}°"
    if share > LARGEST_ALBEDO:
        return (
            f"{what}, more than arrives: the values are in another unit than 1/sr, or hold a "
            "factor, as 100 of per cent; divide them by it"
        )
    return f"{what}, less than the blackest paints: the values may be in another unit than 1/sr"
