"""Samples a map by blocks in which power is nearly a straight line: by their tree or a law.

[Ergun 2015, chapter 6]
"""

from brdfkit.lighting.sampling import tree
from brdfkit.lighting.sampling.block_laws.hyperbolic import Hyperbolic
from brdfkit.lighting.sampling.block_laws.sorted_blocks import SortedBlocks
from brdfkit.lighting.sampling.block_laws.steps import Steps
from brdfkit.lighting.sampling.block_lookups.stored import Grid, Texture
from brdfkit.lighting.sampling.block_lookups.walk import Walk
from brdfkit.lighting.sampling.block_slopes import slopes
from brdfkit.lighting.sampling.power_map import cell_power, pixel_power

LAWS = {"hyperbolic": Hyperbolic, "steps": Steps}
DISTRIBUTIONS = ("exact", *LAWS)
LOOKUPS = {"texture": Texture, "tree": Walk, "grid": Grid}


class Blocks:
    """At most `count` blocks of the map; see `environment_tree.CRITERIA` and the names above."""

    def __init__(self, brightness, count, criterion, distribution, lookup):
        sums = tree.Sums(cell_power(brightness))
        self.tree = tree.build_by(sums, count, criterion)
        cells, power, _ = sums.of(self.tree.blocks)
        self.shares = power.clip(0) / power.clip(0).sum()
        lines = slopes(sums, pixel_power(brightness), self.tree.blocks)
        if distribution == "exact":
            densities = self.shares * sums.values.size / cells
            self.choice = Walk(self.tree, densities, lines)
        else:
            self.choice = SortedBlocks(self.tree, self.shares, lines, LAWS[distribution])
            densities = self.choice.densities
        shared = isinstance(self.choice, LOOKUPS[lookup])
        self.lookup = self.choice if shared else LOOKUPS[lookup](self.tree, densities, lines)
        self.nbytes = self.choice.nbytes + (0 if shared else self.lookup.nbytes)

    def sample(self, u, active):
        return self.choice.sample(u, active)

    def density(self, x, y, active):
        return self.lookup.density(x, y, active)
