"""The map sampler `Blocks`: draws points of a map by blocks in which its power is nearly linear.

[Ergun 2015, chapter 6]
"""

from brdfkit.core.array_types import FloatArray, JitFloat, JitMask, JitVector
from brdfkit.lighting.sampling import tree
from brdfkit.lighting.sampling.alias_table import AliasBlocks
from brdfkit.lighting.sampling.block_laws import Hyperbolic, Law, SortedBlocks, Steps
from brdfkit.lighting.sampling.block_lookups import GridLookup, TextureLookup, TreeWalk
from brdfkit.lighting.sampling.block_slopes import fit_slopes
from brdfkit.lighting.sampling.power_map import cell_power, pixel_power

LAWS: dict[str, type[Law]] = {"hyperbolic": Hyperbolic, "steps": Steps}
DISTRIBUTIONS = ("exact", "alias", *LAWS)
LOOKUPS: dict[str, type[TextureLookup | TreeWalk | GridLookup]] = {
    "texture": TextureLookup,
    "tree": TreeWalk,
    "grid": GridLookup,
}


class Blocks:
    """A sampler of points of an environment map, which is cut into at most `count` blocks.

    The three names choose among methods: `criterion` is the error in `tree.CRITERIA` by which the
    next block to cut is found, `distribution` the way in DISTRIBUTIONS to draw a block, and
    `lookup` the way in LOOKUPS to find the block of a point. The distributions "exact" and "alias"
    draw blocks by their shares of the power.
    """

    def __init__(
        self, brightness: FloatArray, count: int, criterion: str, distribution: str, lookup: str
    ) -> None:
        sums = tree.Sums(cell_power(brightness))
        self.tree = tree.build_tree_from_sums(sums, count, criterion)
        cells, power, _ = sums.sum_moments(self.tree.blocks)
        self.shares = power.clip(0) / power.clip(0).sum()
        slopes = fit_slopes(sums, pixel_power(brightness), self.tree.blocks)
        self.sampler: TreeWalk | AliasBlocks | SortedBlocks
        densities = self.shares * sums.values.size / cells
        if distribution == "exact":
            self.sampler = TreeWalk(self.tree, densities, slopes)
        elif distribution == "alias":
            self.sampler = AliasBlocks(self.tree.blocks, densities, self.shares, slopes)
        else:
            self.sampler = SortedBlocks(self.tree, self.shares, slopes, LAWS[distribution])
            densities = self.sampler.densities
        self.nbytes = self.sampler.nbytes
        if isinstance(self.sampler, TreeWalk) and lookup == "tree":
            self.lookup: TextureLookup | TreeWalk | GridLookup = self.sampler
        else:
            self.lookup = LOOKUPS[lookup](self.tree, densities, slopes)
            self.nbytes += self.lookup.nbytes

    def sample(self, u: JitVector, active: JitMask) -> tuple[JitFloat, JitFloat, JitFloat]:
        """Draw a point of the map by two uniform numbers `u`; return (x, y, density)."""
        return self.sampler.sample(u, active)

    def density(self, x: JitFloat, y: JitFloat, active: JitMask) -> JitFloat:
        """Return the density with which a point (x, y) is drawn, relative to a uniform one."""
        return self.lookup.density(x, y, active)
