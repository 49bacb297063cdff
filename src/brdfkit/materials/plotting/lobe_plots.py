"""`plot`: draws measured and modelled BRDFs in the plane of incidence as polar plots.

A lobe here is the curve of a BRDF over the angle of view, for one angle of incidence.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from brdfkit.core.array_types import ArrayLike, FloatArray
from brdfkit.core.errors import BrdfkitError
from brdfkit.core.figures import Plot
from brdfkit.images.thumbnails import Radius
from brdfkit.materials.measured import Measured
from brdfkit.materials.measured.evidence import make_name_unique
from brdfkit.materials.plotting.certain_lobes import (
    EVIDENCE_LABELS,
    draw_certain_lobe,
    make_evidence_handles,
    polar_to_xy,
)
from brdfkit.materials.plotting.plane_of_incidence import (
    choose_angles,
    compute_certainty,
    compute_lobe,
    is_completed,
    is_scattered,
)
from brdfkit.materials.resolve import MaterialLike, to_materials

SMALL_TEXT = {"size": 8, "color": "0.35"}
BLACK, GREY = "black", "0.45"
# Okabe and Ito's colours, which colour-blind readers can distinguish
COLOURS = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
DASHES = ("-", "--", "-.", ":")
MOST_COLUMNS = 3


def plot(
    materials: MaterialLike | Iterable[MaterialLike], *, theta_i: ArrayLike | None = None
) -> Figure:
    """Draw BRDFs in the plane of incidence as polar plots, one panel per angle of incidence.

    The radius is logarithmic in the luminance of the BRDF [sr⁻¹]; values too dark for the scale lie
    in the centre. Light comes from the left, along the arrow. The first measured material is black.
    Tables are drawn as lines where they were measured. Lines of `complete` are solid where values
    were measured, dashed where they were inferred and dotted where they were guessed, with a band
    of the 95 % intervals, hatched for guesses. Scattered samples are drawn as dots if they lie
    within 3° of theta_i and 5° of the plane.

    Parameters
    ----------
    materials : Measured, Fit, Model, str, Path or dict, or several
        The materials, their names or paths, or BSDFs' dictionaries.
    theta_i : float or array_like, optional
        Angles of incidence [degrees], from 0 to below 90. By default 15, 45 and 75, or the nearest
        angles at which the first scattered material was measured.

    Returns
    -------
    matplotlib.figure.Figure
        The figure. A notebook shows it and ``savefig`` writes it, but ``pyplot.show`` does not know
        it.

    Raises
    ------
    BrdfkitError
        For angles out of range, for channels of which no luminance can be computed, and for an
        object that is no material.

    Examples
    --------
    >>> plot(["car_paint", "ward"]).savefig("paint.png")    # doctest: +SKIP
    """
    resolved = to_materials(materials, needed=("name", "eval"))
    drawn = [getattr(material, "rgb", material) for material in resolved]
    angles = choose_angles(drawn) if theta_i is None else np.atleast_1d(theta_i).astype(float)
    if angles.ndim != 1 or not angles.size or not np.all((angles >= 0) & (angles < 90)):
        raise BrdfkitError(f"plot: theta_i = {theta_i} should be angles from 0 to below 90°.")
    rows, columns = _choose_panel_grid(angles)
    figure = Plot(figsize=(max(4.2 * columns, 6), 2.75 * rows + 0.35), layout="constrained")
    layout: Any = figure.get_layout_engine()
    layout.set(h_pad=0.08)
    draw_lobe_panels(figure, drawn, angles)
    return figure


def _choose_panel_grid(angles: FloatArray) -> tuple[int, int]:
    """Return how many rows and columns of panels are needed for one panel per angle."""
    rows = math.ceil(len(angles) / MOST_COLUMNS)
    return rows, math.ceil(len(angles) / rows)


def draw_lobe_panels(figure: Any, things: list[Any], angles: FloatArray) -> None:
    """Draw a polar plot for each angle of incidence, and a legend, into a `Figure` or `SubFigure`.

    `things` are the materials, achromatic or RGB, and `angles` the angles of incidence [degrees].
    """
    rows, columns = _choose_panel_grid(angles)
    styles = _choose_styles(things)
    for place, theta_i in enumerate(angles, 1):
        _draw_panel(figure.add_subplot(rows, columns, place), theta_i, things, styles)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    if any(map(is_completed, things)):
        handles, labels = [*handles, *make_evidence_handles()], [*labels, *EVIDENCE_LABELS]
    ncols = min(len(labels), columns + 2)
    figure.legend(handles, labels, loc="outside lower center", ncols=ncols, frameon=False)


def _choose_styles(things: list[Any]) -> list[dict[str, Any]]:
    """Return each material's keyword arguments for `Axes.plot`, with a distinct style and label."""
    colours = [{"color": c, "linestyle": dash} for dash in DASHES for c in COLOURS]
    palette, taken = cycle(colours), set[str]()
    styles: list[dict[str, Any]] = []
    black = next((thing for thing in things if isinstance(thing, Measured)), None)
    for thing in things:
        style: dict[str, Any] = {"color": BLACK, "linestyle": "-"}
        style = {**(style if thing is black else next(palette)), "linewidth": 1.4}
        if isinstance(thing, Measured):  # draw a thick line, on which models' thin lines show
            style |= {"linewidth": 2.4, "zorder": 1.9}
        if is_scattered(thing):
            style |= {"linestyle": "", "marker": "o", "markersize": 3}
        # Escape the dollar sign, which begins a formula in matplotlib's texts
        style["label"] = make_name_unique(thing.name.replace("$", r"\$"), thing, taken)
        taken.add(style["label"])
        styles.append(style)
    return styles


def _draw_panel(axes: Any, theta_i: float, things: list[Any], styles: list[dict[str, Any]]) -> None:
    """Draw the polar plot for one angle of incidence: the grid, the light's arrow, the BRDFs."""
    lobes = [compute_lobe(thing, theta_i) for thing in things]
    radius = Radius([values for _, values in lobes])
    _draw_half_disc(axes, radius)
    axes.set_title(rf"$\theta_i$ = {theta_i:g}°", size=11)
    arrow = {"arrowstyle": "-|>", "color": GREY, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", (0, 0), polar_to_xy(-theta_i, 1), arrowprops=arrow, zorder=1.5)
    for thing, (theta_o, values), style in zip(things, lobes, styles, strict=True):
        if is_completed(thing):
            certainty = compute_certainty(thing, theta_i, theta_o)
            draw_certain_lobe(axes, radius, theta_o, values, certainty, style)
        else:
            axes.plot(*polar_to_xy(theta_o, radius(values)), **style)


def _draw_half_disc(axes: Any, radius: Radius) -> None:
    """Draw the rim, grid and labels of a polar plot over the upper half plane.

    `radius` maps BRDF values to radii. Matplotlib's own polar axes would leave the lower half of
    the panel blank.
    """
    axes.set(aspect="equal", xlim=(-1.2, 1.2), ylim=(-0.27, 1.13))
    axes.set_axis_off()
    half = np.arange(-90, 91)
    rim = {"color": "0.3", "linewidth": 0.8, "zorder": 1.2}
    grid = {"color": "0.87", "linewidth": 0.7, "zorder": 1}
    axes.plot(*polar_to_xy(half, 1), **rim)
    axes.plot([-1, 1], [0, 0], **rim)
    for theta in range(-90, 91, 30):
        axes.plot(*polar_to_xy(theta, np.array([0, 1])), **grid)
        text = f"{theta}°".replace("-", "−")
        # Raise the labels of ±90°, because those of the radius are just below them
        va = "bottom" if abs(theta) == 90 else "center"
        axes.text(*polar_to_xy(theta, 1.1), text, ha="center", va=va, **SMALL_TEXT)
    for tick in radius.ticks():
        axes.plot(*polar_to_xy(half, radius(tick)), **grid)
        axes.text(radius(tick), -0.03, f"{tick:g}", ha="center", va="top", **SMALL_TEXT)
    axes.text(
        0, -0.17, "luminance of the BRDF [sr⁻¹], logarithmic", ha="center", va="top", **SMALL_TEXT
    )
