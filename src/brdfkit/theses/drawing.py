"""Draws the figures of a thesis's page with matplotlib, in one style and without pyplot."""

from collections.abc import Mapping
from typing import Any

from brdfkit.core.array_types import AnyArray

COLOURS = "#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#d55e00", "#8c6d31", "#222222"
GRID = "#dddddd"


def make_figure(width: float, height: float) -> Any:
    """Make an empty matplotlib figure of a size in inches."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def style_axes(axes: Any, title: str, ylabel: str) -> None:
    """Give axes a title, a label of the vertical axis and a faint grid."""
    axes.set_title(title, size=10)
    axes.set_ylabel(ylabel)
    axes.grid(color=GRID, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def draw_curves(axes: Any, curves: Mapping[str, AnyArray], title: str, ylabel: str) -> None:
    """Draw each curve's values over 1, 2, 3, ... on a logarithmic axis, the last curve thick.

    Neighbours of similar colours differ by their dashes as well.
    """
    last = list(curves)[-1]
    colours = {**dict(zip(curves, COLOURS, strict=False)), last: COLOURS[-1]}
    for number, (name, values) in enumerate(curves.items()):
        style: dict[str, Any] = (
            {"linewidth": 2.2, "zorder": 3} if name == last else {"linewidth": 1.0}
        )
        if name != last and number >= len(COLOURS) - 2:
            style |= {"linestyle": "--", "linewidth": 1.3}
        axes.plot(range(1, len(values) + 1), values, label=name, color=colours[name], **style)
    axes.set_yscale("log")
    axes.margins(x=0.01)
    style_axes(axes, title, ylabel)
