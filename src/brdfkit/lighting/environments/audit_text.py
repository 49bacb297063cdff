"""The text of an `EnvironmentAudit`: the rows and findings that `brdfkit info MAP.exr` prints."""

import math
from typing import TYPE_CHECKING

from brdfkit.lighting.environments.map_files import (
    EIGHT_BIT_WARNING,
    LARGEST_HALF_FLOAT,
    LATLONG,
)

if TYPE_CHECKING:
    from brdfkit.lighting.environments.auditing import EnvironmentAudit

# Tolerances: a larger value is a finding
ASPECT_TOLERANCE = 0.05  # relative deviation of width over height from 2
EQUAL_TOLERANCE = 4  # pixels that are as bright as the brightest one
BELOW_TOLERANCE = 2.0  # light from below over light from above


def rows(audit: "EnvironmentAudit") -> dict[str, str]:
    """Describe how bright the map is and from where; texts by heading."""
    x, y, z = audit.brightest
    elevation, azimuth = math.degrees(math.asin(y)), math.degrees(math.atan2(x, z))
    r, g, b = audit.colour
    return {
        "size": f"{audit.width} × {audit.height} pixels",
        "luminance": f"mean {audit.mean:.4g}, median {audit.median:.4g}, max {audit.largest:.4g}",
        "mean colour": f"R {r:.4g}, G {g:.4g}, B {b:.4g}",
        "dynamic range": _dynamic_range(audit),
        "brightest 1 %": f"{_percent(audit.brightest_share)} of the light comes from the brightest "
        "1 % of the solid angle",
        "from above": f"{_percent(audit.above)} of the light comes from above the horizon",
        "brightest spot": f"towards ({x:.2f}, {y:.2f}, {z:.2f}): {elevation:.0f}° above the "
        f"horizon, {azimuth:.0f}° from +z towards +x",
        "not finite": f"{audit.not_finite:,} pixels; negative: {audit.negative:,}",
    }


def findings(audit: "EnvironmentAudit") -> tuple[str, ...]:
    """Return a sentence on each likely defect of the map."""
    sentences = []
    if audit.not_finite:
        sentences.append(f"{audit.not_finite:,} pixels are not finite: no renderer can use the map")
    if audit.negative:
        sentences.append(
            f"{audit.negative:,} pixels are negative: light is never below 0; mend them"
        )
    if abs(audit.width / audit.height / LATLONG - 1) > ASPECT_TOLERANCE:
        sentences.append(
            f"{audit.width} × {audit.height} pixels are not twice as wide as high: perhaps another "
            "layout than latitude and longitude; 'brdfkit convert --from' makes it one"
        )
    if audit.eight_bit:
        sentences.append(EIGHT_BIT_WARNING)
    if not audit.largest:
        return (*sentences, "black all over: it lights nothing")
    if audit.equal == audit.width * audit.height:
        return (*sentences, "of one value all over: it has no lamps, and casts no shadows")
    if audit.equal > EQUAL_TOLERANCE and not audit.eight_bit:
        limit = ", the largest half float" if audit.data.max() >= LARGEST_HALF_FLOAT else ""
        sentences.append(
            f"{audit.equal:,} pixels share the largest luminance, {audit.largest:.4g}{limit}: "
            "clipped, unless a computer made the map"
        )
    if 1 - audit.above > BELOW_TOLERANCE * audit.above:
        sentences.append(
            f"{_percent(1 - audit.above)} of the light comes from below: perhaps upside down"
        )
    return tuple(sentences)


def _dynamic_range(audit: "EnvironmentAudit") -> str:
    """Describe the largest luminance over the median."""
    if not audit.median:
        return "without bound: half of the directions are black"
    ratio = audit.largest / audit.median
    return f"max over median {ratio:.3g}, {math.log2(ratio):.1f} stops"


def _percent(share: float) -> str:
    """Format a share in percent; NaN, of a black map, as "no share"."""
    return "no share" if math.isnan(share) else f"{100 * share:.3g} %"
