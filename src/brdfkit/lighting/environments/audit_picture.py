"""The figure of an `EnvironmentAudit`: the map, and two plots that show how its light is spread.

Outlines on the map show the blocks, the rectangles into which the emitter `kdtree_envmap` cuts a
map to sample it. One plot shows the blocks' probabilities, the other one the shares of the light.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from brdfkit.core.array_types import FloatArray, IntArray
from brdfkit.core.colours import luminance, to_srgb
from brdfkit.core.figures import Plot
from brdfkit.lighting.environments.light_distribution import (
    cumulative_light_shares,
    pixel_directions,
    pixel_solid_angles,
)
from brdfkit.lighting.sampling import tree
from brdfkit.lighting.sampling.blocks import LAWS
from brdfkit.lighting.sampling.power_map import cell_power

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# stands for the class in `auditing.py`; that file imports this one, so this one cannot import it
EnvironmentAudit = Any

SIZE = 10.4, 9.4  # width and height of the figure in inches
MIDDLE_GREY = 0.18  # linear value at which pixels of the map's geometric mean luminance are drawn
BLOCKS = 4096  # number of blocks in the plot of probabilities, the default of `kdtree_envmap`
DRAWN_BLOCKS = 256  # number of blocks whose outlines are drawn on the map
DRAWN_ROWS = 1024  # approximate number of rows to which a larger map is thinned before drawing
CURVE_POINTS = 1000  # largest number of points along the curve of the light's shares
COLOUR = "#0072b2"  # colour of the curves of exact values
LAW_COLOURS = {"hyperbolic": "#d55e00", "steps": "#009e73"}
# names of the directions along the horizon, at the ticks below the map
SIDES = ("−z", "+x", "+z", "−x", "−z")


def draw_audit(audit: EnvironmentAudit) -> "Figure":
    """Draw an `EnvironmentAudit` as a matplotlib `Figure`."""
    rgb = np.where(np.isfinite(audit.data), audit.data, 0).clip(0).astype(float)
    brightness = luminance(rgb)
    solid_angle = pixel_solid_angles(audit.height, audit.width)
    power = cell_power(brightness)
    figure = Plot(figsize=SIZE, layout="constrained")
    above, below = figure.subfigures(2, 1, squeeze=False, height_ratios=(1.45, 1))[:, 0]
    draw_map(above.subplots(), audit, rgb, tree.build_tree(power, DRAWN_BLOCKS).blocks)
    left, right = below.subplots(1, 2)
    _draw_block_probabilities(left, power)
    _draw_light_shares(right, brightness, solid_angle, audit)
    return figure


def draw_map(axes: "Axes", audit: EnvironmentAudit, rgb: FloatArray, blocks: IntArray) -> None:
    """Draw the tone-mapped map, the outlines of its `blocks` (n, 4), and its brightest spot.

    `rgb` (height, width, 3) is linear and finite. A block is (x0, x1, y0, y1) in cells, the squares
    between four neighbouring pixels, as in `Tree.blocks`.
    """
    from matplotlib.collections import PolyCollection

    brightness = luminance(rgb)
    lit = brightness[brightness > 0]
    exposure = MIDDLE_GREY / np.exp(np.log(lit).mean()) if lit.size else 1
    # Pixels of the first and last row lie on the poles, which are drawn at 1 and 0; half a row is
    # drawn beyond each
    half = 0.5 / (audit.height - 1)
    extent = 0, 1, -half, 1 + half
    step = 1 + audit.height // DRAWN_ROWS
    axes.imshow(
        to_srgb(rgb[::step, ::step] * exposure),
        extent=extent,
        aspect="auto",
        interpolation="nearest",
    )
    # Convert blocks from cells to the plot, in which the poles have y = 1 and y = 0
    x0, x1, y0, y1 = blocks.T / np.repeat((audit.width, audit.height - 1), 2)[:, None]
    x0, x1 = x0 + 0.5 / audit.width, x1 + 0.5 / audit.width
    corners = [(x0, 1 - y0), (x1, 1 - y0), (x1, 1 - y1), (x0, 1 - y1)]
    outlines = np.moveaxis(np.array(corners), 2, 0)
    axes.add_collection(
        PolyCollection(list(outlines), facecolors="none", edgecolors="w", linewidths=0.4)
    )
    directions = pixel_directions(audit.height, audit.width).reshape(-1, 3)
    spot = int(np.argmax(directions @ np.array(audit.brightest)))
    place = (spot % audit.width + 0.5) / audit.width, 1 - spot // audit.width / (audit.height - 1)
    axes.plot(*place, "o", markersize=14, mfc="none", mec="#d55e00", mew=1.6)
    axes.set(xlim=(0, 1), ylim=extent[2:])
    axes.set_xticks(np.linspace(0, 1, 5), SIDES)
    axes.set_yticks((0, 0.5, 1), ("−y, below", "horizon", "+y, above"))
    name = audit.name.replace("$", r"\$")  # matplotlib would read $ as the beginning of a formula
    axes.set_title(f"{name}: {len(blocks)} blocks; the circle is the brightest pixel", fontsize=11)


def _draw_block_probabilities(axes: "Axes", power: FloatArray) -> None:
    """Plot the sorted sampling probabilities of a map's blocks, and the laws that approximate them.

    The laws are the closed formulas of `block_laws.py`. `power` (rows - 1, columns) is the power
    per angle of the map's cells, the result of `cell_power`.
    """
    blocks = tree.build_tree(power, BLOCKS).blocks
    light = np.sort(tree.block_sums(power, blocks).clip(0))[::-1]
    axes.set(xscale="log", xlabel="rank of the block", ylabel="probability")
    axes.set_title(f"probabilities of {len(blocks):,} blocks, sorted", fontsize=10)
    axes.spines[["top", "right"]].set_visible(False)
    if len(light) < 2:  # a map with equal values everywhere is a single block
        return
    share, rank = light / light.sum(), np.arange(len(light))
    lit = share > 0
    axes.plot(rank[lit] + 1, share[lit], color=COLOUR, label="the blocks' own")
    for name, colour in LAW_COLOURS.items():
        fitted = LAWS[name].fit_to_shares(share).probability(rank)
        axes.plot(rank[lit] + 1, fitted[lit], color=colour, linewidth=1, label=f"{name} law")
    axes.set(yscale="log", ylim=(share[lit].min() / 2, min(1, 3 * share[0])))
    axes.legend(frameon=False)


def _draw_light_shares(
    axes: "Axes", brightness: FloatArray, solid_angle: FloatArray, audit: EnvironmentAudit
) -> None:
    """Plot the share of the light that comes from the brightest part, by share of solid angle."""
    axes.set(xscale="log", xlim=(1e-5, 1), ylim=(0, 1.03))
    axes.set(xlabel="share of the solid angle, brightest first", ylabel="share of the light")
    axes.set_title("where the light comes from", fontsize=10)
    axes.spines[["top", "right"]].set_visible(False)
    if not audit.mean > 0:
        return
    areas, light = cumulative_light_shares(brightness, solid_angle / solid_angle.sum())
    drawn = np.unique(areas.searchsorted(np.geomspace(areas[1], 1, CURVE_POINTS)))
    axes.plot(areas[drawn], light[drawn], color=COLOUR)
    axes.plot(0.01, audit.brightest_share, "o", color="#d55e00")
    axes.annotate(
        f"brightest 1 %: {100 * audit.brightest_share:.0f} %",
        (0.01, audit.brightest_share),
        (8, -12),
        textcoords="offset points",
    )
