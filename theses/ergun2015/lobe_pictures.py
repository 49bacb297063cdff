"""Draws the errors of methods with Gaussian lobes in 80 scenes, and their pictures of balls."""

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import FILTERS, METHODS, ROUGHNESSES
from brdfkit.theses.ergun2015.printed_forms import (
    name_kernels,
    name_mixture,
    name_sampling,
    name_warped,
)

from brdfkit.core.colours import to_srgb
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes

DIFFERENCE = 5  # the factor by which the figure enlarges differences
SHOWN = (
    name_warped(0.5, "mips"),
    name_warped(0.5, "lobes"),
    name_kernels(8, 0.5),
    name_kernels(32, 0.5),
    name_mixture(0.5),
    name_sampling(64, 1),
)


def average_by_roughness(values):
    """Return mean PSNRs of 8-bit sRGB by roughness, of values (scenes, 2).

    The roughness varies first among the scenes.
    """
    return values[:, 0].reshape(-1, len(ROUGHNESSES)).mean(axis=0)


def draw_curves(by_kind):
    """Draw the mean PSNR over the roughness: of brdfkit's methods, and of the thesis's forms."""
    panels = {filter_: [f"{method}, {filter_}" for method in METHODS] for filter_ in FILTERS}
    panels["as printed"] = SHOWN
    drawn = make_figure(9.6, 4)
    for axes, (title, kinds) in zip(
        drawn.subplots(1, len(panels), sharey=True), panels.items(), strict=True
    ):
        for kind, colour in zip(kinds, COLOURS, strict=False):
            values = average_by_roughness(by_kind[kind])
            label = kind if title == "as printed" else kind.split(",")[0]
            axes.plot(ROUGHNESSES, values, "o-", color=colour, label=label)
        axes.set_xlabel("roughness α")
        axes.legend(frameon=False, fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.2))
        style_axes(axes, title, "PSNR [dB]" if title == FILTERS[0] else "")
    return drawn


def draw_balls(balls):
    """Draw a row per roughness: the truth, the methods, and below the differences to the truth.

    Each ball has its picture by label; of the thesis's forms those of `SHOWN` are drawn.
    """
    heads = ["truth", *(f"{m}, {f}" for m in METHODS for f in FILTERS), *SHOWN]
    drawn = make_figure(12, 1.85 * len(balls))
    grid = drawn.subplots(2 * len(balls), len(heads), squeeze=False)
    for axes in grid.flat:
        axes.axis("off")
    for axes, head in zip(grid[0], heads, strict=True):
        axes.set_title(head.replace(": ", "\n").replace(", ", "\n").replace("_", "\n"), size=7)
    for k, pictures in enumerate(balls):
        for column, head in enumerate(heads):
            grid[2 * k, column].imshow(to_srgb(pictures[head]))
            if head != "truth":
                difference = DIFFERENCE * np.abs(pictures[head] - pictures["truth"])
                grid[2 * k + 1, column].imshow(to_srgb(difference))
    return drawn


def describe_balls(probe):
    """Return the caption of the figure of balls."""
    alphas = ", ".join(f"{alpha:g}" for alpha in ROUGHNESSES)
    return (
        f"Balls in {probe}, α = {alphas} downwards; under each {DIFFERENCE} times its difference."
    )
