"""Writes the page of `make_shadow_map_gradients.py` and its figure, from the measurements."""

from pathlib import Path

import numpy as np
from leaderboard.page import describe_versions
from make_models import join_paragraphs, make_table

from brdfkit.theses.drawing import COLOURS, make_figure, style_axes

PAGE = Path(__file__).parents[2] / "shadow_map_gradients.md"
RESOLUTION = 512  # texels along a side of a map
RESOLUTIONS = 128, 256, RESOLUTION, 1024
# Techniques by name: filters that average moments of depth, then filters that compare depths
MOMENTS = {
    "variance": {"filter": "variance"},
    "moment": {"filter": "moment"},
    "moment (ε = 0; blur 4)": {"filter": "moment", "bleeding": 0.0, "blur": 4},
    "exponential_variance": {"filter": "exponential_variance"},
    "exponential_variance (c⁻ = 0)": {"filter": "exponential_variance", "negative_exponent": 0.0},
}
COMPARE = (
    "depth",
    "percentage_closer",
    "bilinear_percentage_closer",
    "poisson_disk",
    "percentage_closer_soft",
    "projective_texture",
)
FILTERS = MOMENTS | {name: {"filter": name} for name in COMPARE}
PLAIN, HARD = ("box", "ring"), ("fence", "plates")
BAR, BAR_IN_PERCENT = 0.05, "5 %"


def write_page(by_dr_jit, by_differences, by_rays):
    """Write the page from the three dictionaries of `measure_derivatives`."""
    truth = max(compute_relative_error(*pair) for pair in by_rays.values())
    zero = max(np.abs(found).max() for key, (_, found) in by_dr_jit.items() if key[2] in COMPARE)
    if zero > 0:
        raise ValueError("filters that compare have derivatives: rewrite the page's words.")
    text = join_paragraphs(
        INTRODUCTION.format(truth=100 * truth, versions=describe_versions()),
        "## What to take",
        write_advice(by_dr_jit),
        "## By filter and projection",
        PROJECTIONS,
        make_projections_table(by_dr_jit),
        "## Where they go wrong",
        SCENES,
        make_scenes_table(by_dr_jit, by_differences),
        "## By the number of texels",
        TEXELS,
        make_resolutions_table(by_dr_jit),
        "## Filters without a derivative",
        ZERO,
    )
    PAGE.write_text(text, encoding="utf-8")
    draw_derivatives(by_dr_jit).savefig(PAGE.with_suffix(".png"), dpi=90)


INTRODUCTION = """# Gradients of shadow maps, and their bias

Whoever looks for a scene by its shadows asks for the derivative of a shadow by the place of what
casts it. A shadow map has one only if its filter changes steadily; and if it has, is it right? Here
are nine soft patches of ground, each lit in part, and the derivatives of their light by the place
(x, y, z) of the thing above them, as Dr.Jit finds them through
[shadow maps](plugins/shadow_map.md).

![Derivatives by shadow maps over exact ones](shadow_map_gradients.png)

Each is held to the exact derivative: the integral, along the borders of shadows, of their velocity,
where rays on both sides tell what is a border. Differences of dense shadow rays agree with it to
{truth:.1f} %.

- **slope**: of the derivatives by a map over the exact ones, Σ g·t / Σ t·t; 1 at best. What it
  lacks is the bias: a descent goes the right way in shorter or longer steps.
- **off**: how far they are from the exact ones in all, ‖g - t‖ / ‖t‖: bias and noise.

Maps have 512² texels and defaults, and the lights are a sun and a lamp, where nothing else is
said. Made by `python docs/tools/make_shadow_map_gradients.py`: {versions}."""

PROJECTIONS = """The slope over a box and a faceted ring in both lights, and in brackets off, in per
cent."""

SCENES = """Focused maps, both lights. *Picture* is the slope, and in brackets off, of differences
of the filter's own pictures: what its derivative should be if it were that of the picture. ε is the
setting `bleeding`, c⁻ is `negative_exponent`.

A box and a ring cast plain shadows. The bars of the fence are narrower than the window over which
moments are averaged. Two plates, of which the upper one moves, cast shadows that cross.

At the fence derivatives are as wrong as the pictures of their filters. Elsewhere they are right
within a few per cent, between plates, too, where a window holds three depths."""

TEXELS = """The slope over the box and the ring, and in brackets off, in per cent. Coarse maps have
hardly more bias than fine ones, but more noise. A wide blur wants a fine map."""

ZERO = f"""{", ".join(f"`{name}`" for name in COMPARE)}:
these compare the depth of a texel with that of the point, lit or not, and average then. The
derivative of a comparison is 0, and so was each of theirs, in all projections, scenes and lights,
although their pictures do change. To average more texels changes nothing of that. For pictures
take any of them; for descents none."""


def compute_slope(true, found):
    """Return the slope Σ g·t / Σ t·t of measured derivatives g over exact ones t."""
    return float((found * true).sum() / np.square(true).sum())


def compute_relative_error(true, found):
    """Return the relative error ‖g - t‖ / ‖t‖ of measured derivatives g from exact ones t."""
    return float(np.linalg.norm(found - true) / np.linalg.norm(true))


def join_patches(found, scenes, *key):
    """Return the (exact, measured) derivatives of some `scenes` in all lights, joined.

    `found`: pairs of derivatives by (scene, light, ...); `key`: the rest of their keys.
    """
    pairs = [pair for its, pair in found.items() if its[0] in scenes and its[2:] == key]
    return tuple(np.concatenate(side) for side in zip(*pairs, strict=True))


def format_cell(pair):
    """Return the slope and relative error of a pair (exact, measured) as text."""
    return f"{compute_slope(*pair):.3f} ({100 * compute_relative_error(*pair):.0f})"


def make_projections_table(found):
    """Return the table of errors with a row for each projection and a column for each filter."""
    projections = dict.fromkeys(key[3] for key in found)
    rows = [
        (
            f"`{p}`",
            *(format_cell(join_patches(found, PLAIN, its, p, RESOLUTION)) for its in MOMENTS),
        )
        for p in projections
    ]
    return make_table(", ".join(["projection", *MOMENTS]), rows)


def make_scenes_table(found, differences):
    """Return the table of errors with a row for each scene and filter."""
    rows = []
    for scene in PLAIN + HARD:
        for its in MOMENTS:
            derivative = join_patches(found, [scene], its, "focused", RESOLUTION)
            picture = join_patches(differences, [scene], its)
            rows.append((scene, its, format_cell(derivative), format_cell(picture)))
    return make_table("scene, filter, derivative, picture", rows)


def make_resolutions_table(found):
    """Return the table of errors with a row for each resolution and a column for each filter."""
    rows = [
        (f"{n}²", *(format_cell(join_patches(found, PLAIN, its, "focused", n)) for its in MOMENTS))
        for n in RESOLUTIONS
    ]
    return make_table(", ".join(["texels", *MOMENTS]), rows)


def write_advice(found):
    """Return sentences that recommend filters with small errors, with numbers."""
    lines, good = [], []
    for its in MOMENTS:
        plain = {
            p: compute_slope(*join_patches(found, PLAIN, its, p, RESOLUTION))
            for p in dict.fromkeys(key[3] for key in found)
        }
        fence, plates = (
            100 * compute_relative_error(*join_patches(found, [scene], its, "focused", RESOLUTION))
            for scene in HARD
        )
        within = sum(abs(s - 1) <= BAR for s in plain.values())
        if within == len(plain):
            good.append(f"`{its}`")
        low, high = min(plain, key=plain.get), max(plain, key=plain.get)
        lines.append(
            f"- `{its}`: slopes from {plain[low]:.3f} ({low}) to {plain[high]:.3f} ({high}), "
            f"{within} of {len(plain)} within {BAR_IN_PERCENT}; off by {fence:.0f} % over the "
            f"fence, {plates:.0f} % between plates."
        )
    named = " or ".join(filter(None, (", ".join(good[:-1]), good[-1])))
    verdict = (
        f"{named}: over a box and a ring their slopes are within "
        f"{BAR_IN_PERCENT} in all projections."
    )
    return "\n".join([verdict, "", *lines])


def draw_derivatives(found):
    """Return the figure of measured derivatives over exact ones, of plain and of hard scenes."""
    drawn = make_figure(11, 4.6)
    for axes, scenes in zip(drawn.subplots(1, 2), (PLAIN, HARD), strict=True):
        for its, colour in zip((*MOMENTS, "depth"), (*COLOURS[:5], "0.6"), strict=True):
            true, by_map = join_patches(found, scenes, its, "focused", RESOLUTION)
            label = "all that compare depths" if its == "depth" else its
            axes.plot(true.ravel(), by_map.ravel(), ".", color=colour, label=label)
        most = 1.1 * np.abs(true).max()
        axes.plot([-most, most], [-most, most], color="0.3", linewidth=0.8)
        axes.set(xlim=(-most, most), ylim=(-most, most), xlabel="exact derivative")
        style_axes(axes, " and ".join(scenes), "derivative by the map")
    drawn.axes[0].legend(frameon=False)
    return drawn
