"""The map sampler `Blocks`: a map cut into blocks in which power is nearly a straight line.

[Ergun 2015, chapter 6]
"""

from brdfkit.core.array_types import FloatArray, JitFloat, JitMask, JitVector
from brdfkit.lighting.sampling import tree
from brdfkit.lighting.sampling.block_laws import Hyperbolic, Law, SortedBlocks, Steps
from brdfkit.lighting.sampling.block_lookups import GridLookup, TextureLookup, TreeWalk
from brdfkit.lighting.sampling.block_slopes import fit_slopes
from brdfkit.lighting.sampling.power_map import cell_power, pixel_power

LAWS: dict[str, type[Law]] = {"hyperbolic": Hyperbolic, "steps": Steps}
DISTRIBUTIONS = ("exact", *LAWS)
LOOKUPS: dict[str, type[TextureLookup | TreeWalk | GridLookup]] = {
    "texture": TextureLookup,
    "tree": TreeWalk,
    "grid": GridLookup,
}


class Blocks:
    """A map sampler with at most `count` blocks.

    `criterion` (of `tree.CRITERIA`) says which block is cut next, `distribution` (of
    `DISTRIBUTIONS`) how blocks are drawn, `lookup` (of `LOOKUPS`) how the block of a point is
    found. "exact" draws blocks by their shares of the power, down the tree.
    """

    def __init__(
        self, brightness: FloatArray, count: int, criterion: str, distribution: str, lookup: str
    ) -> None:
        sums = tree.Sums(cell_power(brightness))
        self.tree = tree.build_from_sums(sums, count, criterion)
        cells, power, _ = sums.moments(self.tree.blocks)
        self.shares = power.clip(0) / power.clip(0).sum()
        slopes = fit_slopes(sums, pixel_power(brightness), self.tree.blocks)
        self.sampler: TreeWalk | SortedBlocks
        if distribution == "exact":
            densities = self.shares * sums.values.size / cells
            self.sampler = TreeWalk(self.tree, densities, slopes)
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
        """Return (x, y, density) of a point for two uniform numbers `u`."""
        return self.sampler.sample(u, active)

    def density(self, x: JitFloat, y: JitFloat, active: JitMask) -> JitFloat:
        """Return the density at a point, relative to a uniform one."""
        return self.lookup.density(x, y, active)
