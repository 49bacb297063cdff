"""Describes an `Audit` in words: the results and warnings that `brdfkit info` prints."""

import math
from typing import Any

from brdfkit.materials.auditing.albedos import Albedo
from brdfkit.materials.auditing.data_findings import find_faults
from brdfkit.materials.auditing.finding import Finding
from brdfkit.materials.auditing.noise import Noise
from brdfkit.materials.auditing.spikes import Spike
from brdfkit.materials.auditing.symmetries import Difference
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.coverage import Coverage
from brdfkit.materials.measured.evidence import describe_evidence
from brdfkit.materials.measured.spectrum_to_rgb import format_channels

MOST_SPIKES = 3  # largest number of spikes that are described one by one; the others are counted
NEGATIVE_SHARE = 0.01  # a larger share of negative values is reported as a finding
SPARSE = 0.1  # samples that are near to a smaller share of all pairs of directions are reported
BEYOND = " beyond them: there values are extrapolated"
LARGEST_ALBEDO = 1.001  # a larger albedo is reported; the quadrature has an error of up to 10⁻³


def describe_audit(audit: Any) -> dict[str, str]:
    """Describe the results of an `Audit`: what was measured, and how well.

    The texts are returned in a dictionary, by their headings.
    """
    unit = "cells" if audit.data.is_table else "samples"
    below = audit.size - audit.above
    beneath = f"; {below:,} at or below the horizon" if below else ""
    missing = audit.above - audit.valid
    return {
        "kind": audit.kind,
        "channels": format_channels(audit.channels),
        "valid": f"{audit.valid:,} of {audit.above:,} {unit}, {missing:,} not measured{beneath}",
        "negative": f"{_describe_negative_values(audit)}; exactly 0: {audit.zero:,}",
        "BRDF": _describe_value_range(audit),
        "angles": f"θi {_format_angles(audit.theta_i)}; θo {_format_angles(audit.theta_o)}",
        "coverage": _describe_coverage(audit.coverage, audit.data),
        **describe_evidence(audit.data),
        "reciprocity": _describe_reciprocity(audit),
        "mirror symmetry": _describe_difference(audit.mirror, "no mirrored pairs"),
        "noise": _describe_noise(audit.noise),
        **_describe_albedos(audit),
        "a fit uses": f"{audit.used:,} {unit}, {to_percent(audit.used / audit.valid)} of the "
        "valid: both angles below 80°",
    }


def list_findings(audit: Any) -> tuple[Finding, ...]:
    """Return each doubtful property that an `Audit` has found."""
    findings = [
        *(Finding("spike", text) for text in _describe_spikes(audit.spikes)),
        *(Finding("albedo", text) for text in _describe_excess_albedo(audit)),
    ]
    share = audit.negative / (audit.valid * len(audit.channels))
    if share > NEGATIVE_SHARE:
        text = (
            f"{to_percent(share)} of the values are negative: the losses log and cbrt treat them "
            "as 0"
        )
        findings.append(Finding("negative", text, f"most of them at {_format_negative(audit)}"))
    if text := _warn_of_few_measurements(audit):
        findings.append(Finding("coverage", text))
    return (*findings, *find_faults(audit.data))


def _warn_of_few_measurements(audit: Any) -> str:
    """Return a warning of samples that cover hardly any pairs of directions, or ""."""
    data, measured = audit.data, audit.coverage.measured
    if data.is_table or data.has_lookup or data.anisotropic or measured > SPARSE:
        return ""
    return (
        f"only {to_percent(measured)} of the pairs of directions are within 5° of a sample: albedo "
        "and pictures show what is interpolated between them, and brdfkit complete makes a better "
        "table, with intervals"
    )


def _format_negative(audit: Any) -> str:
    """Return the angles at which most of the negative values are."""
    return (
        f"{audit.negative_from:.0f}° to {audit.negative_to:.0f}° to the normal, the larger of θi "
        "and θo"
    )


def _describe_negative_values(audit: Any) -> str:
    """Describe how many of the values are below 0, and at which angles to the normal."""
    values = audit.valid * len(audit.channels)
    count = f"{audit.negative:,} of {values:,} values"
    if not audit.negative:
        return count
    return (
        f"{count}, {to_percent(audit.negative / values)}, most of them at {_format_negative(audit)}"
    )


def _describe_value_range(audit: Any) -> str:
    """Describe the smallest, largest and median BRDF value."""
    if math.isnan(audit.smallest):
        return "nowhere above 0"
    return f"{audit.smallest:.4g} to {audit.largest:.4g} sr⁻¹, median {audit.median:.4g}"


def _describe_coverage(coverage: Coverage, data: Measured) -> str:
    """Describe which shares of all pairs of directions were measured and are extrapolated."""
    shares = (coverage.measured, coverage.between, coverage.beyond)
    measured, between, beyond = map(to_percent, shares)
    if data.is_table and measured == "100 %":
        return "values in all cells; a table does not tell which of them were measured"
    how = "in valid cells" if data.is_table else "within 5° of a sample"
    how = "measured" if data.evidence is not None else how
    beyond += " beyond them" if data.evidence is not None else BEYOND
    return (
        f"{measured} of the pairs of directions {how}, {between} between measured angles, {beyond}"
    )


def _format_angles(angles: tuple[float, ...]) -> str:
    """Return a text that lists angles [degrees]; two angles become a range."""
    if len(angles) > 2:
        return ", ".join(f"{a:g}" for a in angles) + "°"
    return " to ".join(f"{a:g}°" for a in angles)


def to_percent(share: float) -> str:
    """Return a text with a share in percent, to two digits.

    A share above 0 is never rounded to 0, nor one below 0.99999 to 100 %.
    """
    share = 100 * share
    if 0 < share < 0.001:
        return "< 0.001 %"
    if 99.5 <= share < 99.999:
        return f"{min(share, 99.9):.1f} %"
    return f"{share:.0f} %" if share >= 9.95 or share == 0 else f"{share:.2g} %"


def _describe_reciprocity(audit: Any) -> str:
    """Describe how far values differ after exchanging the directions of light and view."""
    if audit.data.is_table and not audit.reciprocity and audit.data.table.phi_d_period < 4:
        return "by construction: the table holds each pair once"
    return _describe_difference(audit.reciprocity, "no pairs measured both ways")


def _describe_difference(difference: Difference, without: str) -> str:
    """Describe how far values that should be equal differ, or `without`, why none was compared."""
    if not difference:
        return f"not testable: {without}"
    return (
        f"{difference.pairs:,} pairs of values differ by {to_percent(difference.median)} in the "
        f"median, 95 % of them by at most {to_percent(difference.percentile_95)}"
    )


def _describe_noise(noise: Noise) -> str:
    """Describe the relative noise of the channels, and how it was estimated."""
    known = [n for n in noise.relative if not math.isnan(n)]
    if not known:
        return noise.method
    ends = dict.fromkeys(map(to_percent, (min(known), max(known))))
    return f"{' to '.join(ends)} of a value, from {noise.method}"


def _describe_albedos(audit: Any) -> dict[str, str]:
    """Describe the albedo of the interpolated BRDF, and, if it is known, that of the samples alone.

    The texts are returned in a dictionary, by their headings.
    """
    ends = _format_albedo_ranges(audit.albedo)
    rows = {"albedo": f"{ends}, over θi 0° to {audit.albedo.theta_i[-1]:g}°"}
    if audit.albedo_of_samples:
        low, high = audit.albedo_of_samples.theta_i[[0, -1]]
        ends = _format_albedo_ranges(audit.albedo_of_samples)
        rows["albedo of samples"] = (
            f"{ends}, over θi {low:g}° to {high:g}°, linear between the samples"
        )
    return rows


def _format_albedo_ranges(albedo: Albedo) -> str:
    """Return a text with the smallest and the largest albedo of each channel."""
    columns = zip(albedo.channels, albedo.values.T, strict=True)
    return ", ".join(f"{name} {a.min():.3f} to {a.max():.3f}" for name, a in columns)


def _describe_excess_albedo(audit: Any) -> list[str]:
    """Return a sentence on each albedo, interpolated or of the samples alone, that exceeds 1."""
    sentences = []
    for albedo, what in (
        (audit.albedo, "albedo, interpolated," if audit.albedo_of_samples else "albedo"),
        (audit.albedo_of_samples, "albedo, linear between the samples,"),
    ):
        if albedo is None or albedo.brightest.max() <= LARGEST_ALBEDO:
            continue
        row, column = divmod(int(albedo.brightest.argmax()), albedo.brightest.shape[1])
        theta_i, channel = albedo.theta_i[row], albedo.channels[column]
        most, mean = albedo.brightest[row, column], albedo.values[row, column]
        side = f" from the brightest side, {mean:.3f} in the mean" if most > 1.01 * mean else ""
        beyond = " (extrapolated)" if theta_i > albedo.measured_to + 1 else ""
        sentences.append(
            f"{what} {most:.3f} at θi {theta_i:g}°{beyond}{side}, channel "
            f"{channel}: more light leaves than arrives"
        )
    return sentences


def _describe_spikes(spikes: tuple[Spike, ...]) -> list[str]:
    """Return a sentence on each of the worst spikes, and one that counts the others."""
    named = [f"spike at {spike}" for spike in spikes[:MOST_SPIKES]]
    more = len(spikes) - MOST_SPIKES
    return [*named, f"and {more:,} more spikes"] if more > 0 else named
