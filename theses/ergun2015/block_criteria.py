"""Checks which criterion is best for choosing the block of an environment map to cut next.

A k-d tree cuts the map into blocks that a light sampler draws from.
"""

import numpy as np
from brdfkit.theses.ergun2015.lit_balls import find_probes, read_probes

from brdfkit.core.colours import luminance
from brdfkit.lighting import environments
from brdfkit.lighting.environments.audit_picture import DRAWN_BLOCKS, draw_map
from brdfkit.lighting.sampling import tree
from brdfkit.lighting.sampling.power_map import cell_power
from brdfkit.theses.claims import Claim, to_verdict
from brdfkit.theses.drawing import make_figure
from brdfkit.theses.page import Picture, Section, Table

SECONDS = 3
BLOCKS = 1024
CRITERIA = "sse", "variance", "range"
TEXT = f"""Each map is cut into {BLOCKS:,} blocks, and each block holds the mean of its pixels'
power. The error is Σ (power − mean)² / Σ power²."""


def check_claims(sources, report):
    """Check the claims on the choice of the next block to cut; return their section."""
    maps = read_probes(sources)
    errors = {}
    for done, (name, rgb) in enumerate(maps.items()):
        power = cell_power(luminance(rgb))
        errors[name] = [compute_reconstruction_error(power, criterion) for criterion in CRITERIA]
        report(done + 1, len(maps))
    best = [name for name, row in errors.items() if np.argmin(row) == 0]
    claim = Claim(
        "The sum of squared errors is the best criterion of three.",
        "6.2, Figure 6.1",
        "best of three on grace",
        f"best on {len(best)} of {len(errors)} maps",
        to_verdict(len(best) == len(errors)),
    )
    rows = [(name, *(f"{e:.3g}" for e in row)) for name, row in errors.items()]
    picture = Picture(
        "block_criteria",
        draw_block_map(*next(iter(find_probes(sources).items()))),
        "Blocks by the sum of squared errors.",
    )
    table = Table(("map", *CRITERIA), rows)
    return Section("Which block to cut next", TEXT, [claim], [table], [picture])


def compute_reconstruction_error(power, criterion, count=BLOCKS):
    """Return the relative squared error of `power` (rows, columns) if each block holds its mean."""
    boxes = tree.build_tree(power, count, criterion).blocks
    x0, x1, y0, y1 = boxes.T
    means = tree.block_sums(power, boxes) / ((x1 - x0) * (y1 - y0))
    # Σ (power - mean)² = Σ power² - Σ n mean²
    kept = np.sum(means**2 * (x1 - x0) * (y1 - y0))
    return 1 - kept / np.sum(power**2)


def draw_block_map(name, file):
    """Draw a map with its first blocks, cut by the sum of squared errors."""
    drawn, audit = make_figure(8, 4.4), environments.audit(file)
    rgb = audit.data.astype(float)
    blocks = tree.build_tree(cell_power(luminance(rgb)), DRAWN_BLOCKS, "sse").blocks
    draw_map(drawn.subplots(), audit, rgb, blocks)
    drawn.axes[0].set_title(
        f"{name}: the first {DRAWN_BLOCKS} blocks; the circle is the brightest pixel"
    )
    return drawn
