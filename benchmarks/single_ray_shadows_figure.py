"""Draws the figure of `single_ray_shadows.py`: errors over evaluations, and some shadows."""

import ground_scenes
import numpy as np
from brdfkit.theses.balint2019.rivals import quilez

from brdfkit.distance_fields.shadows.marches import compute_linear_shadow
from brdfkit.distance_fields.shadows.monte_carlo import compute_monte_carlo_shadow
from brdfkit.distance_fields.shadows.split import compute_split_shadow
from brdfkit.theses.drawing import COLOURS, make_figure, style_axes

FAMILIES = "monte_carlo", "linear", "base", "discrete", "convex", "split", "quilez", "aaltonen"
SIZE, RADIUS = 200, 1.0
PICTURES = {
    "256 rays": lambda field, cone: compute_monte_carlo_shadow(field, cone, 256),
    "split, ε = 1/10": lambda field, cone: compute_split_shadow(field, cone, 1 / 10),
    "linear, ε = 1/20": compute_linear_shadow,
    "quilez": quilez,
}


def draw_figure(results):
    """Return the figure with both parts, from the results by part."""
    page = make_figure(11, 8.2)
    above, below = page.subfigures(2, 1, height_ratios=(1, 1.15))
    draw_errors(above, [v for k, v in results.items() if k.startswith("occluder")])
    draw_shadows(below)
    return page


def draw_errors(part, kinds):
    """Plot errors over evaluations by family of methods, as means over the kinds of occluders."""
    axes = part.subplots()
    labels = [label for label in kinds[0] if label != "τ(r_min)"]
    for family, colour in zip(FAMILIES, COLOURS, strict=True):
        own = [label for label in labels if label.startswith(family)]
        points = [
            [np.exp(np.mean(np.log([k[label][key] for k in kinds[1:]]))) for label in own]
            for key in ("evaluations", "rmse")
        ]
        order = np.argsort(points[0])
        points = [np.array(p)[order] for p in points]
        axes.plot(*points, "o-", color=colour, label=family, ms=5)
        if family == "split":
            axes.annotate("19 cones", [p[-1] for p in points], (8, 0), textcoords="offset points")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("evaluations of the distance per point")
    style_axes(
        axes,
        "Eight kinds of occluders that cover a part of the light: geometric means",
        "error (RMS)",
    )
    axes.legend(ncols=2, frameon=False)


def draw_shadows(part):
    """Draw the shadows of the simple scene from above, and their differences from the first."""
    field, cone = ground_scenes.simple(), ground_scenes.make_light_cones(SIZE, RADIUS, half=2.6)
    pictures = {name: method(field, cone).visible for name, method in PICTURES.items()}
    pictures = {name: np.array(p).reshape(SIZE, SIZE) for name, p in pictures.items()}
    first = next(iter(pictures.values()))
    for axes, (name, picture) in zip(part.subplots(2, 4).T, pictures.items(), strict=True):
        axes[0].imshow(picture, cmap="gray", vmin=0, vmax=1, origin="lower")
        axes[0].set_title(name, size=10)
        axes[1].imshow(picture - first, cmap="RdBu", vmin=-0.3, vmax=0.3, origin="lower")
        for a in axes:
            a.set_axis_off()
    axes[1].set_title("")
    part.text(0.01, 0.02, "below: difference from the first, ±0.3; red is too dark", size=9)
