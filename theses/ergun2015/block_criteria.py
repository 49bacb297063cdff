"""C1: which block to cut next, by the error of the map that the blocks hold."""

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import find_probes, read_probes

from brdfkit.core.colours import luminance
from brdfkit.lighting import environments
from brdfkit.lighting.environments.audit_picture import DRAWN_BLOCKS, draw_map
from brdfkit.lighting.sampling import tree
from brdfkit.lighting.sampling.power_map import cell_power
from brdfkit.theses.claims import Claim, verdict
from brdfkit.theses.drawing import figure
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 3
BLOCKS = 1024
CRITERIA = "sse", "variance", "range"
TEXT = f"""Each map is cut into {BLOCKS:,} blocks, and each block holds the mean of its pixels'
power. The error is Σ (power − mean)² / Σ power²."""


def run(sources, report):
    """The errors of the maps by criterion, and the claim on them."""
    maps = read_probes(sources)
    errors = {}
    for done, (name, rgb) in enumerate(maps.items()):
        power = cell_power(luminance(rgb))
        errors[name] = [reconstruction_error(power, criterion) for criterion in CRITERIA]
        report(done + 1, len(maps))
    best = [name for name, row in errors.items() if np.argmin(row) == 0]
    claim = Claim(
        "The sum of squared errors is the best criterion of three.",
        "6.2, Figure 6.1",
        "best of three on grace",
        f"best on {len(best)} of {len(errors)} maps",
        verdict(len(best) == len(errors)),
    )
    rows = [(name, *(f"{e:.3g}" for e in row)) for name, row in errors.items()]
    picture = Picture("block_criteria", draw(*next(iter(find_probes(sources).items()))))
    table = Table(("map", *CRITERIA), rows)
    return Section("Which block to cut next", TEXT, [claim], [table], [picture])


def reconstruction_error(power, criterion, count=BLOCKS):
    """The relative squared error of `power` (rows, columns) where blocks hold their means."""
    boxes = tree.build_tree(power, count, criterion).blocks
    x0, x1, y0, y1 = boxes.T
    means = tree.block_sums(power, boxes) / ((x1 - x0) * (y1 - y0))
    # Σ (power - mean)² = Σ power² - Σ n mean²
    kept = np.sum(means**2 * (x1 - x0) * (y1 - y0))
    return 1 - kept / np.sum(power**2)


def draw(name, file):
    """A map with its first blocks, by the sum of squared errors."""
    drawn, audit = figure(8, 4.4), environments.audit(file)
    rgb = audit.data.astype(float)
    blocks = tree.build_tree(cell_power(luminance(rgb)), DRAWN_BLOCKS, "sse").blocks
    draw_map(drawn.subplots(), audit, rgb, blocks)
    drawn.axes[0].set_title(
        f"{name}: the first {DRAWN_BLOCKS} blocks; the circle is the brightest pixel"
    )
    return drawn
