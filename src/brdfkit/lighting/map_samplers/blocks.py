"""Samples a map by blocks of nearly constant power: a block by a law, a point in it evenly.

[Ergun 2015, chapter 6]
"""

import numpy as np

from brdfkit.host.arrays import Rows
from brdfkit.lighting import environment_tree
from brdfkit.lighting.block_laws.exact import Exact
from brdfkit.lighting.block_laws.hyperbolic import Hyperbolic
from brdfkit.lighting.block_laws.steps import Steps
from brdfkit.lighting.block_lookups.grid import Grid
from brdfkit.lighting.block_lookups.texture import Texture
from brdfkit.lighting.block_lookups.tree import TreeOfCuts
from brdfkit.lighting.environment_map import cell_power

DISTRIBUTIONS = {"exact": Exact, "hyperbolic": Hyperbolic, "steps": Steps}
LOOKUPS = {"texture": Texture, "tree": TreeOfCuts, "grid": Grid}


class Blocks:
    """At most `count` blocks of the map; see `environment_tree.CRITERIA` and the names above."""

    def __init__(
        self,
        brightness,
        count=4096,
        criterion=environment_tree.DEFAULT_CRITERION,
        distribution="exact",
        lookup="texture",
    ):
        power = cell_power(brightness)
        tree = environment_tree.build(power, count, criterion)
        shares = environment_tree.block_sums(power, tree.blocks).clip(0)
        shares = shares / shares.sum()
        order = np.argsort(-shares, kind="stable")  # the largest first
        self.law = DISTRIBUTIONS[distribution].fit(shares[order])
        self.choice = self.law.in_renderer()
        x0, x1, y0, y1 = tree.blocks[order].T
        self.corners = Rows(np.stack([x0, y0], axis=1))
        self.sizes = Rows(np.stack([x1 - x0, y1 - y0], axis=1))

        # Density of the law, relative to an even one
        self.cells = power.size
        densities = np.empty(len(order))
        areas = (x1 - x0) * (y1 - y0)
        densities[order] = self.law.probability(np.arange(len(order))) * self.cells / areas
        self.lookup = LOOKUPS[lookup](tree, densities)
        self.nbytes = 16 * len(order) + self.choice.nbytes + self.lookup.nbytes

    def sample(self, u, active):
        import mitsuba as mi

        block, rest, probability = self.choice.choose(u.x, active)
        corner, size = (r.at(block, mi.Vector2f, active) for r in (self.corners, self.sizes))
        density = probability * (self.cells / (size.x * size.y))
        return corner.x + rest * size.x, corner.y + u.y * size.y, density

    def density(self, x, y, active):
        return self.lookup.density(x, y, active)
