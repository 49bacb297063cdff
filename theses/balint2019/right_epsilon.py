"""Finds the right ε, the error bound of a march, for lights of several sizes, section 6.3."""

import numpy as np
from brdfkit.theses.balint2019 import scenes
from brdfkit.theses.balint2019.bands import FEW, INVERSES, SMOOTH, Light
from brdfkit.theses.balint2019.view import View

from brdfkit.core.jit.threads import in_turn
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 15
SIZE = 256
PRINTED = {0.25: 16, 0.5: 16, 1.0: 32, 2.0: 32, 4.0: 64}  # radius of the light → 1 / ε
PRINTED_TIMES = 34.47, 34.48, 39.42, 40.78, 54.19  # [ms]
LEVEL = 1 / 256  # the grey level of a display; a larger jump is a band
COARSE = 1 / 100  # another definition of a band, by higher jumps
PRACTICAL = 32  # the value of 1 / ε nearest to the largest one that the thesis calls useful
TEXT = f"""The complicated scene with a cylinder of radius 1, whose top is about 6 from the light;
`linear`, {SIZE} × {SIZE} pixels. The thesis judged by eye. Here a pixel lies on a *band* where the
error against τ(r_min) changes towards its neighbour by more than a grey level, 1/256, and the truth
by less than {SMOOTH:g}. The right ε is the largest of 1/2, 1/4 ... 1/256 at which less than
{100 * FEW:g} % of the pixels lie on one."""


@in_turn
def check_claims(sources, report):
    """Check the claims on the error bounds for lights of several sizes; return their section."""
    view, found = View(scenes.near_light(), SIZE), {}
    for done, radius in enumerate(PRINTED):
        found[radius] = Light(view, radius)
        report(done + 1, len(PRINTED))
    right = {radius: light.find_right_inverse(LEVEL) for radius, light in found.items()}
    claims = [
        claim_right(right),
        claim_tendency(found),
        claim_height(found),
        claim_time(found, right),
        claim_inverse(right),
        claim_gain(found),
    ]
    caption = "From the left: radius 0.25 at ε = 1/16 and 1/2, radius 4 at ε = 1/64 and 1/2."
    pictures = [
        Picture("right_epsilon", draw_shadows(view, found), f"Figures 6.11 to 6.14. {caption}"),
        Picture("evaluations", draw_evaluations(found), "Figure 6.10, in place of times."),
    ]
    return Section("The right ε", TEXT, claims, [make_table(found)], pictures)


def format_inverses(right):
    return ", ".join(f"1/{n}" if n else "none" for n in right)


def claim_right(right):
    """Claim that the right error bounds ε are those of the thesis."""
    same = sum(right[radius] == n for radius, n in PRINTED.items())
    return Claim(
        "The right ε of lights of radius 0.25, 0.5, 1, 2 and 4.",
        "6.3",
        format_inverses(PRINTED.values()),
        f"{format_inverses(right.values())}; {same} of {len(PRINTED)} equal",
        to_verdict(same == len(PRINTED)),
        "It depends on what one calls a band: see the table.",
    )


def claim_tendency(found):
    """Claim that larger lights need a smaller error bound ε."""
    small, large = found[min(found)], found[max(found)]
    ours = (
        f"1/{small.find_right_inverse(height)} to 1/{large.find_right_inverse(height)} by bands of "
        f"1/{1 / height:.0f}"
        for height in (LEVEL, COARSE)
    )
    return Claim(
        "The larger the light, the smaller ε has to be.",
        "6.3, 7",
        "1/16 to 1/64",
        ", ".join(ours),
        to_verdict(
            all(small.find_right_inverse(h) < large.find_right_inverse(h) for h in (LEVEL, COARSE))
        ),
        "Confirmed if both ideas of a band agree. Low bands cover more of the picture where the "
        "penumbra is larger; high ones are fewer, because they are further from each other.",
    )


def claim_height(found):
    """Claim that the height of errors depends on the light."""
    highest = [n * light.find_largest_error(n) for light in found.values() for n in (8, 16, 32, 64)]
    return Claim(
        "Small values are needed because the light is near and large.",
        "6.3",
        "no figure",
        f"the largest error is {min(highest):.2f} to {max(highest):.2f} ε for all radii",
        to_verdict(max(highest) > 2 * min(highest)),
        "So the height of the bands depends on ε alone; what grows with the light is the part of "
        "the picture that has them. Confirmed if the height changed by 2 times.",
    )


def claim_time(found, right):
    """Claim that the largest light takes longest at its right error bound ε."""
    ours = [light.evaluations[right[radius] or max(INVERSES)] for radius, light in found.items()]
    return Claim(
        "The largest light takes longest, at its right ε.",
        "6.3",
        f"{PRINTED_TIMES[-1] / PRINTED_TIMES[0]:.2f} times as long as the smallest, of frames",
        f"{ours[-1] / ours[0]:.2f} times as many evaluations",
        to_verdict(ours[-1] == max(ours) and ours[-1] > 1.2 * ours[0]),
    )


def claim_inverse(right):
    """Claim that the right error bound ε is inversely proportional to the light's size."""
    sizes = np.log(list(right))
    ours, printed = (
        np.polyfit(sizes, np.log([n or max(INVERSES) for n in values]), 1)[0]
        for values in (right.values(), PRINTED.values())
    )
    return Claim(
        "ε is to be inversely proportional to the size of the light.",
        "7",
        f"as its power {-printed:.1f}, by the printed values themselves",
        f"as its power {-ours:.1f}",
        to_verdict(0.8 < ours < 1.25),
        "Confirmed from -0.8 to -1.25.",
    )


def claim_gain(found):
    """Claim that an error bound ε below 1/30 brings nothing."""
    most = max(light.measure_banded_share(PRACTICAL, LEVEL) for light in found.values())
    largest = max(light.find_largest_error(PRACTICAL) for light in found.values())
    return Claim(
        "Below ε = 1/30 nothing gets better to the eye.",
        "6.2, 7",
        "by eye; section 6.3 has 1/64 for a large light",
        f"at 1/{PRACTICAL} up to {100 * most:.1f} % of the pixels lie on bands of a grey level, "
        f"and errors are {largest:.3f} at most",
        to_verdict(most < FEW),
        "Near lights only, as in section 6.3.",
    )


def make_table(found):
    """Return a table of the right error bounds ε by two heights of bands, and of banded pixels."""
    heads = "radius", "printed", "bands of 1/256", "bands of 1/100"
    rows = [
        (
            f"{radius:g}",
            f"1/{PRINTED[radius]}",
            *format_inverses(light.find_right_inverse(height) for height in (LEVEL, COARSE)).split(
                ", "
            ),
            *(f"{100 * light.measure_banded_share(n, LEVEL):.2f} %" for n in (16, 32, 64)),
            *(f"{light.find_largest_error(n):.3f}" for n in (16, 32, 64)),
        )
        for radius, light in found.items()
    ]
    shares_heads = [f"banded at 1/{n}" for n in (16, 32, 64)]
    errors_heads = [f"largest error at 1/{n}" for n in (16, 32, 64)]
    return Table((*heads, *shares_heads, *errors_heads), rows)


def draw_shadows(view, found):
    """Draw Figures 6.11 to 6.14: fine and coarse error bounds for a small and a large light."""
    drawn = make_figure(9, 2.5)
    small, large = min(found), max(found)
    shown = (small, 16), (small, 2), (large, 64), (large, 2)
    for axes, (radius, n) in zip(drawn.subplots(1, 4), shown, strict=True):
        axes.imshow(view.shade(found[radius].shares[n]), cmap="gray", vmin=0, vmax=1)
        axes.set_title(f"radius {radius:g}, ε = 1/{n}", size=9)
        axes.set_axis_off()
    return drawn


def draw_evaluations(found):
    """Draw the evaluations of a march over its inverse error bound, by the light's radius."""
    drawn = make_figure(5, 3)
    axes = drawn.subplots()
    for (radius, light), colour in zip(found.items(), COLOURS, strict=False):
        axes.loglog(
            *zip(*light.evaluations.items(), strict=True), "o-", color=colour, label=f"{radius:g}"
        )
    style_axes(axes, "by the radius of the light", "evaluations per point")
    axes.set_xlabel("1 / ε")
    axes.set_xticks(INVERSES, [str(n) for n in INVERSES])
    axes.set_yticks((20, 50, 100, 200), ("20", "50", "100", "200"))
    axes.minorticks_off()
    axes.legend(frameon=False)
    return drawn
