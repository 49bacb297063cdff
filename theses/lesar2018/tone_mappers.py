"""Checks the thesis's tone mappers, eq. 6.4 and 6.5, and reproduces Figure 7.2 by them."""

import numpy as np
from brdfkit.theses.lesar2018.iterations import make_stage
from brdfkit.theses.lesar2018.scans import find_scans

from brdfkit.core.colours import to_srgb
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.images.tone_mapping import ToneMapping
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section

SECONDS = 4
SIZE, SPP, FEWER = 256, 16, 1
EXPOSURES = 0.3, 1.0, 8.0
TEXT = """Maximum intensities of a scan, told over its largest value, by the range 0 to 1, by a
narrower one, and by Reinhard's with two exposures. The thesis shows such pictures, and says neither
its settings nor whether sRGB's curve follows; here it does."""


@in_turn
def check_claims(sources, report):
    """Check the claims on tone mappers; return their section of the page."""
    use_variant()
    import mitsuba as mi

    scan = find_scans(sources, FEWER)[0]
    report(1, 3)
    volume = {"type": "maximum_intensity", "volume": scan.density.scene_dict()}
    found = np.array(
        mi.render(make_stage(volume, SIZE, scan.eye, scan.up, lit=False), spp=SPP), float
    )
    light = found / scan.density.range[1]
    seen = light[light > 0]
    low, high = np.percentile(seen, [30, 99.5]).round(2).tolist()
    shown = [
        ToneMapping("range"),
        ToneMapping("range", low=low, high=high),
        ToneMapping("reinhard", exposure=1),
        ToneMapping("reinhard", exposure=4),
    ]
    caption = f"{scan.name} by four tone mappers, and their curves."
    picture = Picture("tone_mappers", draw_tone_mappers(light, shown), caption)
    claims = [claim_range(seen, low, high), claim_reinhard()]
    return Section("Tone mappers", TEXT, claims, pictures=[picture])


def claim_range(seen, low, high):
    """Claim that a window loses values outside of it."""
    lost = np.mean((seen <= low) | (seen >= high))
    inside = np.linspace(low, high, 101)[1:-1]
    tone = ToneMapping("range", low=low, high=high)
    linear = np.abs(tone(inside) - (inside - low) / (high - low)).max()
    return Claim(
        "The range loses everything outside of its window.",
        "eq. 6.4, Figure 7.2",
        "no figure",
        f"{100 * lost:.0f} % of the pixels are black or white, of a window from {low:.2f} to "
        f"{high:.2f}",
        to_verdict(lost > 0 and linear < 1e-12),
        "The window is chosen so that it loses 30 % of the pixels.",
        arithmetic=True,
    )


def claim_reinhard():
    """Claim that Reinhard's tone mapper rises and can be inverted."""
    light = np.linspace(0, 1000, 100_001)
    off, rises, largest = 0.0, True, 0.0
    for exposure in EXPOSURES:
        shown = ToneMapping("reinhard", exposure=exposure)(light)
        off = max(off, np.abs(shown / (exposure * (1 - shown)) - light).max() / light.max())
        rises = rises and bool((np.diff(shown) > 0).all())
        largest = max(largest, shown.max())
    return Claim(
        "Reinhard's is injective and rises, from 0 and ∞ to 0 and 1.",
        "eq. 6.5",
        "[0, ∞) → [0, 1]",
        f"rises everywhere, {largest:.5f} at 1000; its inverse is off by {off:.0e}",
        to_verdict(rises and largest < 1 and off < 1e-9),
        "1 itself is not reached. As ε L / (1 + ε L) it is black for ε = 0, which "
        "L / (1/ε + L), as printed, is not.",
        arithmetic=True,
    )


def draw_tone_mappers(light, shown):
    """Draw the pictures by four tone mappers, and their curves."""
    drawn = make_figure(9, 4.4)
    above, below = drawn.subfigures(2, 1, height_ratios=(1.3, 1))
    for axes, tone in zip(above.subplots(1, len(shown)), shown, strict=True):
        axes.imshow(to_srgb(tone(light)))
        axes.set_title(str(tone) or "range 0 to 1", size=9)
        axes.set_axis_off()
    axes, x = below.subplots(), np.linspace(0, 1.2, 300)
    for tone, colour in zip(shown, COLOURS, strict=False):
        axes.plot(x, tone(x), color=colour, label=str(tone) or "range 0 to 1")
    axes.set_xlabel("intensity")
    axes.legend(fontsize=7)
    style_axes(axes, "", "shown, linear")
    return drawn
