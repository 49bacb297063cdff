"""Samples a map by blocks of nearly constant power: by walking their tree, or by a law.

[Ergun 2015, chapter 6]
"""

from brdfkit.lighting import environment_tree
from brdfkit.lighting.block_laws.hyperbolic import Hyperbolic
from brdfkit.lighting.block_laws.sorted_blocks import SortedBlocks
from brdfkit.lighting.block_laws.steps import Steps
from brdfkit.lighting.block_lookups.grid import Grid
from brdfkit.lighting.block_lookups.texture import Texture
from brdfkit.lighting.block_lookups.walk import Walk
from brdfkit.lighting.environment_map import cell_power

LAWS = {"hyperbolic": Hyperbolic, "steps": Steps}
DISTRIBUTIONS = ("exact", *LAWS)
LOOKUPS = {"texture": Texture, "tree": Walk, "grid": Grid}


class Blocks:
    """At most `count` blocks of the map; see `environment_tree.CRITERIA` and the names above."""

    def __init__(self, brightness, count, criterion, distribution, lookup):
        power = cell_power(brightness)
        self.tree = environment_tree.build(power, count, criterion)
        x0, x1, y0, y1 = self.tree.blocks.T
        self.shares = environment_tree.block_sums(power, self.tree.blocks).clip(0)
        self.shares = self.shares / self.shares.sum()
        if distribution == "exact":
            densities = self.shares * power.size / ((x1 - x0) * (y1 - y0))
            self.choice = Walk(self.tree, densities)
        else:
            self.choice = SortedBlocks(self.tree, self.shares, LAWS[distribution])
            densities = self.choice.densities
        shared = isinstance(self.choice, LOOKUPS[lookup])
        self.lookup = self.choice if shared else LOOKUPS[lookup](self.tree, densities)
        self.nbytes = self.choice.nbytes + (0 if shared else self.lookup.nbytes)

    def sample(self, u, active):
        return self.choice.sample(u, active)

    def density(self, x, y, active):
        return self.lookup.density(x, y, active)
