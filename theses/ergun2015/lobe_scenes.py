"""Counts by method how many of 80 scenes, lit through Gaussian lobes, are near the truth.

The scenes combine shapes, environment maps and roughnesses.
"""

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import (
    FILTERS,
    METHODS,
    ROUGHNESSES,
    SAMPLES,
    SIZE,
    compute_psnr,
    find_probes,
    make_integrators,
    make_ward_bsdf,
    render_filtered,
    render_reference,
)
from brdfkit.theses.ergun2015.shapes import find_meshes, make_torus_scene

from brdfkit.core.colours import to_srgb
from brdfkit.core.jit.llvm import use_variant
from brdfkit.core.jit.threads import in_turn
from brdfkit.rendering.scene_input.environment import describe_environment
from brdfkit.rendering.scene_input.loading import find_scene
from brdfkit.rendering.scene_input.material import find_material_mask
from brdfkit.theses.claims import UNSTATED, Claim, to_verdict
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 150
GOOD = 30  # dB: the PSNR from which a scene counts
PRINTED = {"kde": 61, "warped": 53, "filtered_sampling": 52}  # of 80 scenes, with mips
CLOSE = 0.1  # of the scenes: two counts that differ by less are called near
HALVES = 6.02  # dB by which the mean of two halves is better than their difference
DIFFERENCE = 5  # the factor by which the figure enlarges differences
TEXT = f"""Ball, torus, teapot and bunny (for the dragon) in each map, with Ward's lobe of five
roughnesses α, k_d = 0.1 and k_s = 0.4; without shadows, as in the thesis. Every map is scaled to
the same illuminance from above. {SIZE} × {SIZE} pixels; the truth is by {SAMPLES:,} samples of the
light and as many of the BSDF, through the same middles of pixels. PSNR is over the pixels of the
shape, of 8-bit sRGB, and of linear values with the 99.9th percentile as the peak. *mips*: levels of
the map as graphics hardware makes them, as in the thesis; *lobes*: levels convolved with lobes."""


@in_turn
def check_claims(sources, report):
    """Check the claims on 80 scenes by methods with Gaussian lobes; return their section."""
    use_variant()
    shapes = {"ball": find_scene("ball"), "torus": make_torus_scene}
    meshes = find_meshes(sources, ["teapot", "stanford-bunny"])
    shapes |= {name: shape.build for name, shape in meshes.items()}
    probes = find_probes(sources)
    total, found, floors, balls = len(shapes) * len(probes) * len(ROUGHNESSES), [], [], []
    bsdfs, methods = [make_ward_bsdf(alpha) for alpha in ROUGHNESSES], make_integrators()
    for probe, file in probes.items():
        light = load_light(file)
        for shape, build in shapes.items():
            for bsdf in bsdfs:
                made = build(bsdf, (SIZE, SIZE))
                halves, pictures, seen = render_pictures(made, light, bsdf, methods)
                reference = np.mean(halves, axis=0)
                floors.append([d + HALVES for d in compute_psnr(*halves, seen)])
                found.append([compute_psnr(reference, p, seen) for p in pictures.values()])
                if shape == "ball" and probe == next(iter(probes)):
                    balls.append([reference, *pictures.values()])
                report(len(found), total)
    kinds = [f"{method}, {filter_}" for method, filter_ in methods]
    by_kind = dict(zip(kinds, np.moveaxis(found, 1, 0), strict=True))  # arrays (scenes, 2)
    claims = [claim_best(by_kind), claim_near(by_kind), claim_gmm(by_kind), claim_matte(by_kind)]
    pictures = [
        Picture("lobe_roughness", draw_curves(by_kind), "Mean over shapes and maps."),
        Picture("lobe_balls", draw_balls(balls), describe_balls(next(iter(probes)))),
    ]
    return Section("80 scenes by lobes", TEXT, claims, [make_table(by_kind, floors)], pictures)


def load_light(file):
    """Return the emitter of an environment map."""
    import mitsuba as mi

    return mi.load_dict(describe_environment(file), parallel=False)


def render_pictures(made, light, bsdf, methods):
    """Return halves of the truth, the picture by each method and filter, and the BSDF's pixels."""
    halves, scene = render_reference(made, light)
    pictures = {kind: render_filtered(made, light, by)[0] for kind, by in methods.items()}
    return halves, pictures, find_material_mask(scene, bsdf)


def count_good_scenes(by_kind, method, filter_="mips"):
    """Return how many scenes a method has over 30 dB, of 8-bit sRGB."""
    return int((by_kind[f"{method}, {filter_}"][:, 0] >= GOOD).sum())


def claim_best(by_kind):
    """Claim that kernels have more scenes over 30 dB than other methods."""
    ours = {method: count_good_scenes(by_kind, method) for method in PRINTED}
    return Claim(
        "Of three methods, kernels (KDE) have most scenes over 30 dB.",
        "9.3",
        ", ".join(f"{name} {count}" for name, count in PRINTED.items()) + " of 80",
        ", ".join(f"{name} {count}" for name, count in ours.items())
        + f" of {count_scenes(by_kind)}",
        to_verdict(ours["kde"] == max(ours.values())),
        "The thesis names no BRDF, no PSNR and no number of kernels; ours has 32, with the width "
        "corrected that they add.",
    )


def claim_near(by_kind):
    """Claim that one warped lobe and filtered sampling have about as many scenes over 30 dB."""
    ours = [count_good_scenes(by_kind, method) for method in ("warped", "filtered_sampling")]
    return Claim(
        "One warped lobe [Wang et al. 2009] has as many as filtered sampling.",
        "9.3",
        "53 and 52 of 80",
        f"{ours[0]} and {ours[1]} of {count_scenes(by_kind)}",
        to_verdict(abs(ours[0] - ours[1]) <= CLOSE * count_scenes(by_kind)),
        "Filtered sampling takes 64 directions here; the thesis does not say how many. The warped "
        "lobe meets the map by mips; where the maps are convolved with lobes, as Wang's are, it "
        f"has {count_good_scenes(by_kind, 'warped', 'lobes')}.",
    )


def claim_gmm(by_kind):
    """State how many scenes Gaussian mixtures have over 30 dB, which the thesis leaves out."""
    best = {filter_: count_good_scenes(by_kind, "gmm", filter_) for filter_ in FILTERS}
    return Claim(
        "Scenes over 30 dB by mixtures (GMM).",
        "9.3",
        "not given",
        f"{best['mips']} of {count_scenes(by_kind)} by mips, {best['lobes']} by maps of lobes",
        UNSTATED,
        "With views interpolated, which the thesis leaves out.",
    )


def claim_matte(by_kind):
    """Claim that one lobe with mips is the worst method on rough materials."""
    means = {
        kind: average_by_roughness(values) for kind, values in by_kind.items() if "mips" in kind
    }
    ours = means["warped, mips"]
    worst = all(ours[-1] <= others[-1] for others in means.values())
    return Claim(
        "One warped lobe with mips is worst on matte materials.",
        "8.6",
        "no figure",
        f"{ours[0]:.1f} dB at α = {ROUGHNESSES[0]:g}, {ours[-1]:.1f} dB at {ROUGHNESSES[-1]:g}; "
        f"{'the lowest' if worst else 'not the lowest'} of {len(means)} methods there",
        to_verdict(worst and ours[-1] == ours.min()),
        "A wide lobe is one texel of a coarse level, whose edges show.",
    )


def count_scenes(by_kind):
    """Return how many scenes were rendered."""
    return len(next(iter(by_kind.values())))


def average_by_roughness(values):
    """Return mean PSNRs of 8-bit sRGB by roughness, of values (scenes, 2).

    The roughness varies first among the scenes.
    """
    return values[:, 0].reshape(-1, len(ROUGHNESSES)).mean(axis=0)


def make_table(by_kind, floors):
    """Return a table of counts and PSNRs by method and filter."""
    heads = "method", "scenes over 30 dB", "printed", "mean [dB]", "worst [dB]", "over, linear"
    rows = []
    for kind, values in by_kind.items():
        method, filter_ = kind.split(", ")
        printed = PRINTED.get(method, "") if filter_ == "mips" else ""
        counts = (values >= GOOD).sum(axis=0)
        mean, worst = values[:, 0].mean(), values[:, 0].min()
        rows.append((kind, counts[0], printed, f"{mean:.1f}", f"{worst:.1f}", counts[1]))
    eight, linear = np.min(floors, axis=0)
    caption = (
        f"Of {count_scenes(by_kind)} scenes. The noise of the truth, by its halves, is at "
        f"{eight:.1f} dB or better (linear: {linear:.1f})."
    )
    return Table(heads, rows, caption)


def draw_curves(by_kind):
    """Draw the mean PSNR over the roughness."""
    drawn = make_figure(7.6, 3.2)
    for axes, filter_ in zip(drawn.subplots(1, 2, sharey=True), FILTERS, strict=True):
        for method, colour in zip(METHODS, COLOURS, strict=False):
            values = average_by_roughness(by_kind[f"{method}, {filter_}"])
            axes.plot(ROUGHNESSES, values, "o-", color=colour, label=method)
        axes.set_xlabel("roughness α")
        style_axes(axes, filter_, "PSNR [dB]" if filter_ == FILTERS[0] else "")
    drawn.axes[1].legend(frameon=False)
    return drawn


def draw_balls(balls):
    """Draw a row per roughness: the truth, the methods, and below the differences to the truth."""
    drawn = make_figure(9, 1.94 * len(balls))
    kinds = [f"{method}\n{filter_}" for method in METHODS for filter_ in FILTERS]
    heads = ["truth", *(kind.replace("_", "\n") for kind in kinds)]
    grid = drawn.subplots(2 * len(balls), len(heads), squeeze=False)
    for axes in grid.flat:
        axes.axis("off")
    for axes, head in zip(grid[0], heads, strict=True):
        axes.set_title(head, size=8)
    for k, (reference, *pictures) in enumerate(balls):
        grid[2 * k, 0].imshow(to_srgb(reference))
        for column, picture in enumerate(pictures, start=1):
            grid[2 * k, column].imshow(to_srgb(picture))
            grid[2 * k + 1, column].imshow(to_srgb(DIFFERENCE * np.abs(picture - reference)))
    return drawn


def describe_balls(probe):
    """Return the caption of the figure of balls."""
    alphas = ", ".join(f"{alpha:g}" for alpha in ROUGHNESSES)
    return (
        f"Balls in {probe}, α = {alphas} downwards; under each {DIFFERENCE} times its difference."
    )
