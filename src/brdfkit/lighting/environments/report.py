"""An `EnvironmentAudit` in words: the rows and sentences that `brdfkit info MAP.exr` prints."""

import math

from brdfkit.lighting.environments.map_files import EIGHT_BIT_TOLD, HALF, LATLONG

# What is beyond is a finding:
ASPECT = 0.05  # the width over the height, relative to 2
EQUAL = 4  # pixels that are as bright as the brightest
BELOW = 2.0  # the light from below over that from above


def rows(audit):
    """How bright the map is, and from where: texts by heading."""
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


def findings(audit):
    """What is doubtful: a sentence on each finding."""
    found = []
    if audit.not_finite:
        found.append(f"{audit.not_finite:,} pixels are not finite: no renderer can use the map")
    if audit.negative:
        found.append(f"{audit.negative:,} pixels are negative: light is never below 0; mend them")
    if abs(audit.width / audit.height / LATLONG - 1) > ASPECT:
        found.append(
            f"{audit.width} × {audit.height} pixels are not twice as wide as high: perhaps another "
            "layout than latitude and longitude; 'brdfkit convert --from' makes it one"
        )
    if audit.eight_bit:
        found.append(EIGHT_BIT_TOLD)
    if not audit.largest:
        return (*found, "black all over: it lights nothing")
    if audit.equal == audit.width * audit.height:
        return (*found, "of one value all over: it has no lamps, and casts no shadows")
    if audit.equal > EQUAL and not audit.eight_bit:
        limit = ", the largest half float" if audit.data.max() >= HALF else ""
        found.append(
            f"{audit.equal:,} pixels share the largest luminance, {audit.largest:.4g}{limit}: "
            "clipped, unless a computer made the map"
        )
    if 1 - audit.above > BELOW * audit.above:
        found.append(
            f"{_percent(1 - audit.above)} of the light comes from below: perhaps upside down"
        )
    return tuple(found)


def _dynamic_range(audit):
    if not audit.median:
        return "without bound: half of the directions are black"
    ratio = audit.largest / audit.median
    return f"max over median {ratio:.3g}, {math.log2(ratio):.1f} stops"


def _percent(share):
    return "no share" if math.isnan(share) else f"{100 * share:.3g} %"
