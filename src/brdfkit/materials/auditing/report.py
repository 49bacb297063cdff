"""An `Audit` in words: the rows and sentences that `brdfkit info` prints."""

import math

from brdfkit.materials.auditing.data_findings import data_findings
from brdfkit.materials.measured.coverage import Coverage

MOST_SPIKES = 3  # spikes that are named; the others are counted
# What is above is a finding:
SHARE = 0.01  # the share of negative values
BRIGHT = 1.001  # the albedo; its quadrature is accurate to 10⁻³


def rows(audit):
    """What was measured and how well: texts by heading."""
    unit = "cells" if audit.data.is_table else "samples"
    below = audit.size - audit.above
    beneath = f"; {below:,} at or below the horizon" if below else ""
    values = audit.valid * len(audit.channels)
    missing = audit.above - audit.valid
    return {
        "kind": audit.kind,
        "channels": _channels(audit.channels),
        "valid": f"{audit.valid:,} of {audit.above:,} {unit}, {missing:,} not measured{beneath}",
        "negative": f"{_negative(audit, values)}; exactly 0: {audit.zero:,}",
        "BRDF": _range(audit),
        "angles": f"θi {_angles(audit.theta_i)}; θo {_angles(audit.theta_o)}",
        "coverage": _coverage(audit.coverage, audit.data.is_table),
        "reciprocity": _reciprocity(audit),
        "mirror symmetry": _difference(audit.mirror, "no mirrored pairs"),
        "noise": _noise(audit.noise),
        **_albedos(audit),
        "a fit uses": f"{audit.used:,} {unit}, {percent(audit.used / audit.valid)} of the valid: "
        "both angles below 80°",
    }


def findings(audit):
    """What is doubtful: a sentence on each finding."""
    found = [*_spikes(audit.spikes), *_energy(audit)]
    values = audit.valid * len(audit.channels)
    if audit.negative > SHARE * values:
        found.append(
            f"{percent(audit.negative / values)} of the values are negative: the losses log and "
            "cbrt treat them as 0"
        )
    return (*found, *data_findings(audit.data))


def _negative(audit, values):
    """How many of the `values` are below 0, and where."""
    count = f"{audit.negative:,} of {values:,} values"
    if not audit.negative:
        return count
    return (
        f"{count}, {percent(audit.negative / values)}, most of them at {audit.negative_from:.0f}° "
        f"to {audit.negative_to:.0f}° to the normal, the larger of θi and θo"
    )


def _channels(names):
    if len(names) > 5:
        return f"{len(names)} wavelengths, {names[0]} to {names[-1]}"
    return " ".join(names)


def _range(audit):
    if math.isnan(audit.smallest):
        return "nowhere above 0"
    return f"{audit.smallest:.4g} to {audit.largest:.4g} sr⁻¹, median {audit.median:.4g}"


def _coverage(reach: Coverage, is_table: bool) -> str:
    """What was measured; a table does not tell what was interpolated before it was written."""
    shares = (reach.measured, reach.between, reach.beyond)
    measured, between, beyond = map(percent, shares)
    if is_table and measured == "100 %":
        return "values in all cells; a table does not tell which of them were measured"
    how = "in valid cells" if is_table else "within 5° of a sample"
    return (
        f"{measured} of the pairs of directions {how}, {between} between measured angles, "
        f"{beyond} beyond them: there values are extrapolated"
    )


def _angles(angles):
    if len(angles) > 2:
        return ", ".join(f"{a:g}" for a in angles) + "°"
    return " to ".join(f"{a:g}°" for a in angles)


def percent(share):
    """A share in percent, to two digits; one above 0 is never shown as 0, one below 1 as 100."""
    share = 100 * share
    if 0 < share < 0.001:
        return "< 0.001 %"
    if 99.5 <= share < 99.999:
        return f"{min(share, 99.9):.1f} %"
    return f"{share:.0f} %" if share >= 9.95 or share == 0 else f"{share:.2g} %"


def _reciprocity(audit):
    if audit.data.is_table and not audit.reciprocity and audit.data.table.phi_d_period < 4:
        return "by construction: the table holds each pair once"
    return _difference(audit.reciprocity, "no pairs measured both ways")


def _difference(found, without):
    if not found:
        return f"not testable: {without}"
    return (
        f"{found.pairs:,} pairs of values differ by {percent(found.median)} in the median, "
        f"95 % of them by at most {percent(found.percentile_95)}"
    )


def _noise(noise):
    known = [n for n in noise.relative if not math.isnan(n)]
    if not known:
        return noise.method
    ends = dict.fromkeys(map(percent, (min(known), max(known))))
    return f"{' to '.join(ends)} of a value, from {noise.method}"


def _albedos(audit):
    rows = {"albedo": f"{_ends(audit.albedo)}, over θi 0° to {audit.albedo.theta_i[-1]:g}°"}
    if audit.albedo_of_samples:
        low, high = audit.albedo_of_samples.theta_i[[0, -1]]
        ends = _ends(audit.albedo_of_samples)
        rows["albedo of samples"] = (
            f"{ends}, over θi {low:g}° to {high:g}°, linear between the samples"
        )
    return rows


def _ends(albedo):
    columns = zip(albedo.channels, albedo.values.T, strict=True)
    return ", ".join(f"{name} {a.min():.3f} to {a.max():.3f}" for name, a in columns)


def _energy(audit):
    """A sentence on each albedo that is above 1."""
    found = []
    for albedo, what in (
        (audit.albedo, "albedo, interpolated," if audit.albedo_of_samples else "albedo"),
        (audit.albedo_of_samples, "albedo, linear between the samples,"),
    ):
        if albedo is None or albedo.brightest.max() <= BRIGHT:
            continue
        row, column = divmod(int(albedo.brightest.argmax()), albedo.brightest.shape[1])
        theta_i, channel = albedo.theta_i[row], albedo.channels[column]
        most, mean = albedo.brightest[row, column], albedo.values[row, column]
        side = f" from the brightest side, {mean:.3f} in the mean" if most > 1.01 * mean else ""
        beyond = " (extrapolated)" if theta_i > albedo.measured_to + 1 else ""
        found.append(
            f"{what} {most:.3f} at θi {theta_i:g}°{beyond}{side}, channel "
            f"{channel}: more light leaves than arrives"
        )
    return found


def _spikes(spikes):
    """A sentence on each of the worst spikes, and one on the number of the others."""
    named = [f"spike at {spike}" for spike in spikes[:MOST_SPIKES]]
    rest = len(spikes) - MOST_SPIKES
    return [*named, f"and {rest:,} more spikes"] if rest > 0 else named
